#include "crowd/change_stage.h"

#include "command/command_io.h"
#include "command/scatter.kernel.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace throng {
namespace {

constexpr size_t kFew = 16;                  // changes, which are commands of their own
constexpr size_t kRoundWords = 1 << 16;      // 256 KiB
constexpr size_t kMostWordsAnInstance = 80;  // of what there is to change, with the numbers

constexpr std::array kChangedBuffers{io::kBirthsBuffer,        io::kPlacementsBuffer, io::kRootsBuffer,
                                     io::kInstanceLooksBuffer, io::kPlaybacksBuffer,  io::kDestinationsBuffer,
                                     io::kAttachmentsBuffer,   io::kTargetsBuffer};

}  // namespace

ChangeStage::ChangeStage(const StageContext& context) : Stage(context) {
    if (gpu_->is_native()) return;
    scatter_ = kernels::scatter.on(gpu_);
    if (context.instance_count <= kFew) return;
    const size_t words = std::min(kRoundWords, context.instance_count * kMostWordsAnInstance);
    uploaded_ = Buffer(gpu_, "changes", words * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    for (uint32_t i = 0; i < batches_.size(); ++i)
        for (const uint32_t buffer : kChangedBuffers)
            if (const Buffer& changed = batches_[i][buffer])
                bindings_[{i, buffer}] = scatter_.bind(
                    BufferTable{{io::kChangesBuffer, uploaded_}, {io::kChangedBuffer, changed}});
}

void ChangeStage::begin(const Update&) {
    rounds_.clear();
    pending_.clear();
}

void ChangeStage::write(const Update& update, size_t change_count, const Batch& batch, uint32_t buffer,
                        uint32_t item_words, uint32_t first, std::span<const std::byte> items) {
    const size_t item_bytes = item_words * sizeof(uint32_t);
    if (!update.commands || change_count <= kFew || !uploaded_)
        return record_update(*gpu_, update.commands, batch[buffer], first * item_bytes, items);
    const Bindings& bindings = bindings_.at({static_cast<uint32_t>(&batch - batches_.data()), buffer});
    for (size_t at = 0; at < items.size(); at += item_bytes) add(bindings, item_words, first++, &items[at]);
}

void ChangeStage::add(const Bindings& bindings, uint32_t item_words, uint32_t number, const std::byte* item) {
    const size_t room = uploaded_.size_bytes() / sizeof(uint32_t);
    if (rounds_.empty() || rounds_.back().size() + 1 + item_words > room) rounds_.emplace_back();
    std::vector<uint32_t>& words = rounds_.back();
    const size_t round = rounds_.size() - 1;
    if (pending_.empty() || pending_.back().bindings != &bindings || pending_.back().round != round)
        pending_.push_back({&bindings, round, static_cast<uint32_t>(words.size()), 0, item_words});
    ++pending_.back().count;
    words.push_back(number);
    words.resize(words.size() + item_words);
    std::memcpy(&words[words.size() - item_words], item, item_words * sizeof(uint32_t));
}

void ChangeStage::record(const Update& update) {
    auto some = pending_.begin();
    for (size_t round = 0; round < rounds_.size(); ++round) {
        memory_barrier(*gpu_, update.commands, kShaderRead | kShaderWrite, kTransferWrite);
        record_update(*gpu_, update.commands, uploaded_, 0, std::span<const uint32_t>(rounds_[round]));
        memory_barrier(*gpu_, update.commands, kTransferWrite, kShaderRead | kShaderWrite);
        for (; some != pending_.end() && some->round == round; ++some)
            scatter_.dispatch_invocations(update.commands, *some->bindings,
                                          io::ScatterPush{some->first_word, some->count, some->item_words},
                                          some->count * some->item_words);
    }
    if (!rounds_.empty()) separate_kernels(update.commands);
}

}  // namespace throng
