// A compiled character as the bytes of a file, and back: docs/file_format.md.
#pragma once

#include <throng/character.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace throng {

// Throws kInvalidArgument where check_character() finds what a reader would refuse.
std::vector<std::byte> write_character(const Character& character);

// Checks everything, and allocates no more than a few times the size of `bytes`. `place` stands at the beginning of each message.
// Throws kUnsupported for another version, else kInvalidFile or kLimit.
Character read_character(std::span<const std::byte> bytes, const std::string& place);

// Whether a regular file of this name begins as a compiled character does.
bool is_compiled_file(const std::filesystem::path& path);

// Of a whole file, as its header has it.
uint64_t checksum_of(std::span<const std::byte> file);

// Throws `code` where an index or a range leads out of its array, a number is not finite, or a limit is exceeded: whatever could lead a
// stage, on the GPU or not, out of its buffers.
void check_character(const Character& character, const std::string& place, ErrorCode code);

}  // namespace throng
