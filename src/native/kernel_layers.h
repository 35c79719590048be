// Lanes are joints: the active clips of a character, in layers -> one block. blend/active_clips.glsl, whose thread
// branches where here all lanes take the same way, but for masks, which are weights; in the spaces of the rows, in
// which differences and their products are those of poses.
#pragma once

#include "native/kernel_decode.h"

namespace {

// An active clip.
struct Part {
    RowPair rows, reference;
    float weight, layer_weight;
    const float* mask;  // NativeRig::masks_in_order(), or none
    uint32_t flags;     // io::kActiveClip…
};

inline constexpr float kCancelled = 1e-12f;  // as blend/active_clips.glsl
inline constexpr float kNoScale = 1e-8f;

INLINE uint32_t find_parts(const KernelRig& rig, const KernelUpdate& update, uint32_t instance, Part* parts) {
    const io::ActiveClip* clips = update.active_clips + size_t{instance} * update.active_clip_limit;
    for (uint32_t i = 0;; ++i) {
        const io::ActiveClip& clip = clips[i];
        Part& part = parts[i];
        part.rows = row_pair(rig, clip.first_track, clip.earlier, clip.later, clip.fraction);
        part.flags = clip.flags;
        if (clip.flags & io::kActiveClipAdditive)
            part.reference = row_pair(rig, clip.first_track, clip.reference_row, clip.reference_row, 0);
        part.weight = clip.weight;
        part.layer_weight = clip.layer_weight;
        const bool is_masked = clip.flags & io::kActiveClipMasked;
        part.mask = is_masked ? update.masks + (clip.flags >> io::kActiveClipMaskShift) * rig.mask_stride : nullptr;
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

template <Decoded kWhat>
INLINE Quad difference(const Quad& to, const Quad& from) {
    if (kWhat == Decoded::kRotations) {
        const V zero = Lanes::set(0);
        return multiply(to, {zero - from.x, zero - from.y, zero - from.z, from.w});
    }
    if (kWhat == Decoded::kMotions) return {to.x - from.x, to.y - from.y, to.z - from.z, ratio(to.w, from.w)};
    return {ratio(to.x, from.x), ratio(to.y, from.y), ratio(to.z, from.z), ratio(to.w, from.w)};
}

// `layer` on `below`.
template <Decoded kWhat>
INLINE Quad apply_layer(const Quad& layer, const Quad& below, V weight, bool is_additive) {
    if (kWhat == Decoded::kRotations) {
        const Quad base = is_additive ? splat_identity(0, 1) : below;
        const V rest = Lanes::flip_where_negative(Lanes::set(1) - weight, dot(layer, base));
        const Quad part = unit(layer * weight + base * rest);
        return is_additive ? multiply(part, below) : part;
    }
    if (!is_additive) return mix(below, layer, weight);
    const Quad part = mix(kWhat == Decoded::kMotions ? splat_identity(0, 1) : splat_identity(1, 1), layer, weight);
    if (kWhat == Decoded::kScales) return {below.x * part.x, below.y * part.y, below.z * part.z, below.w * part.w};
    return {below.x + part.x, below.y + part.y, below.z + part.z, below.w * part.w};
}

template <Decoded kWhat>
INLINE Quad mix_parts(const KernelRig& rig, const Part* parts, uint32_t count, uint32_t block_index, uint32_t lane) {
    const RowBlock& block = rig.blocks[block_index];
    const float* range = rig.ranges + size_t{block_index} * 8 * kBlockJoints;
    Quad result = splat_identity(kWhat == Decoded::kScales ? 1 : 0, 1), sum = splat_identity(0, 0);
    bool is_lowest = true;
    for (uint32_t i = 0; i < count; ++i) {
        const Part& part = parts[i];
        const bool is_additive = part.flags & io::kActiveClipAdditive, ends = part.flags & io::kActiveClipEndsLayer;
        const bool has_weight = part.layer_weight > 0 && (!part.mask || part.mask[rig.place_count + block_index] > 0);
        if (is_lowest || has_weight) {
            Quad pose = quad_between(part.rows, block, range, lane);
            if (kWhat == Decoded::kRotations) pose = unit(pose);
            if (is_additive) {
                Quad from = quad_between(part.reference, block, range, lane);
                if (kWhat == Decoded::kRotations) from = unit(from);
                pose = difference<kWhat>(pose, from);
            }
            V weight = Lanes::set(part.weight);
            if (kWhat == Decoded::kRotations)
                weight = Lanes::flip_where_negative(weight, is_additive ? pose.w : dot(pose, sum));
            sum = sum + pose * weight;
            if (ends) {
                if (kWhat == Decoded::kRotations) {
                    const V square = dot(sum, sum);
                    const Lanes::Mask is_cancelled = Lanes::less(square, Lanes::set(kCancelled));
                    const V one = Lanes::set(1);
                    const Quad mean = sum * Lanes::inverse_sqrt(Lanes::select(is_cancelled, one, square));
                    sum = {Lanes::select(is_cancelled, pose.x, mean.x), Lanes::select(is_cancelled, pose.y, mean.y),
                           Lanes::select(is_cancelled, pose.z, mean.z), Lanes::select(is_cancelled, pose.w, mean.w)};
                }
                V of_layer = Lanes::set(part.layer_weight);
                if (part.mask) of_layer = of_layer * Lanes::load(part.mask + block_index * kBlockJoints + lane);
                if (is_lowest) of_layer = Lanes::set(1);  // it covers
                result = is_lowest && !is_additive ? sum : apply_layer<kWhat>(sum, result, of_layer, is_additive);
                sum = splat_identity(0, 0);
            }
        }
        is_lowest = is_lowest && !ends;
    }
    return result;
}

}  // namespace
