#include "reference/sampled_poses.h"

#include "sample/sample_reference.h"
#include "scan/scan_reference.h"

namespace throng {

std::vector<SampledPose> sampled_poses(const Character& character, uint32_t count) {
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    std::vector<SampledPose> poses{{.clip = clip_count}};
    for (uint32_t i = 0; i < count && clip_count > 0; ++i) {
        const double at = (i + 0.5) / count * clip_count;  // in clips
        const auto clip = static_cast<uint32_t>(at);
        poses.push_back({clip, (at - clip) * double{character.clips[clip].duration_s}});
    }
    return poses;
}

std::vector<AffineT<double>> model_from_joint_of(const Rig& rig, std::span<const Trs<double>> pose) {
    std::vector<AffineT<double>> local;
    for (const Trs<double>& joint : pose) local.push_back(to_affine(joint));
    return scan_reference(rig.parents, local);
}

std::vector<AffineT<double>> rest_model_from_joint(const Rig& rig) {
    std::vector<Trs<double>> pose;
    for (const Trs<float>& joint : rig.rest) pose.push_back(joint.as<double>());
    return model_from_joint_of(rig, pose);
}

std::vector<AffineT<double>> model_from_joint_of(const Character& character, const SampledPose& pose) {
    if (pose.clip >= character.clips.size()) return rest_model_from_joint(character.rig);
    return model_from_joint_of(character.rig, sample_reference(character, pose.clip, pose.time_s));
}

}  // namespace throng
