// Keeps a command from overwriting the files that it reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace throng::tools {

// Throws a CommandError if one of `outs` is the same file as one of `inputs`, or as a buffer or an image that a glTF
// file among `inputs` refers to, whatever the spelling and through links. Call it before the work is done: an out that
// does not exist yet costs next to nothing.
void keep_inputs(const std::vector<std::string>& inputs, const std::vector<std::filesystem::path>& outs);

}  // namespace throng::tools
