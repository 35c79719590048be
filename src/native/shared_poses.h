// Poses that distant characters may share, as skin matrices: each clip sampled at equal intervals of time, and the
// error of showing the nearest sample. This is baked animation, but it is used only where it is off by at most
// CrowdView::shared_pose_pixels, or where the skin pool is full.
#pragma once

#include "cull/cull_io.h"
#include "native/native_rig.h"

#include <vector>

namespace throng {

struct SharedPoses {
    std::vector<io::SharedClip> clips;  // [clip_count + 1]; the last is the rest pose
    uint32_t row_count = 0;
    // Model space: an upper bound of the distance between the places of a vertex in two of these poses, and a tenth
    // more, since blends go a little beyond them (as boxes for culling assume).
    float spread = 0;
    std::vector<std::byte> skin;  // [row_count][palette_count], in the format that was asked for
};

// How many poses there will be, computed from the lengths of clips alone.
uint64_t shared_pose_count(const Character& character, float poses_per_s);

// Makes at least `poses_per_s` of each clip, including its first and last moment, and one of the rest pose. A clip's
// error is the largest displacement of a linearly blended vertex in the middle of each interval and at the clip's keys.
// The rig must have all joints.
SharedPoses make_shared_poses(const Character& character, const NativeRig& rig, SkinFormat format, float poses_per_s);

}  // namespace throng
