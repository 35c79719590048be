// Keeps a command from overwriting the files that it reads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace throng::tools {

// Throws a CommandError if one of `outs` is the same file as one of `inputs`, or as a buffer or image that a glTF file
// among `inputs` refers to. Finds this whatever the spelling, and through links. Call it before the work is done; it
// takes next to no time for an output that does not exist yet.
void protect_inputs(const std::vector<std::string>& inputs, const std::vector<std::filesystem::path>& outs);

}  // namespace throng::tools
