// glTF 2.0 from memory: what load_asset() is made of.
#pragma once

#include <throng/asset.h>

#include <cstddef>
#include <filesystem>
#include <span>

namespace throng::gltf {

// Reads a file's content. `origin` is where it came from: its name stands in messages, and side files are looked for in
// its folder. Throws Failure; every place begins with the file's name.
Asset read_asset(std::span<const std::byte> bytes, const std::filesystem::path& origin);

}  // namespace throng::gltf
