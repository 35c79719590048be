// The poses that levels of detail are made in, of a compiled character.
#pragma once

#include "compile/mesh/posed_mesh.h"
#include "sample/sample_reference.h"

namespace throng::test {

// The rest pose, and `count` poses of clips.
inline std::vector<MeshPose> poses_of(const Character& character, uint32_t count) {
    return mesh_poses(character, count,
                      [&](const SampledPose& pose) { return sample_reference(character, pose.clip, pose.time_s); });
}

}  // namespace throng::test
