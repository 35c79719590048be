// Lanes are joints: the active clips of a character, in layers -> one block. Does the same as blend/active_clips.glsl,
// but all lanes take the same branch where each shader thread takes its own, and masks are weights, not branches. Works
// in the spaces of the rows, where differences of poses, and products with them, give the same results (native_rig.h).
#pragma once

#include "native/kernel_decode.h"

namespace {

// Where the rows of an active clip lie, and how much it counts.
struct ActiveClipRows {
    RowPair rows, reference;
    float weight, layer_weight;
    const float* mask;  // NativeRig::masks_in_order(), or none
    uint32_t flags;     // io::kActiveClip…
};

inline constexpr float kCancelled = 1e-12f;  // as blend/active_clips.glsl
inline constexpr float kNoScale = 1e-8f;

INLINE uint32_t find_active_clips(const KernelRig& rig, const KernelUpdate& update, uint32_t instance,
                                  ActiveClipRows* active_clips) {
    const io::ActiveClip* clips = update.active_clips + size_t{instance} * update.active_clip_limit;
    for (uint32_t i = 0;; ++i) {
        const io::ActiveClip& clip = clips[i];
        ActiveClipRows& clip_rows = active_clips[i];
        clip_rows.rows = row_pair(rig, clip.first_track, clip.earlier, clip.later, clip.fraction);
        clip_rows.flags = clip.flags;
        if (clip.flags & io::kActiveClipAdditive)
            clip_rows.reference = row_pair(rig, clip.first_track, clip.reference_row, clip.reference_row, 0);
        clip_rows.weight = clip.weight;
        clip_rows.layer_weight = clip.layer_weight;
        const bool is_masked = clip.flags & io::kActiveClipMasked;
        clip_rows.mask = is_masked ? update.masks + (clip.flags >> io::kActiveClipMaskShift) * rig.mask_stride
                                   : nullptr;
        if ((clip.flags & io::kActiveClipEnds) || i + 1 == update.active_clip_limit) return i + 1;
    }
}

INLINE Quad multiply(const Quad& a, const Quad& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
INLINE Quad splat_identity(float x, float w) { return {Lanes::set(x), Lanes::set(x), Lanes::set(x), Lanes::set(w)}; }
INLINE Quad unit(const Quad& q) { return q * Lanes::inverse_sqrt(dot(q, q)); }

INLINE V ratio(V to, V from) {
    const Lanes::Mask has_none = Lanes::less(from * from, Lanes::set(kNoScale * kNoScale));
    const V one = Lanes::set(1);
    return Lanes::select(has_none, one, to / Lanes::select(has_none, one, from));
}

// For rotations, the length of the result is the product of both lengths.
template <Decoded kWhat>
INLINE Quad difference(const Quad& to, const Quad& from) {
    if (kWhat == Decoded::kRotations) {
        const V zero = Lanes::set(0);
        return multiply(to, {zero - from.x, zero - from.y, zero - from.z, from.w});
    }
    if (kWhat == Decoded::kMotions) return {to.x - from.x, to.y - from.y, to.z - from.z, ratio(to.w, from.w)};
    return {ratio(to.x, from.x), ratio(to.y, from.y), ratio(to.z, from.z), ratio(to.w, from.w)};
}

// Applies `layer` on top of `below`.
template <Decoded kWhat>
INLINE Quad apply_layer(const Quad& layer, const Quad& below, V weight, bool is_additive) {
    if (kWhat == Decoded::kRotations) {
        const V rest = Lanes::flip_where_negative(Lanes::set(1) - weight, is_additive ? layer.w : dot(layer, below));
        const Quad weighed = layer * weight;
        if (!is_additive) return unit(weighed + below * rest);
        return multiply(unit({weighed.x, weighed.y, weighed.z, weighed.w + rest}), below);
    }
    if (!is_additive) return mix(below, layer, weight);
    const Quad part = mix(kWhat == Decoded::kMotions ? splat_identity(0, 1) : splat_identity(1, 1), layer, weight);
    if (kWhat == Decoded::kScales) return {below.x * part.x, below.y * part.y, below.z * part.z, below.w * part.w};
    return {below.x + part.x, below.y + part.y, below.z + part.z, below.w * part.w};
}

// The mean of a layer's rotations; `last` where they cancel out.
INLINE Quad mean_of(const Quad& sum, const Quad& last) {
    const V square = dot(sum, sum);
    const Lanes::Mask is_cancelled = Lanes::less(square, Lanes::set(kCancelled));
    if (!Lanes::any(is_cancelled)) [[likely]]
        return sum * Lanes::inverse_sqrt(square);
    const Quad mean = sum * Lanes::inverse_sqrt(Lanes::select(is_cancelled, Lanes::set(1), square)), other = unit(last);
    return {Lanes::select(is_cancelled, other.x, mean.x), Lanes::select(is_cancelled, other.y, mean.y),
            Lanes::select(is_cancelled, other.z, mean.z), Lanes::select(is_cancelled, other.w, mean.w)};
}

INLINE Quad load_quad(const float* of_first, size_t stride) {
    return {Lanes::load(of_first), Lanes::load(of_first + stride), Lanes::load(of_first + 2 * stride),
            Lanes::load(of_first + 3 * stride)};
}

// The outer loop goes over the clips, so that a clip's branches are taken once per block.
template <Decoded kWhat>
INLINE void mix_active_clips(const KernelRig& rig, const ActiveClipRows* active_clips, uint32_t count,
                             uint32_t block_index, DecodedBlock& out, uint32_t character) {
    constexpr bool kTurns = kWhat == Decoded::kRotations;
    const RowBlock& block = rig.blocks[block_index];
    const float* range = rig.ranges + size_t{block_index} * 8 * kBlockJoints;
    alignas(64) float sums[4 * kBlockJoints];
    bool is_lowest = true, begins = true;
    for (uint32_t i = 0; i < count; ++i) {
        const ActiveClipRows& clip_rows = active_clips[i];
        const bool is_additive = clip_rows.flags & io::kActiveClipAdditive,
                   ends = clip_rows.flags & io::kActiveClipEndsLayer;
        const bool has_weight = clip_rows.layer_weight > 0 &&
                                (!clip_rows.mask || clip_rows.mask[rig.place_count + block_index] > 0);
        for (uint32_t lane = 0; (is_lowest || has_weight) && lane < kBlockJoints; lane += Lanes::kCount) {
            Quad pose = quad_between(clip_rows.rows, block, range, lane);
            V square = dot(pose, pose), weight = Lanes::set(clip_rows.weight);
            if (is_additive) {
                const Quad from = quad_between(clip_rows.reference, block, range, lane);
                if (kTurns) square = square * dot(from, from);
                pose = difference<kWhat>(pose, from);
            }
            if (kTurns) {
                weight = begins && ends ? Lanes::inverse_sqrt(square) : weight * Lanes::inverse_sqrt(square);
                if (is_additive) weight = Lanes::flip_where_negative(weight, pose.w);
            }
            Quad sum;
            if (begins) {
                sum = pose * weight;
            } else {
                const Quad before = load_quad(sums + lane, kBlockJoints);
                if (kTurns && !is_additive) weight = Lanes::flip_where_negative(weight, dot(pose, before));
                sum = before + pose * weight;
            }
            if (!ends) {
                Lanes::store(sums + lane, sum.x);
                Lanes::store(sums + kBlockJoints + lane, sum.y);
                Lanes::store(sums + 2 * kBlockJoints + lane, sum.z);
                Lanes::store(sums + 3 * kBlockJoints + lane, sum.w);
                continue;
            }
            if (kTurns && !begins) sum = mean_of(sum, pose);
            if (!is_lowest) {  // the lowest covers everything
                V of_layer = Lanes::set(clip_rows.layer_weight);
                if (clip_rows.mask)
                    of_layer = of_layer * Lanes::load(clip_rows.mask + block_index * kBlockJoints + lane);
                const Quad below = load_quad(&out.of[0][character][lane], Lanes::kCount * kBlockJoints);
                sum = apply_layer<kWhat>(sum, below, of_layer, is_additive);
            }
            store_quad(out, character, lane, sum);
        }
        is_lowest = is_lowest && !ends;
        begins = ends;
    }
}

}  // namespace
