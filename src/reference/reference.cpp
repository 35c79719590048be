// The pipeline in double precision: sample, blend, scan, bind, skin.
#include "reference/reference.h"

#include "base/failure.h"
#include "bind/bind_reference.h"
#include "blend/blend_reference.h"
#include "control/playback.h"
#include "morph/morph_reference.h"
#include "sample/sample_reference.h"
#include "scan/scan_reference.h"
#include "skin/skin_reference.h"

namespace throng {
namespace {

MorphActiveClip active_clip(const Character& character, const ClipPlayback& slot, double weight) {
    if (slot.clip == kNone) return {.clip = static_cast<uint32_t>(character.clips.size()), .weight = weight};
    return {slot.clip, local_time_reference(slot.time_s, character.clips[slot.clip].duration_s, slot.loop), weight};
}

}  // namespace

void check_has_joints(const Character& character) {
    if (character.rig.joint_count() == 0)
        throw Failure(ErrorCode::kInvalidArgument, "character '" + character.name + "'",
                      "has no joints; load or compile a character");
}

ReferencePose pose_from_local(const Character& character, std::span<const Trs<double>> parent_from_joint) {
    ReferencePose pose;
    for (const Trs<double>& joint : parent_from_joint) pose.parent_from_joint.push_back(to_affine(joint));
    pose.model_from_joint = scan_reference(character.rig.parents, pose.parent_from_joint);
    pose.model_from_bind = bind_reference(character.palette, pose.model_from_joint);
    return pose;
}

Result<ReferencePose> reference_pose(const Character& character, const Playback& playback) {
    return as_result([&] {
        check_has_joints(character);
        check_playback(playback, static_cast<uint32_t>(character.clips.size()), character.name);
        const MorphActiveClip first = active_clip(character, playback.first, double{playback.weight}),
                              second = active_clip(character, playback.second, 1 - double{playback.weight});
        const auto sample = [&](const MorphActiveClip& of) { return sample_reference(character, of.clip, of.time_s); };
        std::vector<Trs<double>> pose = sample(playback.weight > 0 ? first : second);
        if (playback.weight > 0 && playback.weight < 1) {
            const std::vector<Trs<double>> other = sample(second);
            for (size_t joint = 0; joint < pose.size(); ++joint)
                pose[joint] = blend_reference(pose[joint], other[joint], playback.weight);
        }
        ReferencePose out = pose_from_local(character, pose);
        out.morph_weights = morphs_reference(character, {{{.active_clips = {first, second}}}});
        return out;
    });
}

std::vector<Vec3<double>> reference_positions(const Character& character, const ReferencePose& pose) {
    return skin_reference(character, pose.model_from_bind, active_morphs_reference(pose.morph_weights));
}

}  // namespace throng
