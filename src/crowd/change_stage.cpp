#include "crowd/change_stage.h"

#include "command/command_io.h"
#include "command/scatter.kernel.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <ranges>
#include <stdexcept>
#include <string>

namespace throng {
namespace {

constexpr size_t kFew = 16;                 // at most this many ranges are recorded one by one
constexpr size_t kLong_bytes = 4096;        // from this size on, a range is always its own command
constexpr size_t kRoundWords = 1 << 16;     // 256 KiB
constexpr size_t kMaxWordsAnInstance = 80;  // about as many as can change in one update; more take another round

}  // namespace

ChangeStage::ChangeStage(const StageContext& context) : Stage(context) {
    if (gpu_->is_native()) return;
    scatter_ = kernels::scatter.on(gpu_);
    if (context.instance_count <= kFew) return;
    const size_t words = std::min(kRoundWords, context.instance_count * kMaxWordsAnInstance);
    uploaded_ = Buffer(gpu_, "changes", words * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    pending_.resize(batches_.size());
    for (size_t i = 0; i < batches_.size(); ++i)
        for (const uint32_t buffer : kScatteredBuffers)
            if (const Buffer& changed = batches_[i][buffer]) {
                const BufferTable table{{io::kChangesBuffer, uploaded_}, {io::kChangedBuffer, changed}};
                pending_[i].push_back({.buffer = buffer, .bindings = scatter_.bind(table)});
            }
}

void ChangeStage::begin(const Update&) {
    for (std::vector<Pending>& of_batch : pending_)
        for (Pending& pending : of_batch) pending.words.clear();
}

void ChangeStage::write(const Update& update, size_t range_count, const Batch& batch, uint32_t buffer,
                        uint32_t item_words, uint32_t first, std::span<const std::byte> items) {
    if (std::ranges::count(kScatteredBuffers, buffer) == 0)
        throw std::logic_error(std::string(name_of_buffer(buffer)) + " is not \"scattered\" in docs/buffers.md");
    const size_t item_bytes = item_words * sizeof(uint32_t);
    if (!update.commands || !uploaded_ || range_count <= kFew || items.size() >= kLong_bytes)
        return record_update(*gpu_, update.commands, batch[buffer], first * item_bytes, items);
    std::vector<Pending>& of_batch = pending_[static_cast<size_t>(&batch - batches_.data())];
    Pending& pending = *std::ranges::find(of_batch, buffer, &Pending::buffer);
    pending.item_words = item_words;
    const size_t known = pending.words.size(), count = items.size() / item_bytes;
    pending.words.resize(known + count * (1 + item_words));
    uint32_t* to = pending.words.data() + known;
    for (size_t i = 0; i < count; ++i, to += 1 + item_words) {
        *to = first + static_cast<uint32_t>(i);
        std::memcpy(to + 1, &items[i * item_bytes], item_bytes);
    }
}

void ChangeStage::record(const Update& update) {
    struct Part {
        const Pending& of;
        size_t first_word, count;
    };
    std::vector<Part> round;
    size_t used_words = 0;
    const auto scatter_round = [&] {
        memory_barrier(*gpu_, update.commands, kTransferWrite, kShaderRead | kShaderWrite);
        for (const auto& [of, first_word, count] : round)
            scatter_.dispatch_invocations(
                update.commands, of.bindings,
                io::ScatterPush{static_cast<uint32_t>(first_word), static_cast<uint32_t>(count), of.item_words},
                static_cast<uint32_t>(count * of.item_words));
        memory_barrier(*gpu_, update.commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite | kTransferWrite);
        round.clear();
        used_words = 0;
    };
    const size_t room = uploaded_.size_bytes() / sizeof(uint32_t);
    // The first round needs no barrier before it: the one at the beginning of the update already waits for the reads of
    // the last update.
    for (const Pending& of : std::views::join(pending_)) {
        const size_t stride = 1 + of.item_words;
        for (size_t at = 0; at < of.words.size();) {
            const size_t count = std::min(room - used_words, of.words.size() - at) / stride;
            if (count == 0) {
                scatter_round();
                continue;
            }
            record_update(*gpu_, update.commands, uploaded_, used_words,
                          std::span<const uint32_t>(of.words).subspan(at, count * stride));
            round.push_back({of, used_words, count});
            used_words += count * stride;
            at += count * stride;
        }
    }
    if (!round.empty()) scatter_round();
}

}  // namespace throng
