// Poses that characters far away may share: of each clip one at equal intervals of time, as skin matrices, and how far
// off the nearest of them is. They are what baked animation is, but chosen by what a picture shows of the difference.
#pragma once

#include "cull/cull_io.h"
#include "native/native_rig.h"

#include <vector>

namespace throng {

struct SharedPoses {
    std::vector<io::SharedClip> clips;  // [clip_count + 1]; the last is the rest pose
    uint32_t row_count = 0;
    // Model space: how far a vertex is at most from where it is in another of these poses, and a tenth more, since
    // blends go a little beyond them (as boxes for culling assume).
    float spread = 0;
    std::vector<std::byte> skin;  // [row_count][palette_count], in the format that was asked for
};

// How many there will be, from the lengths of clips alone.
uint64_t shared_pose_count(const Character& character, float poses_per_s);

// At least `poses_per_s` of each clip, its first and its last moment among them; of the rest pose one. A clip's error
// is the largest displacement of a vertex, blended linearly, in the middle of each interval and at the clip's keys. The
// rig is of all joints.
SharedPoses make_shared_poses(const Character& character, const NativeRig& rig, SkinFormat format, float poses_per_s);

}  // namespace throng
