// Where updates have moved instances, for a CPU that wants to know: their placements come back behind each update, in
// one of a few host-visible slots in turn, and are read when the device says that they are there. Nothing waits. Where
// shaders populate a group, so does who is there.
#pragma once

#include "crowd/batch.h"
#include "gpu/event.h"

#include <array>

namespace throng {

struct FollowedBatch {
    const Batch* batch = nullptr;  // must outlive it
    bool has_births = false;       // they come back too

    uint64_t placement_bytes() const { return batch->instance_count * sizeof(Affine); }
    uint64_t birth_bytes() const { return has_births ? batch->instance_count * sizeof(uint32_t) : 0; }
};

class FollowedPlacements {
public:
    FollowedPlacements(std::shared_ptr<Gpu> gpu, std::vector<FollowedBatch> batches);

    // Before and behind the kernels of an update, which is the number-th. Where the slot that comes next is still under
    // way, nothing is copied.
    void begin(uint64_t number);
    void end(VkCommandBuffer commands);
    void discard();  // the last update's commands will never be submitted

    // The newest update of which they are there, and which has not been asked for; 0: none.
    uint64_t take_newest();
    // read(batch, placements, births): those of the update that take_newest() has returned last; no births where the
    // batch has none that come back.
    template <class Read>
    void for_each(const Read& read) const {
        VkDeviceSize at = 0;
        for (const FollowedBatch& of : batches_) {
            const std::byte* const births = newest_->copy.mapped() + at + of.placement_bytes();
            read(*of.batch,
                 std::span(reinterpret_cast<const Affine*>(newest_->copy.mapped() + at), of.batch->instance_count),
                 std::span(reinterpret_cast<const uint32_t*>(births), of.birth_bytes() / sizeof(uint32_t)));
            at += of.placement_bytes() + of.birth_bytes();
        }
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
    std::vector<FollowedBatch> batches_;
    std::array<Slot, 4> slots_;
    Slot* next_ = nullptr;  // of the update that is under way; null where it has none
    const Slot* newest_ = nullptr;
    uint64_t taken_ = 0;
};

}  // namespace throng
