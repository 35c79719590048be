// Looping clips: every joint's bend as a function of its place in its chain and of the part of the loop that has
// passed.
#pragma once

#include "tools/creatures/body.h"

#include <map>

namespace throng::creature {

struct ClipPlan {
    const char* name;
    uint32_t ticks;  // of 1/30 s
};

// Turns of a joint relative to its rest pose, radians: pitch lowers the limb's end (towards -up), yaw swings it to the
// left (towards cross(up, forward)), roll turns it about itself. A clip holds whole periods of every wave, so that the
// loop closes.
struct Bend {
    double pitch = 0, yaw = 0, roll = 0;
};

// One joint of a chain at one key of a clip.
struct Moment {
    const Chain& chain;
    uint32_t k;
    uint32_t clip;  // index of the plan
    double loop;    // the part of the clip that has passed, in turns

    double along() const { return (k + 0.5) / chain.joint_count; }
    double share() const { return 1.0 / chain.joint_count; }  // of a bend of the whole chain
    // The joint's share of a bend spread smoothly over from … to of the chain; the shares of all joints sum to 1.
    double share_between(double from, double to) const {
        return smooth_step(from, to, (k + 1) * share()) - smooth_step(from, to, k * share());
    }
};

// The whole body's motion: an offset of the root joint in model space, and a turn about itself.
struct RootMotion {
    Vec offset;
    Bend bend;
};

using BendOf = Bend (*)(const Moment&);

// A kind's clips. The bend per joint should shrink as the chain gets longer, so that a limb of 100 joints bends as far
// in all as one of 5.
struct Motion {
    std::vector<ClipPlan> clips;
    std::map<std::string_view, BendOf> bends;  // of the joints of each part
    RootMotion (*root)(uint32_t clip, double loop);
};

std::vector<AssetClip> make_clips(const Body& body, const std::vector<AssetNode>& nodes, const Motion& motion);

}  // namespace throng::creature
