// Makes animated test characters of any size, in four kinds, with an exact number of joints, an exact number of levels
// and about a given number of triangles.
#pragma once

#include <throng/asset.h>
#include <throng/result.h>

#include <cstdint>
#include <string>

namespace throng {

enum class CreatureKind : uint8_t { kDragon, kWillow, kWalker, kCentipede };

struct CreatureSettings {
    uint32_t joint_count = 300;  // 1 … 65,535, kept exactly
    uint32_t level_count =
        60;  // joints on the longest path from the root to a leaf, kept exactly: 2 … joint_count (1 for one joint)
    uint32_t face_count = 1500;  // triangles, kept within a few; never below the coarsest body (24), at most 10,000,000
    uint64_t seed = 1;           // proportions, colours and phases; the tree of joints does not depend on it
    CreatureKind kind = CreatureKind::kDragon;
};

// The sizes that suit the kind.
CreatureSettings creature_settings(CreatureKind kind);
// "dragon", "willow", "walker" or "centipede". kInvalidArgument for any other name.
Result<CreatureKind> creature_kind(const std::string& name);

// A skinned, animated creature: feet at y = 0, about 2 units high (the centipede 0.5, and 5 long), facing +z, y up. One
// skin of all joints (nodes 0 … joint_count - 1, parents first), one mesh node beside the root joint, looping clips
// with a rotation track for every joint:
//   dragon     idle, walk, fly, glide, roar
//   willow     calm, gust
//   walker     idle, walk, run, wave
//   centipede  idle, walk, curl
// Deterministic in the settings: it uses its own random numbers and trigonometry, and IEEE arithmetic only (compile
// with -ffp-contract=off if the compiler fuses multiply-adds by default, as GCC does on 64-bit Arm). There are 30 keys
// a second, or fewer if all clips together would exceed 64 MiB. Errors: kInvalidArgument, where the place names the
// option; kOutOfMemory. Thread-safe.
Result<Asset> make_creature(const CreatureSettings& settings);

}  // namespace throng
