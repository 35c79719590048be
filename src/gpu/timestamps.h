// Timestamps of the last few frames. The GPU copies them to memory that the CPU sees, then writes a number there that
// tells the CPU that the stamps are complete and to which frame they belong. So reading never waits, while on lavapipe
// vkGetQueryPoolResults() waits until the queue is idle. An event would not do: setting it again would need a barrier
// after all commands.
#pragma once

#include "gpu/buffer.h"
#include "gpu/owned.h"

#include <array>
#include <optional>
#include <vector>

namespace throng {

// On a device without timestamps nothing is recorded, and no frame is ever finished.
class Timestamps {
public:
    // How many frames' times are kept; a frame's are lost when the fourth one after it begins
    static constexpr uint32_t kFrames = 4;

    Timestamps(std::shared_ptr<Gpu> gpu, uint32_t stamps_per_frame);

    // begin() once a frame, write() at each point of interest, publish() after the last one; all outside of render
    // passes. A frame may go on after publish() and publish again. A frame whose commands are never submitted is never
    // read, and does not disturb the others.
    void begin(VkCommandBuffer commands);
    void write(VkCommandBuffer commands);
    void publish(VkCommandBuffer commands);
    uint64_t frame_number() const { return frame_count_; }  // of the last begin(); the first is 1

    struct Frame {
        uint64_t number = 0;
        std::vector<double> ms;  // of each stamp, after the first one
    };
    // The newest that the GPU has finished, of the last kFrames.
    std::optional<Frame> newest() const;

private:
    struct Slot {
        OwnedQueryPool queries;
        Buffer copy;                // uint64_t[1 + stamps_per_frame]: which publication this is, then the stamps
        uint64_t frame_number = 0;  // 0: none
        uint64_t publication = 0;   // of the frame's last publish(); 0: none yet
        uint32_t stamp_count = 0, published_count = 0;
    };
    bool is_finished(const Slot& slot) const;
    Frame read(const Slot& slot) const;

    std::shared_ptr<Gpu> gpu_;
    uint32_t stamps_per_frame_;
    std::array<Slot, kFrames> slots_;
    uint64_t frame_count_ = 0, publication_count_ = 0;
};

}  // namespace throng
