// Samples, blends, scans and binds as many characters as there are lanes, in one pass over the joints of the walk, in
// blocks of 16 joints. A block is decoded with joints as lanes, which share a character's clips. Then it is transposed,
// and walked with characters as lanes, which share parents and constants. With two clips, each joint of a character
// reads four rows of 8 bytes from the caches, and writes 48 bytes by streaming stores.
//
// Include a native/lanes_*.h first.
#pragma once

#include "native/kernel_emit.h"
#include "native/kernel_inertia.h"

namespace {

struct Packet {
    Played all[Lanes::kCount];
    uint32_t count;
    ActiveClipRows* active_clips;  // [character][active_clip_limit] of layers
    uint32_t active_clip_count[Lanes::kCount];
};

template <Decoded kWhat>
INLINE void decode_layers(const KernelRig& rig, const KernelUpdate& update, const Packet& packet, uint32_t block,
                          DecodedBlock& out) {
    for (uint32_t c = 0; c < packet.count; ++c)
        mix_active_clips<kWhat>(rig, packet.active_clips + c * update.active_clip_limit, packet.active_clip_count[c],
                                block, out, c);
}

// Applies what comes on top of the animated poses: inertial offsets and pose overrides.
template <Decoded kWhat>
[[gnu::noinline]] void adjust(const KernelRig& rig, const KernelUpdate& update, const Packet& packet, uint32_t block,
                              DecodedBlock& decoded) {
    const size_t block_count = rig.place_count / kBlockJoints;
    for (uint32_t c = 0; c < packet.count; ++c) {
        const uint32_t instance = packet.all[c].instance;
        const io::InstancePose set = update.pose_overrides ? update.pose_overrides[instance] : io::InstancePose{0, 0};
        if (!update.inertias && !(set.weight > 0)) continue;
        for (uint32_t lane = 0; lane < kBlockJoints; lane += Lanes::kCount) {
            Quad q{Lanes::load(&decoded.of[0][c][lane]), Lanes::load(&decoded.of[1][c][lane]),
                   Lanes::load(&decoded.of[2][c][lane]), Lanes::load(&decoded.of[3][c][lane])};
            if (update.inertias)
                q = inertial<kWhat>(
                    update.inertias[instance], q,
                    update.inertia_states + (instance * block_count + block) * kInertiaFloats * kBlockJoints + lane);
            if (set.weight > 0)
                q = overridden<kWhat>(update.set_poses + (set.slot * block_count + block) * 4 * kBlockJoints + lane, q,
                                      set.weight);
            store_quad(decoded, c, lane, q);
        }
    }
}

template <Decoded kWhat>
[[gnu::noinline]] void decode(const KernelRig& rig, const KernelUpdate& update, const Packet& packet, uint32_t block,
                              TransposedBlock& transposed) {
    DecodedBlock decoded;
    if (packet.count < Lanes::kCount) __builtin_memset(&decoded, 0, sizeof decoded);
    if (update.active_clips)
        decode_layers<kWhat>(rig, update, packet, block, decoded);
    else
        decode_two_clips<kWhat>(rig, packet.all, packet.count, block, decoded);
    if (update.inertias || update.pose_overrides) adjust<kWhat>(rig, update, packet, block, decoded);
    transpose(decoded, transposed);
}

void begin(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count, Packet& packet,
           SkinTarget& target) {
    constexpr uint32_t kWords[] = {12, 6, 8};
    const size_t stride = size_t{rig.palette_count} * kWords[update.skin_format];
    const auto skin_of = [&](uint32_t instance) {
        return update.skin + (update.skin_rows ? update.skin_rows[instance] : instance) * stride * 4;
    };
    packet.count = target.count = count;
    target.begin = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(skin_of(instances[0])) / 4 % kLine);
    target.position = target.begin;
    target.written = 0;
    packet.active_clips = reinterpret_cast<ActiveClipRows*>(update.scratch +
                                                            (size_t{rig.slot_count} + 1) * sizeof(Matrix));
    for (uint32_t c = 0; c < count; ++c) {
        if (update.active_clips) {
            packet.all[c].instance = instances[c];
            packet.active_clip_count[c] = find_active_clips(rig, update, instances[c],
                                                            packet.active_clips + c * update.active_clip_limit);
        } else {
            packet.all[c] = played(rig, update, instances[c]);
            if (rig.prefetches) {
                prefetch(packet.all[c].first, 0);
                if (packet.all[c].weight < 1) prefetch(packet.all[c].second, 0);
            }
        }
        target.line[c] = skin_of(instances[c]) - target.begin * 4;
    }
}

