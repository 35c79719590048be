// Where updates have moved instances, for a CPU that wants to know: their placements come back behind each update, in
// one of a few host-visible slots in turn, and are read when the device says that they are there. Nothing waits.
#pragma once

#include "crowd/batch.h"
#include "gpu/event.h"

#include <array>

namespace throng {

class FollowedPlacements {
public:
    // `batches`: whose placements are copied; they must outlive it.
    FollowedPlacements(std::shared_ptr<Gpu> gpu, std::vector<const Batch*> batches);

    // Before and behind the kernels of an update, which is the number-th. Where the slot that comes next is still under
    // way, nothing is copied.
    void begin(uint64_t number);
    void end(VkCommandBuffer commands);
    void discard();  // the last update's commands will never be submitted

    // The newest update of which they are there, and which has not been asked for; 0: none.
    uint64_t take_newest();
    // read(batch, placements): those of the update that take_newest() has returned last.
    template <class Read>
    void for_each(const Read& read) const {
        VkDeviceSize at = 0;
        for (const Batch* batch : batches_) {
            read(*batch,
                 std::span(reinterpret_cast<const Affine*>(newest_->copy.mapped() + at), batch->instance_count));
            at += size_bytes_of(*batch);
        }
    }
    uint64_t size_bytes() const;

private:
    struct Slot {
        Buffer copy;
        DeviceEvent done;
        uint64_t number = 0;  // of the update; 0: none
    };
    static VkDeviceSize size_bytes_of(const Batch& batch) { return batch.instance_count * sizeof(Affine); }
    bool is_there(const Slot& slot) const { return slot.number > 0 && slot.done.is_set(); }

    std::shared_ptr<Gpu> gpu_;
    std::vector<const Batch*> batches_;
    std::array<Slot, 4> slots_;
    Slot* next_ = nullptr;  // of the update that is under way; null where it has none
    const Slot* newest_ = nullptr;
    uint64_t taken_ = 0;
};

}  // namespace throng
