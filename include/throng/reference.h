// The definition of every stage: scalar, double precision, on the CPU, no Vulkan. The kernels are tested against it; a program uses
// it for the exact pose of one character now (hit tests, servers).
#pragma once

#include <throng/crowd.h>

#include <vector>

namespace throng {

struct ReferencePose {
    std::vector<AffineT<double>> parent_from_joint;  // [joint_count]
    std::vector<AffineT<double>> model_from_joint;   // [joint_count]
    std::vector<AffineT<double>> model_from_bind;    // [palette_count], the skin matrices
};

// The pose that `playback` shows at its times (speeds do not matter). Errors: kInvalidArgument, as Crowd::set_playback.
Result<ReferencePose> reference_pose(const Character& character, const Playback& playback);

// Positions of all vertices in model space, in the order of Character::vertices.
std::vector<Vec3<double>> reference_positions(const Character& character, const ReferencePose& pose);

}  // namespace throng