void update_packet(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count) {
    Packet packet;
    Outputs out;
    begin(rig, update, instances, count, packet, out.target);
    TransposedBlock rotations, motions, scales;
    float* slots = reinterpret_cast<float*>(update.scratch);
    const auto slot_of = [&](uint32_t slot) { return slots + size_t{slot} * 12 * Lanes::kCount; };
    Matrix identity;
    for (uint32_t i = 0; i < 12; ++i) identity.of[i / 4][i % 4] = Lanes::set(i % 5 == 0 ? 1 : 0);
    store(slot_of(kRoot), identity);
    const float* last = slot_of(kRoot);
    const uint32_t first_motion = (rig.joint_count + kBlockJoints - 1) / kBlockJoints;
    const uint32_t first_scales = first_motion + (rig.motion_count + kBlockJoints - 1) / kBlockJoints;
    const Emission* emission = rig.emissions;
    for (uint32_t joint = 0; joint < rig.joint_count; ++joint) {
        const WalkStep& step = rig.steps[joint];
        const uint32_t at = joint % kBlockJoints;
        if (at == 0) decode<Decoded::kRotations>(rig, update, packet, joint / kBlockJoints, rotations);
        V centre[3], scale[3];
        for (uint32_t i = 0; i < 3; ++i) {
            centre[i] = Lanes::set(step.centre[i]);
            scale[i] = Lanes::set(step.scale[i]);
        }
        if (step.motion != kNoIndex) {
            const uint32_t lane = step.motion % kBlockJoints;
            if (lane == 0)
                decode<Decoded::kMotions>(rig, update, packet, first_motion + step.motion / kBlockJoints, motions);
            for (uint32_t i = 0; i < 3; ++i) centre[i] = Lanes::load(motions.of[i][lane]);
            if (!rig.three_scales) scale[0] = scale[1] = scale[2] = Lanes::load(motions.of[3][lane]);
        }
        if (rig.three_scales && step.scales != kNoIndex) {
            const uint32_t lane = step.scales % kBlockJoints;
            if (lane == 0)
                decode<Decoded::kScales>(rig, update, packet, first_scales + step.scales / kBlockJoints, scales);
            for (uint32_t i = 0; i < 3; ++i) scale[i] = Lanes::load(scales.of[i][lane]);
        }
        const Quad q{Lanes::load(rotations.of[0][at]), Lanes::load(rotations.of[1][at]),
                     Lanes::load(rotations.of[2][at]), Lanes::load(rotations.of[3][at])};
        // The matrix is passed from joint to joint in memory, where product() reads it: registers would be spilled
        // around the calls anyway
        const float* parent = step.parent == kLast ? last : slot_of(step.parent);
        float* own = slot_of(step.keep == kNoIndex ? rig.slot_count : step.keep);
        const Matrix s = product(load_matrix(parent), matrix_of(q, scale, centre, step.pivot, !rig.three_scales));
        store(own, s);
        last = own;
        for (const Emission* end = emission + step.emission_count; emission < end; ++emission) {
            const bool is_plain = emission->kind == EmissionKind::kSkin && emission->source == kLast &&
                                  emission->constant == kNoIndex && update.skin_format == io::kSkinAffine;
            if (is_plain)
                put_affine(out.ring, out.target, load_matrix(own));
            else
                emit(rig, update, *emission, emission->source == kLast ? last : slot_of(emission->source), packet.all,
                     out);
        }
    }
    finish(out.ring, out.target);
}

void decode_all(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count) {
    const uint32_t first_motion = (rig.joint_count + kBlockJoints - 1) / kBlockJoints;
    const uint32_t first_scales = first_motion + (rig.motion_count + kBlockJoints - 1) / kBlockJoints;
    const uint32_t end = first_scales + (rig.scales_count + kBlockJoints - 1) / kBlockJoints;
    for (uint32_t i = 0; i < count; i += Lanes::kCount) {
        Packet packet;
        SkinTarget target;
        begin(rig, update, instances + i, count - i < Lanes::kCount ? count - i : Lanes::kCount, packet, target);
        TransposedBlock transposed;
        for (uint32_t block = 0; block < end; ++block) {
            if (block < first_motion)
                decode<Decoded::kRotations>(rig, update, packet, block, transposed);
            else if (block < first_scales)
                decode<Decoded::kMotions>(rig, update, packet, block, transposed);
            else
                decode<Decoded::kScales>(rig, update, packet, block, transposed);
            asm volatile("" : : "m"(transposed));  // so that the compiler does not remove the decoding
        }
    }
}

size_t scratch_bytes(const KernelRig& rig, const KernelUpdate& update) {
    return (size_t{rig.slot_count} + 1) * sizeof(Matrix) +
           size_t{Lanes::kCount} * update.active_clip_limit * sizeof(ActiveClipRows);
}

void fill(std::byte* to, size_t size) {
    const V v = Lanes::set(1);
    for (size_t i = 0; i < size; i += sizeof v) Lanes::stream(reinterpret_cast<float*>(to + i), v);
}

void update_all(const KernelRig& rig, const KernelUpdate& update, const uint32_t* instances, uint32_t count) {
    for (uint32_t i = 0; i < count; i += Lanes::kCount)
        update_packet(rig, update, instances + i, count - i < Lanes::kCount ? count - i : Lanes::kCount);
}

}  // namespace
