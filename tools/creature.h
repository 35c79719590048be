// Makes dragon-like test characters of any size: exactly so many joints, exactly so many levels, about so many
// triangles.
#pragma once

#include <throng/asset.h>
#include <throng/result.h>

#include <cstdint>

namespace throng {

struct CreatureSettings {
    uint32_t joint_count = 300;  // 1 … 65,535, kept exactly
    uint32_t level_count =
        60;  // joints on the longest path from the root to a leaf, kept exactly: 2 … joint_count (1 for one joint)
    uint32_t face_count = 1500;  // triangles, kept within a few; never below the coarsest body (24), at most 10,000,000
    uint64_t seed = 1;           // proportions, colours and phases; the tree of joints does not depend on it
};

// A skinned, animated creature: feet at y = 0, about 2 units high and 4 long, facing +z, y up. One skin of all joints
// (nodes 0 … joint_count - 1, parents first), one mesh node beside the root joint, the looping clips "idle", "walk" and
// "fly" with a rotation track for every joint. Deterministic in the settings: own random numbers and trigonometry, IEEE
// arithmetic only (compile with -ffp-contract=off where the compiler fuses multiply-adds unasked, as GCC does on 64-bit
// Arm). Keys: 30 a second, fewer where all clips together would pass 64 MiB. Errors: kInvalidArgument, the place names
// the option; kOutOfMemory. Thread-safe.
Result<Asset> make_creature(const CreatureSettings& settings);

}  // namespace throng
