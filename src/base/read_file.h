// Reading a file as a whole.
#pragma once

#include "base/progress.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace throng {

inline constexpr const char* kLargerThanFiles = "the file is larger than the limit of 2 GiB";

// The whole of a regular file. Fails at `place` with kFile, or above `limit_bytes` with kLimit and the message
// `too_large`.
std::vector<std::byte> read_file(const std::filesystem::path& path, uint64_t limit_bytes, const std::string& place,
                                 const char* too_large = kLargerThanFiles, const Progress& progress = {});

}  // namespace throng
