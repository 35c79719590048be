// Cursors into clips, and the error of a pose.
#pragma once

#include "control/control_reference.h"
#include "sample/sample_io.h"
#include "tests/test_rig.h"

#include <algorithm>
#include <cmath>

namespace throng::test {

// Clips are numbered from 0. The number after the last clip is the rest pose.
inline io::ClipCursor cursor_at(const Character& character, uint32_t clip, double time_s) {
    return cursor_reference({.clip = clip < character.clips.size() ? clip : kNone, .time_s = time_s, .loop = false},
                            character.clips, character.times_s, character.rig.joint_count());
}

// A time in a clip, or the rest pose.
struct Moment {
    uint32_t clip = 0;
    double time_s = 0;

    io::ClipCursor cursor(const Character& character) const { return cursor_at(character, clip, time_s); }
};
inline Moment random_moment(Random& random, const Character& character) {
    const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size() + 1));
    return {clip, clip < character.clips.size() ? random.between(0, double{character.clips[clip].duration_s}) : 0};
}

inline double component_error(double got, double wanted) {
    const double error = std::abs(got - wanted) / std::max(1.0, std::abs(wanted));
    return std::isnan(error) ? 1e9 : error;
}

// q and -q are the same rotation.
inline double pose_error(const io::JointPose& got, const Trs<double>& wanted) {
    const Quaternion<double> q{got.rotation.x, got.rotation.y, got.rotation.z, got.rotation.w};
    const Quaternion<double> w = dot(q, wanted.rotation) < 0 ? -wanted.rotation : wanted.rotation;
    return std::max({component_error(q.x, w.x), component_error(q.y, w.y), component_error(q.z, w.z),
                     component_error(q.w, w.w), component_error(got.translation.x, wanted.translation.x),
                     component_error(got.translation.y, wanted.translation.y),
                     component_error(got.translation.z, wanted.translation.z),
                     component_error(got.scale.x, wanted.scale.x), component_error(got.scale.y, wanted.scale.y),
                     component_error(got.scale.z, wanted.scale.z)});
}

}  // namespace throng::test
