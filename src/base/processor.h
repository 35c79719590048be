// The machine's processor.
#pragma once

#include <cstdint>
#include <string>

namespace throng {

// The name that the system reports.
std::string processor_name();

// How many threads this process can run at the same time: limited by its CPU affinity and its container; at least 1.
uint32_t processor_threads();

}  // namespace throng
