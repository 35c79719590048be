// Uploads what the application has changed to the GPU.
#pragma once

#include "crowd/stage.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A few changes are recorded as one command each. Many scattered ones are uploaded in one piece, and a kernel puts each
// in its place, since a GPU takes some 0.3 us for each transfer command.
class ChangeStage : public Stage {
public:
    explicit ChangeStage(const StageContext& context);

    // For the begin() of other stages: writes adjacent items into a buffer of a batch, from the `first` on.
    // `range_count`: how many such ranges of this kind of data have changed. Without a command buffer it writes at
    // once.
    template <class T>
    void write(const Update& update, size_t range_count, const Batch& batch, uint32_t buffer, uint32_t first,
               std::span<const T> items) {
        static_assert(sizeof(T) % sizeof(uint32_t) == 0);
        write(update, range_count, batch, buffer, sizeof(T) / sizeof(uint32_t), first, std::as_bytes(items));
    }

    void begin(const Update& update) override;
    void record(const Update& update) override;
    uint32_t end_count() const override { return 0; }
    uint64_t size_bytes() const override { return uploaded_ ? uploaded_.size_bytes() : 0; }

private:
    // What the scatter kernel has to put into a buffer of a batch.
    struct Pending {
        uint32_t buffer = 0;
        Bindings bindings;
        uint32_t item_words = 0;
        std::vector<uint32_t> words;  // for each item its number, then its words
    };

    void write(const Update& update, size_t range_count, const Batch& batch, uint32_t buffer, uint32_t item_words,
               uint32_t first, std::span<const std::byte> items);

    Kernel scatter_;
    Buffer uploaded_;                            // one round of pending changes
    std::vector<std::vector<Pending>> pending_;  // [batch], one for each of its buffers that can change
};

}  // namespace throng
