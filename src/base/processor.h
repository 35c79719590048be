// The machine's processor.
#pragma once

#include <string>

namespace throng {

// As the system calls it.
std::string processor_name();

}  // namespace throng
