#include <throng/joint_sampler.h>

#include "base/default_floats.h"
#include "base/failure.h"
#include "control/control_reference.h"
#include "control/playback.h"
#include "native/native.h"

namespace throng {

class NativeJoints {
public:
    NativeJoints(const Character& character, std::span<const uint32_t> joints)
        : joint_count_(joints.size()),
          rig_joint_count_(character.rig.joint_count()),
          clips_(character.clips),
          times_s_(character.times_s),
          rig_(character, {.sockets = {joints.begin(), joints.end()}, .sockets_only = true}) {}

    void sample(const Playback& playback, std::span<Affine> model_from_joint) const {
        if (model_from_joint.size() != joint_count_)
            throw Failure(ErrorCode::kInvalidArgument, "joint sampler",
                          "model_from_joint has " + std::to_string(model_from_joint.size()) +
                              " elements, but the sampler has " + std::to_string(joint_count_) + " joints");
        check_playback(playback, static_cast<uint32_t>(clips_.size()), "joint sampler");
        const DefaultFloats floats;  // for the cursor too, on which the result depends
        const auto cursor_of = [&](const ClipPlayback& one) {
            return cursor_reference(one, clips_, times_s_, rig_joint_count_);
        };
        const io::InstanceCursor cursor{cursor_of(playback.first), cursor_of(playback.second), playback.weight};
        update(rig_, {.cursors = &cursor, .sockets = model_from_joint.data()}, 0, 1);
    }

private:
    size_t joint_count_;
    uint32_t rig_joint_count_;
    std::vector<Clip> clips_;
    std::vector<float> times_s_;
    NativeRig rig_;
};

Result<JointSampler> JointSampler::create(const Character& character, std::span<const uint32_t> joints) {
    return as_result([&] {
        const std::string place = character.name + ": joint sampler";
        if (joints.empty()) throw Failure(ErrorCode::kInvalidArgument, place, "joints is empty");
        for (const uint32_t joint : joints)
            if (joint >= character.rig.joint_count())
                throw Failure(ErrorCode::kInvalidArgument, place, numbered("joint", joint),
                              " is out of range: the character has ", character.rig.joint_count(), " joints");
        if (const std::string reason = native_unsupported_reason(character, SkinFormat::kAffine); !reason.empty())
            throw Failure(ErrorCode::kUnsupported, place, reason);
        return JointSampler(std::make_shared<const NativeJoints>(character, joints));
    });
}

JointSampler::JointSampler(std::shared_ptr<const NativeJoints> joints) : joints_(std::move(joints)) {}

Result<void> JointSampler::sample(const Playback& playback, std::span<Affine> model_from_joint) const {
    return as_result([&] {
        if (!joints_)
            throw Failure(ErrorCode::kInvalidArgument, "joint sampler", "it was moved to another JointSampler");
        joints_->sample(playback, model_from_joint);
    });
}

}  // namespace throng
