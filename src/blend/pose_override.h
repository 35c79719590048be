// Poses that the application sets: how they are checked, and how they fade. Shared by crowds and the reference; no
// Vulkan.
#pragma once

#include "base/error_place.h"

#include <throng/transform.h>

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// How far a set pose has faded in over the animated one. Uses floats, like the fades of docs/controller.md, so that
// crowd and reference agree to the bit.
class PoseFade {
public:
    bool is_set() const { return is_set_; }  // set, and not cleared since

    // Fades the pose in over `fade_s` seconds; 0: at once. Does nothing if it is already set.
    void set(float fade_s);
    // Fades the pose out over `fade_s` seconds; 0: at once.
    void clear(float fade_s);
    void advance(float time_step_s);  // negative steps count as 0

    bool is_moving() const { return fade_ != (is_set_ ? 1.0f : 0.0f); }
    bool is_gone() const { return !is_set_ && fade_ == 0; }  // cleared, and faded out
    float weight() const;                                    // 0..1, eased
    bool operator==(const PoseFade&) const = default;

    // Saves or restores the state.
    template <class Archive>
    void exchange(Archive& archive) {
        archive.value(is_set_);
        archive.value(fade_);
        archive.value(rate_);
        Archive::require(fade_ >= 0 && fade_ <= 1 && rate_ >= 0, "the fade of a pose is out of range");
    }

private:
    bool is_set_ = false;
    float fade_ = 0, rate_ = 0;  // per second
};

// Throw kInvalidArgument with `place`.
void check_fade(float fade_s, const ErrorPlace& place);
// Returns the pose, [joint_count], with rotations of length 1. If the rig's scales are uniform, the pose's scales must
// be uniform within a relative 1e-5, and are made exactly uniform.
std::vector<Trs<double>> checked_pose(std::span<const Trs<float>> parent_from_joint, uint32_t joint_count,
                                      bool uniform_scale, const ErrorPlace& place);

}  // namespace throng
