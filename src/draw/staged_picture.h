// A picture that the processor draws, as an image of the device.
#pragma once

#include "draw/image.h"
#include "gpu/buffer.h"
#include "gpu/event.h"

#include <deque>
#include <memory>

namespace throng {

class StagedPicture {
public:
    StagedPicture(std::shared_ptr<Gpu> gpu, VkExtent2D extent, bool blue_first);

    VkImage image() const { return image_.handle(); }
    // Where the next picture is written, [height][width][4], in the image's order of channels: memory that no frame in
    // flight still copies from.
    uint8_t* next();
    // Copies it into the image, which is then in TRANSFER_SRC_OPTIMAL, visible to transfers.
    void record(VkCommandBuffer commands);
    // The same of a picture that the device has drawn, which is in TRANSFER_SRC_OPTIMAL.
    void record_copy(VkCommandBuffer commands, VkImage picture) const;

private:
    struct Slot {
        Buffer pixels;
        DeviceEvent done;     // set when the copy has finished
        uint64_t number = 0;  // of the record() that copies it; 0: none does
    };

    std::shared_ptr<Gpu> gpu_;
    VkExtent2D extent_;
    Image image_;
    std::deque<Slot> slots_;  // as many as there have been frames in flight at once
    Slot* current_ = nullptr;
    uint64_t record_count_ = 0;
};

}  // namespace throng
