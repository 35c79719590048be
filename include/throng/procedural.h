// Joints that are moved by rules: wind, springs, look-at, reaching. docs/procedural.md defines them.
#pragma once

#include <throng/index.h>
#include <throng/result.h>
#include <throng/transform.h>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace throng {

// Joints are named as in Rig::names. "A joint and all below it" are moved as chains, from the top down: each joint
// starts from where the one above it has been moved to. A joint's bone leads to the next joint of its chain in the rest
// pose; the bone of a last joint continues in the direction of the one before. Lengths and places are in units of the
// world. Rules move the pose that clips, layers or Crowd::set_pose() have made.

// The wind that blows over a whole crowd; Crowd::set_wind(). Without velocity there is no wind. Speed and gust can
// change in each update; if the direction or the wavelength changes, gusts are suddenly elsewhere.
struct Wind {
    Vec3<float> velocity{};  // units a second, world; at most 1e6
    float gust = 0.4f;       // fraction of the speed that comes and goes, 0..1
    float wavelength = 10;   // of the longest gusts, which travel with the wind; 1e-6 or more
};

// A joint and all below it bend with the wind, each joint on its own. Nothing is kept from update to update.
struct WindRule {
    std::string joint{};
    float bend_rad = 0.02f;   // for each unit/s of wind across the bone; never past the wind's direction
    float sway_rad = 0.005f;  // to and fro, for each unit/s of wind across the bone
    float sway_hz = 1;        // rounded to 1/64; 0..64
};

// A capsule that springs stay out of; a sphere where `a` is `b`.
struct Collider {
    std::string joint{};
    Vec3<float> a{}, b{};  // space of the joint
    float radius = 0.1f;   // 0 or more; scaled as the joint is, by its largest factor
};

// The bones of a joint and all below it are springs towards where the pose has them. Stable at any time step.
struct SpringRule {
    std::string joint{};
    float frequency_hz = 2;             // at which a bone would swing; 0..1000
    float damping = 0.4f;               // 1: it returns without swinging; 0..1000
    Vec3<float> gravity{};              // on top of what the pose already shows, units/s^2, world
    float drag = 0;                     // acceleration by the wind for each unit/s, 1/s
    float radius = 0;                   // of the bones' ends, for colliders; 0 or more
    std::vector<Collider> colliders{};  // at most 16
};

// A joint turns so that a direction of it points at a target.
struct LookAtRule {
    std::string joint{};
    std::string target{};
    Vec3<float> forward{0, 0, 1};  // space of the joint
    // The largest turn away from where the pose points, 0..pi; if the target is farther, the joint turns this far
    // towards it
    float limit_rad = 1.5f;
    float weight = 1;  // 0..1, times the target's weight: fraction of the turn
};

// A joint, its parent and its grandparent: the two upper ones turn so that the joint is at a target (two-bone inverse
// kinematics), or as near to it as the length of the limb allows. The limb bends in the plane in which the pose has it
// bent.
struct ReachRule {
    std::string joint{};
    std::string target{};
    Vec3<float> pole{0, 0, 1};  // space of the grandparent's parent: the side to which a straight limb bends
    float weight = 1;           // 0..1, times the target's: part of the way
};

// Where a target of Crowd::set_target() is.
struct TargetPlace {
    Vec3<float> world_place{};
    float weight = 1;  // 0..1: part of the way
};

// Rules are applied in their order: each sees what those before it did. Targets are places that Crowd::set_target()
// moves; no two have the same name. A joint that a rule names must be the only one of its name. Places, directions'
// lengths, radii, gravity and drag are at most 1e15, so that floats hold their squares; a direction is no shorter than
// 1e-15.
using ProceduralRule = std::variant<WindRule, SpringRule, LookAtRule, ReachRule>;
struct ProceduralRules {
    std::vector<std::string> targets{};
    std::vector<ProceduralRule> rules{};

    // Index of the target with this name, for Crowd::set_target(), or kNone. target_named() is the same, but a missing
    // name is an error that says which there are: kInvalidArgument.
    TargetIndex find_target(std::string_view target_name) const;
    Result<TargetIndex> target_named(std::string_view target_name) const;
};

}  // namespace throng
