// A track's value at a key, and between two keys.
#pragma once

#include "base/slerp.h"

#include <throng/character.h>

namespace throng {

// x, y, z and 0 of a translation or scale; x, y, z, w of a rotation.
using TrackKey = std::array<float, 4>;  // as exact keys are stored
using TrackValue = std::array<double, 4>;

// In the order of JointTracks.
inline constexpr std::array kTrackTargets{TrackTarget::kRotation, TrackTarget::kTranslation, TrackTarget::kScale};

// tracks.*word_of(target) is the word that locates that track.
constexpr uint32_t JointTracks::*word_of(TrackTarget target) {
    return target == TrackTarget::kRotation      ? &JointTracks::rotation
           : target == TrackTarget::kTranslation ? &JointTracks::translation
                                                 : &JointTracks::scale;
}

inline TrackValue value_of(const TrackKey& key) { return {key[0], key[1], key[2], key[3]}; }
inline TrackValue value_of(const Quaternion<double>& q) { return {q.x, q.y, q.z, q.w}; }
inline TrackValue value_of(const Vec3<double>& v) { return {v.x, v.y, v.z, 0}; }
inline Quaternion<double> quaternion_of(const TrackValue& v) { return {v[0], v[1], v[2], v[3]}; }
inline Vec3<double> vector_of(const TrackValue& v) { return {v[0], v[1], v[2]}; }
inline TrackKey key_of(const TrackValue& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), static_cast<float>(v[3])};
}

// The component of a joint's transform that a track animates.
inline TrackValue component(const Trs<double>& trs, TrackTarget target) {
    if (target == TrackTarget::kRotation) return value_of(trs.rotation);
    return value_of(target == TrackTarget::kTranslation ? trs.translation : trs.scale);
}
inline void set_component(Trs<double>& trs, TrackTarget target, const TrackValue& value) {
    if (target == TrackTarget::kRotation)
        trs.rotation = quaternion_of(value);
    else
        (target == TrackTarget::kTranslation ? trs.translation : trs.scale) = vector_of(value);
}

inline TrackValue lerp(const TrackValue& a, const TrackValue& b, double w) {
    TrackValue out;
    for (size_t c = 0; c < 4; ++c) out[c] = a[c] * (1 - w) + b[c] * w;
    return out;
}

// Interpolates two exact keys: linearly, or along the arc for rotations.
inline TrackValue interpolate_reference(TrackTarget target, const TrackValue& earlier, const TrackValue& later,
                                        double w) {
    if (target != TrackTarget::kRotation) return lerp(earlier, later, w);
    return value_of(slerp(normalized(quaternion_of(earlier)), normalized(quaternion_of(later)), w));
}

}  // namespace throng
