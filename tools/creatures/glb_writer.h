// Writes an Asset as a binary glTF 2.0 file.
#pragma once

#include <throng/asset.h>
#include <throng/result.h>

#include <cstddef>
#include <vector>

namespace throng {

// The bytes of one .glb file: nodes, skins, clips (any interpolation), meshes with positions, normals, linear colours
// and up to four influences a vertex, and plain materials. Only what make_creature() produces has been tried; the
// indices inside the asset are assumed valid. Nodes without a parent are the roots of the one scene. Errors:
// kUnsupported for images, texture coordinates, morph targets and more than four influences; kLimit if the file would
// reach 4 GiB; kOutOfMemory. The place names the part of the asset. Thread-safe.
Result<std::vector<std::byte>> write_glb(const Asset& asset);

}  // namespace throng
