// glTF 2.0 from memory: what load_asset() is made of.
#pragma once

#include "import/limits.h"
#include "json/json_text.h"

#include <throng/asset.h>

#include <cstddef>
#include <filesystem>
#include <span>

namespace throng::gltf {

// Reads a file's content. `origin` is where it came from: its name stands in messages, and side files are looked for in
// its folder. Throws Failure; every place begins with the file's name.
Asset read_asset(std::span<const std::byte> bytes, const std::filesystem::path& origin);

// Parses the JSON of a file. Fails with kInvalidFile, and with kLimit where it is larger or deeper than the limits.
JsonText parse_json(std::string_view text, Budget& budget);

}  // namespace throng::gltf
