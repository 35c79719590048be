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

// Throws `code` if an index or a range leads out of its array, a number is not finite, scales are less uniform than the
// rig claims or a text is more than a line, and kLimit if a limit is exceeded. So nothing leads a stage, on the GPU or
// not, out of its buffers, or a reader of messages astray.
void check_character(const Character& character, const std::string& place, ErrorCode code);

}  // namespace throng
