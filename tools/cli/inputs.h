// Files that a command reads are not to be written over by it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace throng::tools {

// Throws a CommandError where one of `outs` is the same file as one of `inputs`, or as a buffer or an image that a
// glTF file among those names, whatever the spelling and through links. To be called before the work is done: an out
// that is not there yet costs next to nothing.
void keep_inputs(const std::vector<std::string>& inputs, const std::vector<std::filesystem::path>& outs);

}  // namespace throng::tools
