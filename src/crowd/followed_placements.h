// Tells the CPU where updates have moved instances: placements are copied after each update into one of a few
// host-visible slots in turn, and read when the device says that they are there. Nothing waits. For groups that shaders
// populate, births are copied too.
#pragma once

#include "crowd/batch.h"
#include "gpu/event.h"

#include <array>

namespace throng {

struct FollowedBatch {
    size_t batch = 0;         // an index, since batches move away and back if a change of groups fails
    bool has_births = false;  // births are copied too
};

class FollowedPlacements {
public:
    // `batches` must outlive it.
    FollowedPlacements(std::shared_ptr<Gpu> gpu, const std::vector<Batch>& batches,
                       std::vector<FollowedBatch> followed);

    // Called before and after the kernels of the update with this number. If the next slot is still in use, nothing is
    // copied.
    void begin(uint64_t number);
    void end(VkCommandBuffer commands);
    void discard();  // the last update's commands will never be submitted

    // The newest update whose placements have arrived and that this has not returned before; 0: none.
    uint64_t take_newest();
    // Calls read(batch, placements, births) with those of the update that take_newest() returned last. Births are empty
    // if those of the batch are not copied.
    template <class Read>
    void for_each(const Read& read) const {
        VkDeviceSize at = 0;
        for (const FollowedBatch& of : followed_) {
            const std::byte* const placements = newest_->copy.mapped() + at;
            const std::byte* const births = placements + placement_bytes(of);
            read(batches_[of.batch],
                 std::span(reinterpret_cast<const Affine*>(placements), placement_bytes(of) / sizeof(Affine)),
                 std::span(reinterpret_cast<const uint32_t*>(births), birth_bytes(of) / sizeof(uint32_t)));
            at += placement_bytes(of) + birth_bytes(of);
        }
    }
    uint64_t placement_bytes(const FollowedBatch& of) const {
        return batches_[of.batch].instance_count * sizeof(Affine);
    }
    uint64_t birth_bytes(const FollowedBatch& of) const {
        return of.has_births ? batches_[of.batch].instance_count * sizeof(uint32_t) : 0;
    }
    uint64_t size_bytes() const;

private:
    struct Slot {
        Buffer copy;
        DeviceEvent done;
        uint64_t number = 0;  // of the update; 0: none
    };
    bool is_there(const Slot& slot) const { return slot.number > 0 && slot.done.is_set(); }

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Batch>& batches_;
    std::vector<FollowedBatch> followed_;
    std::array<Slot, 4> slots_;
    Slot* next_ = nullptr;  // of the update that is under way; null where it has none
    const Slot* newest_ = nullptr;
    uint64_t taken_ = 0;
};

}  // namespace throng
