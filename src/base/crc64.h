// The checksum of compiled files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace throng {

// CRC-64/XZ: polynomial of ECMA-182, reflected, all ones before and inverted after ("The .xz File Format",
// version 1.2.1, section 6). Detects every error burst of up to 64 bits. `before`: the checksum of the preceding bytes,
// to continue from.
uint64_t crc64(std::span<const std::byte> bytes, uint64_t before = 0);

}  // namespace throng
