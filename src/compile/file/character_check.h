// Checks that a character is safe to use. It may come from a file, or an application may have changed it.
#pragma once

#include <throng/character.h>
#include <throng/result.h>

#include <string>

namespace throng {

// Throws `code` if an index or a range is out of bounds, a number is not finite, scales are less uniform than the rig
// claims, or a text has characters that printable() would replace. Throws kLimit if a limit is exceeded. So no stage,
// on the GPU or the CPU, can access memory outside its buffers, and no name can falsify the program's output.
void check_character(const Character& character, const std::string& place, ErrorCode code);

}  // namespace throng
