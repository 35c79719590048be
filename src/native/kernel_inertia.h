// Lanes are joints: applies the offsets of inertial transitions, and pose overrides, to the poses of the clips. Does
// the same as blend/inertia.glsl and blend/inertial.glsl, but lanes select where a shader thread branches. The spaces
// of the rows keep the angles of rotations and the ratios of lengths, so offsets decay there as those of local poses
// do.
#pragma once

#include "native/kernel_layers.h"

namespace {

// Where the values begin in the state that a block keeps between updates: [float][joint of the block].
inline constexpr uint32_t kShown = 0, kShownBefore = 4, kOffset = 8;

INLINE V min(V a, V b) { return Lanes::select(Lanes::less(b, a), b, a); }
INLINE V max(V a, V b) { return Lanes::select(Lanes::less(a, b), b, a); }
// `v` where `positive` is more than 0, else 0.
INLINE V where(V positive, V v) { return Lanes::select(Lanes::less(Lanes::set(0), positive), v, Lanes::set(0)); }

// As gpu/angles.glsl.
INLINE V polynomial(const float* coefficients, uint32_t count, V s) {
    V p = Lanes::set(coefficients[0]);
    for (uint32_t i = 1; i < count; ++i) p = p * s + Lanes::set(coefficients[i]);
    return p;
}
INLINE V atan_unit(V r) {
    constexpr float kTerms[] = {0.0028662257f, -0.0161657367f, 0.0429096138f, -0.0752896400f,
                                0.1065626393f, -0.1420889944f, 0.1999355085f, -0.3333314528f};
    const V s = r * r;
    return r + r * s * polynomial(kTerms, 8, s);
}
INLINE V sin_quarter(V x) {
    constexpr float kTerms[] = {-0.0000000239f, 0.0000027526f, -0.0001984090f, 0.0083333315f, -0.1666666664f};
    const V s = x * x;
    return x + x * s * polynomial(kTerms, 5, s);
}
inline constexpr float kHalfPi = 1.57079632679f;

struct Three {
    V x, y, z;
};
INLINE V dot(const Three& a, const Three& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE Three operator*(const Three& v, V s) { return {v.x * s, v.y * s, v.z * s}; }
INLINE Three operator-(const Three& a, const Three& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
INLINE V length(const Three& v) { return Lanes::sqrt(dot(v, v)); }
INLINE V divided(V a, V b) {  // 0 where b is
    const Lanes::Mask has = Lanes::less(Lanes::set(0), b);
    return Lanes::select(has, a / Lanes::select(has, b, Lanes::set(1)), Lanes::set(0));
}

INLINE V decayed(V x, V v, float elapsed_s, float duration_s) {
    const V zero = Lanes::set(0), duration = Lanes::set(duration_s), elapsed = Lanes::set(elapsed_s);
    const Lanes::Mask moves = Lanes::less(v, zero);
    const V end_s = Lanes::select(moves, min(duration, Lanes::set(-5) * x / Lanes::select(moves, v, Lanes::set(-1))),
                                  duration);
    const V s = elapsed / end_s, u = v * end_s, a = max(Lanes::set(-8) * u - Lanes::set(20) * x, zero);
    const auto times = [](float factor, V of) { return Lanes::set(factor) * of; };
    V p = times(-0.5f, a + times(6, u) + times(12, x));
    p = p * s + times(0.5f, times(3, a) + times(16, u) + times(30, x));
    p = p * s - times(0.5f, times(3, a) + times(12, u) + times(20, x));
    p = p * s + times(0.5f, a);
    p = p * s + u;
    return Lanes::select(Lanes::less(elapsed, end_s), p * s + x, zero);
}
// What is left of an offset of this length, as a factor.
INLINE V left_of(V size, V speed, float elapsed_s, float duration_s) {
    return divided(decayed(size, speed, elapsed_s, duration_s), size);
}

INLINE V angle_about(const Quad& q, const Three& axis) {
    const V sine = Lanes::flip_where_negative(dot(Three{q.x, q.y, q.z}, axis), q.w);
    const V cosine = Lanes::flip_where_negative(q.w, q.w);
    const V size = Lanes::sqrt(sine * sine + cosine * cosine);
    return Lanes::set(4) * atan_unit(divided(sine, size + cosine));
}

// If inertia.begins, sets new offsets of the shown poses from the target. Returns the pose that is shown now.
template <Decoded kWhat>
INLINE Quad inertial(const io::InstanceInertia& inertia, const Quad& target, float* state) {
    constexpr uint32_t kStride = kBlockJoints;
    const auto load = [&](uint32_t first) {
        const float* at = state + first * kStride;
        return Quad{Lanes::load(at), Lanes::load(at + kStride), Lanes::load(at + 2 * kStride),
                    Lanes::load(at + 3 * kStride)};
    };
    const auto save = [&](uint32_t first, const Quad& q) {
        float* at = state + first * kStride;
        Lanes::store(at, q.x);
        Lanes::store(at + kStride, q.y);
        Lanes::store(at + 2 * kStride, q.z);
        Lanes::store(at + 3 * kStride, q.w);
    };
    const V zero = Lanes::set(0);
    const Quad shown = load(kShown);
    if (inertia.begins != 0) {
        const bool knows_speed = inertia.shown_count > 2;
        const V step_s = Lanes::set(knows_speed && inertia.shown_step_s > 0 ? inertia.shown_step_s : 1e30f);
        const Quad before = knows_speed ? load(kShownBefore) : shown;
        if (kWhat == Decoded::kRotations) {
            const Quad back{zero - target.x, zero - target.y, zero - target.z, target.w};
            const Quad offset = multiply(shown, back), offset_before = multiply(before, back);
            const Three sine{Lanes::flip_where_negative(offset.x, offset.w),
                             Lanes::flip_where_negative(offset.y, offset.w),
                             Lanes::flip_where_negative(offset.z, offset.w)};
            const V size = length(sine);
            const Three axis{divided(sine.x, size), divided(sine.y, size), divided(sine.z, size)};
            const V angle = angle_about(offset, axis);
            V step = angle - angle_about(offset_before, axis);  // by the shorter way
            const V turn = Lanes::set(4 * kHalfPi), half = Lanes::set(2 * kHalfPi);
            step = Lanes::select(Lanes::less(half, step), step - turn, step);
            step = Lanes::select(Lanes::less(step, zero - half), step + turn, step);
            save(kOffset, {axis.x * angle, axis.y * angle, axis.z * angle, min(step / step_s, zero)});
        } else {
            const Quad offset = shown - target, offset_before = before - target;
            const Three way{offset.x, offset.y, offset.z};
            const V size = length(way);
            const Three direction{divided(way.x, size), divided(way.y, size), divided(way.z, size)};
            const V along = dot(Three{offset_before.x, offset_before.y, offset_before.z}, direction);
            save(kOffset, {way.x, way.y, way.z, min((size - along) / step_s, zero)});
            const V scale = Lanes::flip_where_negative(offset.w, offset.w);  // its absolute value
            const V scale_before = Lanes::flip_where_negative(offset_before.w, offset.w);
            Lanes::store(state + (kOffset + 4) * kStride, offset.w);
            Lanes::store(state + (kOffset + 5) * kStride, min((scale - scale_before) / step_s, zero));
        }
    }
    Quad pose = target;
    if (inertia.elapsed_s < inertia.duration_s) {
        const Quad offset = load(kOffset);
        const Three way{offset.x, offset.y, offset.z};
        const V left = left_of(length(way), offset.w, inertia.elapsed_s, inertia.duration_s);
        if (kWhat == Decoded::kRotations) {
            const Three half_turn = way * (Lanes::set(0.5f) * left);
            const V size = length(half_turn), angle = min(size, Lanes::set(kHalfPi));
            const Three axis{divided(half_turn.x, angle), divided(half_turn.y, angle), divided(half_turn.z, angle)};
            const V sine = sin_quarter(angle);
            pose = multiply({axis.x * sine, axis.y * sine, axis.z * sine, sin_quarter(Lanes::set(kHalfPi) - angle)},
                            target);
        } else {
            const V scale = Lanes::load(state + (kOffset + 4) * kStride);
            const V scale_left = left_of(Lanes::flip_where_negative(scale, scale),
                                         Lanes::load(state + (kOffset + 5) * kStride), inertia.elapsed_s,
                                         inertia.duration_s);
            pose = {target.x + left * way.x, target.y + left * way.y, target.z + left * way.z,
                    target.w + scale_left * scale};
        }
    }
    save(kShownBefore, shown);
    save(kShown, pose);
    return pose;
}

// Blends a pose override of weight > 0 over the animated pose: blend/pose_override.glsl.
template <Decoded kWhat>
INLINE Quad overridden(const float* set_pose, const Quad& animated, float weight) {
    const Quad pose{Lanes::load(set_pose), Lanes::load(set_pose + kBlockJoints),
                    Lanes::load(set_pose + 2 * kBlockJoints), Lanes::load(set_pose + 3 * kBlockJoints)};
    if (weight >= 1) return pose;
    if (kWhat == Decoded::kRotations) return blend_of_any_length(pose, animated, Lanes::set(weight));
    return mix(animated, pose, Lanes::set(weight));
}

}  // namespace
