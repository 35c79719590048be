// The creature's body plan: chains of joints in model space. The mesh and the clips are made from it alone.
#pragma once

#include "creature.h"
#include "creature_math.h"

#include <optional>
#include <vector>

namespace throng::creature {

enum class Part : uint8_t { kTail, kTrunk, kJaw, kLeg, kToe, kArm, kFinger, kTendril };

// Joints one after the other along a limb. Joint k stands at begin + k * step of the outline and moves what comes after
// it.
struct Chain {
    Part part = Part::kTail;
    uint32_t parent_joint = 0;  // that the first joint hangs from
    uint32_t first_joint = 0, joint_count = 0;
    Outline outline;
    double begin = 0, step = 0;
    Vec up{0, 1, 0};                   // the y axis of its joints, as far as it is perpendicular to the limb
    double side = 0;                   // +1 left (x > 0), -1 right, 0 in the middle
    double phase_turns = 0;            // of its waves; the same left and right
    uint32_t number = 0;               // leg: 0 front, 1 hind; finger, toe: from the first to the last
    std::optional<double> grows_at{};  // where it grows out of the body, on the axis; none for fingers and toes

    double at(uint32_t k) const { return begin + k * step; }
};

// Where a wing's membrane meets the body.
struct Flank {
    Vec shoulder, hip;
};

// The axis goes from the snout at 0 to the tip of the tail at 1. The root joint stands on it, at the hips; the trunk
// goes from there forward to the head, the tail backward. A creature with no joints left for a trunk is a snake: its
// root is its head.
struct Body {
    std::vector<Chain> chains;       // parents first; the tail and the trunk (either may be missing) come first
    std::vector<uint32_t> parent;    // [joint]
    std::vector<uint32_t> level;     // [joint] 1 for the root
    std::vector<Vec> position;       // [joint] at rest, in model space
    std::vector<Rotation> rotation;  // [joint] model_from_joint at rest, z along the limb
    Outline axis;
    double root_at = 0;  // on the axis
    Flank left_flank, right_flank;

    const Chain* find(Part part) const;
    uint32_t joint_count() const { return uint32_t(parent.size()); }
    // The joint that moves the body's flesh at `t` of the axis.
    uint32_t axis_joint(double t) const;
};

Body make_body(const CreatureSettings& settings);
AssetMesh make_mesh(const Body& body, const CreatureSettings& settings);
std::vector<AssetClip> make_clips(const Body& body, const std::vector<AssetNode>& nodes);

}  // namespace throng::creature
