// Whether a character may be used: it may come from a file, or an application may have changed it.
#pragma once

#include <throng/character.h>
#include <throng/result.h>

#include <string>

namespace throng {

// Throws `code` if an index or a range leads out of its array, a number is not finite, scales are less uniform than the
// rig claims or a text is more than a line, and kLimit if a limit is exceeded. So nothing leads a stage, on the GPU or
// not, out of its buffers, or a reader of messages astray.
void check_character(const Character& character, const std::string& place, ErrorCode code);

}  // namespace throng
