// The machine's processor.
#pragma once

#include <cstdint>
#include <string>

namespace throng {

// As the system calls it.
std::string processor_name();

// How many threads it runs side by side for this process: as many as its affinity and its container allow; at least 1.
uint32_t processor_threads();

}  // namespace throng
