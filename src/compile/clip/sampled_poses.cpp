#include "compile/clip/sampled_poses.h"

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

std::vector<AffineT<double>> model_from_joint_of(const Character& character, const SampledPose& pose) {
    std::vector<AffineT<double>> local;
    if (pose.clip < character.clips.size()) {
        for (const Trs<double>& joint : sample_reference(character, pose.clip, pose.time_s))
            local.push_back(to_affine(joint));
    } else {
        for (const Trs<float>& joint : character.rig.rest) local.push_back(to_affine(joint.as<double>()));
    }
    return scan_reference(character.rig.parents, local);
}

}  // namespace throng
