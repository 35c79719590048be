// Meshes and skins -> one vertex pool, one palette.
#pragma once

#include "base/progress.h"
#include "compile/rig/rig.h"

namespace throng {

// Fills skins, palette, vertices, influences, indices, sections, materials and images. character.rig must be set.
// A primitive without triangles has no section. Throws kLimit beyond 65,536 palette entries, 262,144 sections or 2 GiB.
void compile_mesh(const Asset& asset, const RigMap& map, Character& character, const Progress& progress);

}  // namespace throng
