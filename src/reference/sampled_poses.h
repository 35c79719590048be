// Poses in which errors are measured.
#pragma once

#include <throng/character.h>

#include <span>
#include <vector>

namespace throng {

struct SampledPose {
    uint32_t clip = 0;  // clip_count: the rest pose
    double time_s = 0;
};

// The rest pose, then `count` spread evenly over all clips, where there are any.
std::vector<SampledPose> sampled_poses(const Character& character, uint32_t count);

// [joint_count]
std::vector<AffineT<double>> model_from_joint_of(const Rig& rig, std::span<const Trs<double>> pose);
std::vector<AffineT<double>> rest_model_from_joint(const Rig& rig);
std::vector<AffineT<double>> model_from_joint_of(const Character& character, const SampledPose& pose);

}  // namespace throng
