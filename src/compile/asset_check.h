// What an Asset must satisfy to be compiled. load_asset() ensures it; an engine that fills one itself can get it wrong.
#pragma once

#include <throng/asset.h>

namespace throng {

// Throws kInvalidArgument, naming the place, for indices out of range, arrays whose length is not what asset.h says,
// numbers that are not finite, keys out of order, and nodes that are their own ancestors.
void check_asset(const Asset& asset);
// Checks only the nodes, the skins, the mesh instances and the numbers of morph targets. Does not go through vertices
// and keys.
void check_rig(const Asset& asset);

}  // namespace throng
