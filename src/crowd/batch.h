// A run of a group's instances whose buffers fit the device's limits.
#pragma once

#include "crowd/group.h"
#include "gpu/buffer_uses.h"
#include "gpu/kernel.h"

#include <algorithm>

namespace throng {

struct Batch {
    uint32_t group = 0, of_group = 0;  // of_group: which of the group's batches it is
    uint32_t first_instance = 0, instance_count = 0;
    uint32_t used_count = 0;  // instances up to the last one that exists in the update under way
    // The entry in `births` of instances born in that update; 0: all instances always exist
    uint32_t birth = 0;
    bool blends = false;      // whether two clips have weight in any instance, in the update that is under way
    bool is_moved = false;    // whether placements have been set for the update that is under way
    uint32_t move_count = 0;  // in how many updates so far placements had been set
    Buffers buffers;          // those that the group's settings ask for
    // Outputs of updates, in frame slots that are used in turn: skin matrices and, if CrowdSettings::frames_in_flight
    // is above 1, the skinned vertices and copies of other outputs (kShownBuffers).
    std::vector<Buffer> skins;   // [slot]
    std::vector<Buffers> shown;  // [slot], or none
    uint32_t slot = 0;           // of the last update
    // What inertial transitions keep between native updates (NativeRig::inertia_floats())
    native::AlignedBytes inertia_states;
    uint64_t inertia_bytes = 0;
    bool has_updated = false, had_updated = false;  // whether an update has run; had_: before the last record()
    // Whether an update has written these buffers; had_: before the last record(). Restoring a state sets has_updated
    // as it was in the saved crowd, but brings no outputs
    bool has_outputs = false, had_outputs = false;

    Buffer& operator[](uint32_t number) { return buffers[number]; }
    const Buffer& operator[](uint32_t number) const { return buffers[number]; }
    uint64_t size_bytes() const {
        uint64_t sum = buffers.size_bytes() + inertia_bytes;
        for (const Buffer& of_slot : skins) sum += of_slot.size_bytes();
        for (const Buffers& of_slot : shown) sum += of_slot.size_bytes();
        return sum;
    }
    bool has(uint32_t instance) const { return instance - first_instance < instance_count; }
    const Buffer& skin() const { return skins[slot]; }
    uint32_t slot_before(uint32_t of) const { return (of == 0 ? static_cast<uint32_t>(skins.size()) : of) - 1; }
    // The buffer from which readers take an output of this slot.
    const Buffer& shown_in(uint32_t of_slot, uint32_t number) const {
        const bool is_copied = !shown.empty() && shown[of_slot].has(number);
        return is_copied ? shown[of_slot][number] : buffers[number];
    }

    // The buffers of the batch and its group that kernels can be bound to. `absent` stands in for storage buffers that
    // they do not have.
    BufferTable table(const Group& of, const BufferRange& absent) const {
        return BufferTable()
            .add(of.buffers)
            .add(buffers)
            .set({{io::kLayersBeforeBuffer, buffers[io::kLayersBuffer]},
                  {io::kParametersBeforeBuffer, buffers[io::kParametersBuffer]}})
            .set_absent(absent, of[io::kWordsBuffer]);
    }
    // The buffers that a picture is drawn from.
    BufferTable shown_table(const Group& of, const BufferRange& absent, uint32_t of_slot) const {
        BufferTable all = table(of, absent);
        if (!shown.empty()) all.add(shown[of_slot]);
        return all.set({{io::kSkinBuffer, skins[of_slot]}});
    }
};

// Which row of [palette_count] skin matrices an instance of the batch has, if buffers lie in host memory.
inline uint32_t skin_row_of(const Group& group, const Batch& batch, uint32_t instance) {
    if (!group.skin_pool) return instance;
    return reinterpret_cast<const uint32_t*>(batch[io::kSkinRowsBuffer].mapped())[instance];
}

// The index of the batch that this instance of the crowd belongs to.
inline uint32_t batch_index_of(const std::vector<Batch>& batches, uint32_t instance) {
    const auto after = std::upper_bound(batches.begin(), batches.end(), instance,
                                        [](uint32_t i, const Batch& batch) { return i < batch.first_instance; });
    return static_cast<uint32_t>(after - batches.begin()) - 1;
}

// The batch that contains this instance number; null if no group has it.
inline const Batch* batch_at(const std::vector<Batch>& batches, uint32_t instance) {
    if (batches.empty() || instance < batches.front().first_instance) return nullptr;
    const Batch& batch = batches[batch_index_of(batches, instance)];
    return batch.has(instance) ? &batch : nullptr;
}

// An instance of the crowd, in its batch.
struct InBatch {
    uint32_t batch = 0, instance = 0;
};
inline InBatch in_batch(const std::vector<Batch>& batches, uint32_t instance) {
    const uint32_t batch = batch_index_of(batches, instance);
    return {batch, instance - batches[batch].first_instance};
}

// Splits ranges of the crowd's instances where batches end, and calls apply(batch, first_instance, count) for each
// part. Numbers that no group has are left out.
template <class Ranges, class Apply>
void for_each_part(const std::vector<Batch>& batches, const Ranges& ranges, const Apply& apply) {
    for (const auto& [first, count] : ranges) {
        const uint32_t end = first + count;
        const auto after = std::ranges::upper_bound(batches, first, {}, &Batch::first_instance);
        for (auto batch = after == batches.begin() ? after : after - 1;
             batch != batches.end() && batch->first_instance < end; ++batch) {
            const uint32_t from = std::max(first, batch->first_instance),
                           until = std::min(end, batch->first_instance + batch->instance_count);
            if (from < until) apply(*batch, from, until - from);
        }
    }
}

}  // namespace throng
