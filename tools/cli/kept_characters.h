// Compiled characters in the user's cache folder, so that a file that is drawn again need not be compiled again.
#pragma once

#include <throng/character.h>

#include <string>

namespace throng::tools {

// load_character(), or what it returned before for the same bytes under the same name, with the same settings and the
// same build of throng. "The same bytes" includes side files. Keeps the latest 1 GiB, and nothing if the folder cannot
// be written. A checksum decides whether the bytes are the same. It notices accidental changes, but not a file
// that was made to have the checksum of another file of its name and length.
Result<Character> load_kept_character(const std::string& file, const CompileSettings& settings,
                                      const LoadHooks& hooks = {});

}  // namespace throng::tools
