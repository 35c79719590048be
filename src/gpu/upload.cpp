#include "gpu/upload.h"

#include "base/count.h"
#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr VkDeviceSize kStagingBuffer_bytes = VkDeviceSize{1} << 20;

VkDeviceSize aligned(VkDeviceSize size_bytes) {
    constexpr VkDeviceSize kAlignment_bytes = 16;
    return rounded_up(size_bytes, kAlignment_bytes);
}

// Zeros need no staging memory: data of a single copy is cut after its last nonzero word; data that is all zero, of one
// copy or many, becomes empty.
std::span<const std::byte> without_zeros(std::span<const std::byte> data, uint64_t count) {
    constexpr size_t kWord_bytes = 4;
    size_t end = data.size();
    while (end > 0 && std::ranges::all_of(data.subspan(end - kWord_bytes, kWord_bytes),
                                          [](std::byte byte) { return byte == std::byte{0}; }))
        end -= kWord_bytes;
    return end == 0 || count == 1 ? data.first(end) : data;
}

}  // namespace

void Uploads::add(const Buffer& target, std::span<const std::byte> data, uint64_t count) {
    data = without_zeros(data, count);
    if (data.empty()) count = 0;
    if (gpu_->is_native()) {  // whose buffers are zero until something is written
        for (uint64_t i = 0; i < count; ++i) std::memcpy(target.mapped() + i * data.size(), data.data(), data.size());
        return;
    }
    const VkDeviceSize used_bytes = count * data.size();
    Pending pending;
    if (used_bytes > 0) {
        const uint64_t staged_count = std::min<uint64_t>(count,
                                                         std::max<uint64_t>(kStagingBuffer_bytes / data.size(), 1));
        std::byte* staged = stage(staged_count * data.size(), pending.staged);
        for (uint64_t i = 0; i < staged_count; ++i) std::memcpy(staged + i * data.size(), data.data(), data.size());
    }
    const BufferRange used(target, 0, used_bytes), rest(target, used_bytes, target.size_bytes() - used_bytes);
    pending.record = [gpu = gpu_.get(), used, rest, alive = target.keep_alive()](VkCommandBuffer commands,
                                                                                 const BufferRange& range) {
        if (used.size_bytes > 0) record_repeated(*gpu, commands, range, used);
        if (rest.size_bytes > 0) record_fill(*gpu, commands, rest, 0);
    };
    pending_.push_back(std::move(pending));
}

void Uploads::add(std::span<const std::byte> data, std::function<void(VkCommandBuffer, const BufferRange&)> record) {
    Pending pending{{}, std::move(record)};
    std::memcpy(stage(data.size(), pending.staged), data.data(), data.size());
    pending_.push_back(std::move(pending));
}

void Uploads::make_room(VkDeviceSize size_bytes) {
    if (staged_bytes_ + aligned(size_bytes) > max_staged_bytes_) finish();
}

std::byte* Uploads::stage(VkDeviceSize size_bytes, BufferRange& staged) {
    const VkDeviceSize taken_bytes = aligned(size_bytes);
    make_room(taken_bytes);
    if (staging_.empty() || used_bytes_ + taken_bytes > staging_.back().size_bytes()) {
        staging_.emplace_back(gpu_, "staging", std::max(taken_bytes, kStagingBuffer_bytes), 0, MemoryKind::kUpload);
        used_bytes_ = 0;
    }
    const Buffer& buffer = staging_.back();
    staged = BufferRange(buffer, used_bytes_, size_bytes);
    used_bytes_ += taken_bytes;
    staged_bytes_ += taken_bytes;
    return buffer.mapped() + staged.offset_bytes;
}

Buffer Uploads::share(const SharedBuffers::Key& key, const std::function<Buffer()>& make) {
    if (const auto pending = shared_.find(key); pending != shared_.end()) return pending->second.share();
    if (Buffer found = gpu_->buffers->find(key)) return found;
    Buffer made = make();
    shared_.emplace(key, made.share());
    return made;
}

void Uploads::finish() {
    if (!pending_.empty()) gpu_->submit_and_wait([&](VkCommandBuffer commands) { record(commands); });
    complete();
}

void Uploads::record(VkCommandBuffer commands) const {
    for (const Pending& pending : pending_) pending.record(commands, pending.staged);
    memory_barrier(*gpu_, commands, kTransferWrite, kAnyAccess);
}

void Uploads::complete() {
    for (const auto& [key, buffer] : shared_) gpu_->buffers->add(key, buffer);
    shared_.clear();
    pending_.clear();
    staging_.clear();
    used_bytes_ = staged_bytes_ = 0;
}

Buffer upload_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data, VkBufferUsageFlags usage,
                    uint32_t texel_bytes) {
    const auto make = [&] {
        Buffer buffer(uploads.gpu(), what, std::max<VkDeviceSize>(data.size(), kSmallestBuffer_bytes), usage);
        if (usage & VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT) buffer.allow_texels(texel_bytes);
        uploads.add(buffer, data);
        return buffer;
    };
    return uploads.shares ? uploads.share(SharedBuffers::key_of(data, usage, texel_bytes), make) : make();
}

}  // namespace throng
