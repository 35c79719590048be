// Lanes are joints: rows of a character's clips -> one block of rotations, motions or scales.
#pragma once

#include "native/kernel_lanes.h"
#include "native/kernel_update.h"

namespace {

using namespace throng::native;
using namespace throng;

// A time in a clip: two neighbouring rows, and the place between them.
struct RowPair {
    const std::byte *earlier, *later;
    float fraction;
    int weights;  // for 16-bit words: two of 15 bits that sum to 32767, the later row's in the high half
};

// The times in two clips that one character plays, and their blend weight.
struct Played {
    RowPair first, second;
    float weight;
    uint32_t instance;
};

// [component][character][joint of the block], then transposed: [component][joint of the block][character]
struct alignas(64) DecodedBlock {
    float of[4][Lanes::kCount][kBlockJoints];
};
struct alignas(64) TransposedBlock {
    float of[4][kBlockJoints][Lanes::kCount];
};

INLINE RowPair row_pair(const KernelRig& rig, uint32_t track, uint32_t earlier, uint32_t later, float fraction) {
    const RowClip& clip = rig.clips[static_cast<uint32_t>(track * rig.clip_from_track + 0.5)];
    const RowSpan& span = clip.spans[static_cast<uint32_t>((earlier - clip.first_key) * clip.span_from_key + 0.5)];
    const float place = fraction * span.piece_count;
    const float last = span.piece_count - 1;
    const float piece = static_cast<float>(static_cast<int>(place < last ? place : last));
    const size_t row = span.first_row + static_cast<uint32_t>(piece);
    const int weight = static_cast<int>((place - piece) * 32767 + 0.5f);
    return {rig.rows + row * rig.row_bytes, rig.rows + (row + (later != earlier)) * rig.row_bytes, place - piece,
            weight << 16 | (32767 - weight)};
}

INLINE Played played(const KernelRig& rig, const KernelUpdate& update, uint32_t instance) {
    const io::InstanceCursor& cursor = update.cursors[instance];
    Played p;
    p.instance = instance;
    p.weight = cursor.weight;
    const io::ClipCursor& a = cursor.weight > 0 ? cursor.first : cursor.second;
    p.first = row_pair(rig, a.first_track, a.earlier, a.later, a.fraction);
    if (!(cursor.weight > 0)) p.weight = 1;
    const io::ClipCursor& b = cursor.second;
    if (p.weight < 1) p.second = row_pair(rig, b.first_track, b.earlier, b.later, b.fraction);
    return p;
}

// Prefetches the cache lines of the block that is decoded next.
INLINE void prefetch(const RowPair& rows, size_t offset) {
    for (size_t line = 0; line < 128; line += 64) {
        __builtin_prefetch(rows.earlier + offset + line);
        __builtin_prefetch(rows.later + offset + line);
    }
}

INLINE Quad quad_between(const RowPair& rows, const RowBlock& block, const float* range, uint32_t lane) {
    if (block.is_float) {
        const float* earlier = reinterpret_cast<const float*>(rows.earlier + block.offset) + lane;
        const float* later = reinterpret_cast<const float*>(rows.later + block.offset) + lane;
        const V f = Lanes::set(rows.fraction);
        return {mix(Lanes::load(earlier), Lanes::load(later), f),
                mix(Lanes::load(earlier + 16), Lanes::load(later + 16), f),
                mix(Lanes::load(earlier + 32), Lanes::load(later + 32), f),
                mix(Lanes::load(earlier + 48), Lanes::load(later + 48), f)};
    }
    const std::byte *earlier = rows.earlier + block.offset + 4 * lane, *later = rows.later + block.offset + 4 * lane;
    const I xy0 = Lanes::load_words(earlier), zw0 = Lanes::load_words(earlier + 64);
    const I xy1 = Lanes::load_words(later), zw1 = Lanes::load_words(later + 64);
    const I weights = Lanes::splat(rows.weights);
    const float *middle = range + lane, *step = range + 64 + lane;
    return {Lanes::load(middle) + Lanes::load(step) * Lanes::lerp_low(xy0, xy1, weights),
            Lanes::load(middle + 16) + Lanes::load(step + 16) * Lanes::lerp_high(xy0, xy1, weights),
            Lanes::load(middle + 32) + Lanes::load(step + 32) * Lanes::lerp_low(zw0, zw1, weights),
            Lanes::load(middle + 48) + Lanes::load(step + 48) * Lanes::lerp_high(zw0, zw1, weights)};
}

INLINE void store_quad(DecodedBlock& out, uint32_t character, uint32_t lane, const Quad& q) {
    Lanes::store(&out.of[0][character][lane], q.x);
    Lanes::store(&out.of[1][character][lane], q.y);
    Lanes::store(&out.of[2][character][lane], q.z);
    Lanes::store(&out.of[3][character][lane], q.w);
}

INLINE void transpose(const DecodedBlock& in, TransposedBlock& out) {
    for (uint32_t component = 0; component < 4; ++component)
        for (uint32_t joint = 0; joint < kBlockJoints; joint += 4) {
            V r[4];
            for (uint32_t k = 0; k < 4; ++k) r[k] = Lanes::fours(&in.of[component][k][joint], 4 * kBlockJoints);
            Lanes::transpose(r[0], r[1], r[2], r[3]);
            for (uint32_t k = 0; k < 4; ++k) Lanes::store(out.of[component][joint + k], r[k]);
        }
}

// The blend of two rotations, as blend_rotation() of blend/blend.glsl, but not normalized: the matrix divides by its
// length.
INLINE Quad blend_of_any_length(const Quad& a, const Quad& b, V weight) {
    const V of_a = weight * Lanes::inverse_sqrt(dot(a, a));
    const V of_b = Lanes::flip_where_negative((Lanes::set(1) - weight) * Lanes::inverse_sqrt(dot(b, b)), dot(a, b));
    return a * of_a + b * of_b;
}

enum class Decoded { kRotations, kMotions, kScales };

// Decodes a block for all characters of the group.
template <Decoded kWhat>
INLINE void decode_two_clips(const KernelRig& rig, const Played* all, uint32_t count, uint32_t block_index,
                             DecodedBlock& out) {
    const RowBlock& block = rig.blocks[block_index];
    const float* range = rig.ranges + size_t{block_index} * 8 * kBlockJoints;
    for (uint32_t character = 0; character < count; ++character) {
        const Played& p = all[character];
        if (rig.prefetches) {
            const size_t next = block.offset + (block.is_float ? 256 : 128);
            prefetch(p.first, next);
            if (p.weight < 1) prefetch(p.second, next);
        }
        if (p.weight >= 1) {
            for (uint32_t lane = 0; lane < kBlockJoints; lane += Lanes::kCount)
                store_quad(out, character, lane, quad_between(p.first, block, range, lane));
        } else {
            const V weight = Lanes::set(p.weight);
            for (uint32_t lane = 0; lane < kBlockJoints; lane += Lanes::kCount) {
                const Quad a = quad_between(p.first, block, range, lane),
                           b = quad_between(p.second, block, range, lane);
                store_quad(out, character, lane,
                           kWhat == Decoded::kRotations ? blend_of_any_length(a, b, weight) : mix(b, a, weight));
            }
        }
    }
}

}  // namespace
