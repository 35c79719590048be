// Compiled characters in the user's cache folder, so that a file which is drawn again need not be compiled again.
#pragma once

#include <throng/character.h>

#include <string>

namespace throng::tools {

// load_character(); or what it gave for the same bytes under the same name, with the same settings, by the same build
// of throng. .glb files without side files are kept, the latest 1 GiB of them; nothing where the folder cannot be
// written.
Result<Character> load_kept_character(const std::string& file, const CompileSettings& settings);

}  // namespace throng::tools
