// glTF 2.0 from memory: what load_asset() is made of.
#pragma once

#include "import/container.h"
#include "json/json_text.h"

#include <throng/asset.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string_view>

namespace throng::gltf {

// Reads a file's content; `name` stands in messages. Throws Failure; every place begins with the name.
Asset read_asset(std::span<const std::byte> bytes, std::string_view name, const SideFiles& side_files,
                 const Progress& progress = {});

// What load_asset() does.
Result<Asset> load_asset(const std::filesystem::path& path, const Progress& progress);

// Parses the JSON of a file. Fails with kInvalidFile, and with kLimit where it is larger or deeper than the limits.
JsonText parse_json(std::string_view text, Budget& budget, const Progress& progress = {});

}  // namespace throng::gltf
