// What updates report to the CPU: copied into one of a few host-visible slots in turn, and read when the device says
// that it is there. Nothing waits.
#pragma once

#include "control/layer_commands.h"
#include "gpu/buffer.h"
#include "gpu/event.h"

#include <throng/crowd.h>

#include <array>
#include <span>

namespace throng {

// What is read of an instance, where it lies on the device.
struct Watched {
    uint32_t instance = 0;                   // of the crowd
    BufferRange placement;                   // Affine
    BufferRange move;                        // float4: x, z, cosine, sine; none where there is no root motion
    BufferRange sockets;                     // Affine[]; likewise
    BufferRange parameters;                  // float[]; none where there is no controller
    BufferRange layers;                      // io::LayerState[layer_kinds]; likewise
    std::span<const LayerKind> layer_kinds;  // of the group
    uint32_t clip_count = 0;                 // of the character

    std::array<BufferRange, 5> parts() const { return {placement, move, sockets, parameters, layers}; }
};

class FeedbackRing {
public:
    // watch_bytes: of all that end() copies of watched instances at most.
    FeedbackRing(std::shared_ptr<Gpu> gpu, uint32_t event_capacity, uint64_t watch_bytes);
    FeedbackRing(const FeedbackRing&) = delete;
    FeedbackRing& operator=(const FeedbackRing&) = delete;

    const Buffer& events() const { return events_; }  // io::EventHead, then io::EventRecord[event_capacity]
    uint32_t event_capacity() const { return event_capacity_; }

    // Before the first kernel of an update that writes events, and behind the last. Throws kInvalidArgument where the
    // update whose slot comes next is still under way.
    void begin(VkCommandBuffer commands);
    // Takes the last update back: its commands will never be submitted.
    void discard();
    void end(VkCommandBuffer commands, std::span<const Watched> watched);
    // Feedback of the updates that have finished and have not been read, oldest first.
    std::vector<Feedback> take();
    uint64_t size_bytes() const;

private:
    struct Update {
        uint64_t number = 0;   // 0: none
        bool is_read = false;  // by take()
        std::vector<Watched> watched;
    };
    struct Slot {
        Buffer copy;
        DeviceEvent done;
        Update update, before;  // what the slot had before the update, which may be discarded
    };
    Slot& last_slot() { return slots_[(update_count_ - 1) % slots_.size()]; }
    bool was_dropped(const Slot& slot) const;
    Feedback read(const Slot& slot) const;
    void read_watched(const Slot& slot, Feedback& feedback) const;

    std::shared_ptr<Gpu> gpu_;
    uint32_t event_capacity_;
    Buffer events_;
    std::array<Slot, 4> slots_;
    uint64_t update_count_ = 0;
};

}  // namespace throng
