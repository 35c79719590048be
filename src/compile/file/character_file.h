// A compiled character as the bytes of a file, and back: docs/file_format.md.
#pragma once

#include <throng/character.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace throng {

inline constexpr uint64_t kCompiledFileLimit_bytes = uint64_t{2} << 30;

// Throws kInvalidArgument or kLimit if check_character() finds what a reader would refuse, and kLimit if the file would
// be larger than `limit_bytes`.
std::vector<std::byte> write_character(const Character& character, uint64_t limit_bytes = kCompiledFileLimit_bytes);

// Checks everything, and allocates no more than a few times the size of `bytes`. `place` stands at the beginning of
// each message. Throws kUnsupported for another version, else kInvalidFile or kLimit.
Character read_character(std::span<const std::byte> bytes, const std::string& place);

// The checksum of a whole file, as its header has it.
uint64_t checksum_of(std::span<const std::byte> file);

}  // namespace throng
