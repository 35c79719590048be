// What the application has changed, on its way to the GPU.
#pragma once

#include "crowd/stage.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A few changes are commands of their own. Many at once, here and there, go up in one piece, and a kernel puts each of
// them in its place, since a GPU takes some 0.3 us for each transfer command.
class ChangeStage : public Stage {
public:
    explicit ChangeStage(const StageContext& context);

    // For the begin() of other stages: writes items that lie side by side into a buffer of a batch, from the `first`
    // on. `range_count`: how many such ranges of what the buffer holds have changed. Without a command buffer it writes
    // now.
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
    // What scatter is to put into a buffer of a batch.
    struct Pending {
        uint32_t buffer = 0;
        Bindings bindings;
        uint32_t item_words = 0;
        std::vector<uint32_t> words;  // an item's number, and its words, for each
    };

    void write(const Update& update, size_t range_count, const Batch& batch, uint32_t buffer, uint32_t item_words,
               uint32_t first, std::span<const std::byte> items);

    Kernel scatter_;
    Buffer uploaded_;                            // a round of what is pending
    std::vector<std::vector<Pending>> pending_;  // [batches], for each of its buffers that may change
};

}  // namespace throng
