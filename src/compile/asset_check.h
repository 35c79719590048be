// What an Asset must satisfy to be compiled. load_asset() ensures it; an engine that fills one itself can get it wrong.
#pragma once

#include <throng/asset.h>

namespace throng {

// Throws kInvalidArgument, naming the place, for indices out of range, arrays of another length than asset.h says,
// numbers that are not finite, keys out of order, nodes that are their own ancestors.
void check_asset(const Asset& asset);
// The same for nodes, skins, and what says where meshes are and which morph targets they have: without going through
// vertices and keys.
void check_rig(const Asset& asset);

}  // namespace throng
