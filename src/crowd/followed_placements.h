// Where updates have moved instances, for a CPU that wants to know: their placements come back behind each update, in
// one of a few host-visible slots in turn, and are read when the device says that they are there. Nothing waits. Where
// shaders populate a group, so does who is there.
#pragma once

#include "crowd/batch.h"
#include "gpu/event.h"

#include <array>

namespace throng {

struct FollowedBatch {
    size_t batch = 0;  // its place among the crowd's: where a change of groups fails, they have moved and come back
    bool has_births = false;  // they come back too
};

class FollowedPlacements {
public:
    // `batches` must outlive it.
    FollowedPlacements(std::shared_ptr<Gpu> gpu, const std::vector<Batch>& batches,
                       std::vector<FollowedBatch> followed);

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
