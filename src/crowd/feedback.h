// What updates report to the CPU: copied into one of a few host-visible slots in turn, and read when the device says
// that it is there. Nothing waits.
#pragma once

#include "bind/pose_of_skin.h"
#include "control/layer_commands.h"
#include "gpu/buffer.h"
#include "gpu/event.h"

#include <throng/crowd.h>

#include <algorithm>
#include <array>
#include <span>

namespace throng {

struct Watched {
    uint32_t instance = 0;  // of the crowd
    uint32_t place = 0;     // in the order that the application asked for
};

// Where the device has what feedback copies to the CPU of the watched instances of a batch.
struct WatchedBatch {
    struct Part {
        BufferRange instances;        // of all instances of the batch
        uint64_t instance_bytes = 0;  // 0: there is none
    };
    Part placements;                         // Affine
    Part roots;                              // io::RootState; none where there is no root motion
    Part sockets;                            // Affine[sockets]
    Part parameters;                         // float[parameters]; none where there is no controller
    Part layers;                             // io::LayerState[layers]; none where there is no controller
    std::span<const LayerKind> layer_kinds;  // of the group, which outlives it (Retired)
    uint32_t clip_count = 0;                 // of the character
};

// Watched instances with consecutive numbers. Feedback copies each of their parts at once.
struct WatchedRun {
    uint32_t batch = 0;  // of WatchedRuns::batches
    uint32_t first = 0;  // of the batch's instances
    uint32_t count = 0;
};

// All watched instances, in the order of their numbers.
struct WatchedRuns {
    std::vector<WatchedBatch> batches;
    std::vector<WatchedRun> runs;
};

// An instance whose pose is read back, once.
struct RequestedPose {
    uint32_t instance = 0;  // of the crowd
    BufferRange skin;       // [palette_count]
    SkinFormat skin_format = SkinFormat::kAffine;
    const PoseOfSkin* pose_of_skin = nullptr;  // of the group, which outlives it (Retired)
};

class FeedbackRing {
public:
    // `instance_bytes`: the most that end() copies of watched instances and of poses.
    FeedbackRing(std::shared_ptr<Gpu> gpu, uint32_t event_capacity, uint64_t instance_bytes);
    // What its buffers take, once all slots are in use.
    static uint64_t bytes_needed(uint32_t event_capacity, uint64_t instance_bytes);
    FeedbackRing(const FeedbackRing&) = delete;
    FeedbackRing& operator=(const FeedbackRing&) = delete;

    const Buffer& events() const { return events_; }  // io::EventHead, then io::EventRecord[event_capacity]
    uint32_t event_capacity() const { return event_capacity_; }

    // From the next update on there is room for this much; see the constructor.
    void make_room(uint64_t instance_bytes) { instance_bytes_ = std::max(instance_bytes_, instance_bytes); }

    uint64_t update_count() const { return update_count_; }
    // Continues after this many updates, as if all of them had been reported. No update may be under way.
    void restart(uint64_t update_count);

    // Whether begin() would throw.
    bool is_full() const;
    // What has not finished was dropped. Nothing may be under way.
    void drop_pending();

    // Called before the first kernel of an update that writes events; end() is called after the last. Throws
    // kInvalidArgument if the update that used the next slot is still under way.
    void begin(VkCommandBuffer commands);
    // Takes the last update back: its commands will never be submitted.
    void discard();
    // `watched` are ordered by their numbers.
    void end(VkCommandBuffer commands, std::span<const Watched> watched, const WatchedRuns& runs,
             std::vector<RequestedPose> poses);
    // Feedback of the updates that have finished and have not been read, oldest first.
    std::vector<Feedback> take();
    uint64_t size_bytes() const;

private:
    static constexpr size_t kSlots = 4;
    struct Update {
        uint64_t number = 0;   // 0: none
        bool is_read = false;  // by take()
        std::vector<Watched> watched;
        WatchedRuns runs;
        std::vector<RequestedPose> poses;
    };
    struct Slot {
        Buffer copy;
        DeviceEvent done;
        Update update, before;  // what the slot had before the update, which may be discarded
    };
    Buffer make_copy() const;
    BufferRange happened() const;
    Slot& last_slot() { return slots_[(update_count_ - 1) % slots_.size()]; }
    Feedback read(const Slot& slot) const;
    // Both read from `at` and advance it.
    static void read_watched(const Slot& slot, const std::byte*& at, Feedback& feedback);
    static void read_poses(const Slot& slot, const std::byte*& at, Feedback& feedback);

    std::shared_ptr<Gpu> gpu_;
    uint32_t event_capacity_;
    uint64_t instance_bytes_;
    Buffer events_;
    std::array<Slot, kSlots> slots_;
    std::vector<CopyFrom> copies_;  // of one end(); kept to reuse the memory
    uint64_t update_count_ = 0;
};

}  // namespace throng
