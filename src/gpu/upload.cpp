#include "gpu/upload.h"

#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr VkDeviceSize kStagingBuffer_bytes = VkDeviceSize{1} << 20;

VkDeviceSize aligned(VkDeviceSize size_bytes) {
    constexpr VkDeviceSize kAlignment_bytes = 16;
    return (size_bytes + kAlignment_bytes - 1) / kAlignment_bytes * kAlignment_bytes;
}

}  // namespace

void Uploads::add(const Buffer& target, std::span<const std::byte> data) {
    if (gpu_->is_native()) {  // whose buffers are zero until something is written
        if (!data.empty()) std::memcpy(target.mapped(), data.data(), data.size());
        return;
    }
    Pending pending;
    std::byte* staged = stage(target.size_bytes(), pending.staged);
    if (!data.empty()) std::memcpy(staged, data.data(), data.size());
    std::memset(staged + data.size(), 0, target.size_bytes() - data.size());
    pending.record = [gpu = gpu_.get(), whole = BufferRange(target), alive = target.keep_alive()](
                         VkCommandBuffer commands, const BufferRange& range) {
        record_copy(*gpu, commands, range, whole);
    };
    pending_.push_back(std::move(pending));
}

void Uploads::add(std::span<const std::byte> data, std::function<void(VkCommandBuffer, const BufferRange&)> record) {
    Pending pending{{}, std::move(record)};
    std::memcpy(stage(data.size(), pending.staged), data.data(), data.size());
    pending_.push_back(std::move(pending));
}

void Uploads::make_room(VkDeviceSize size_bytes) {
    if (staged_bytes_ + aligned(size_bytes) > kMostStaged_bytes) finish();
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

void Uploads::finish() {
    if (pending_.empty()) return;
    gpu_->submit_and_wait([&](VkCommandBuffer commands) {
        for (const Pending& pending : pending_) pending.record(commands, pending.staged);
    });
    pending_.clear();
    staging_.clear();
    used_bytes_ = staged_bytes_ = 0;
}

Buffer upload_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data,
                    VkBufferUsageFlags usage) {
    constexpr VkDeviceSize kSmallest_bytes = 16;
    Buffer buffer(uploads.gpu(), what, std::max<VkDeviceSize>(data.size(), kSmallest_bytes), usage);
    uploads.add(buffer, data);
    return buffer;
}

Buffer upload_table_bytes(Uploads& uploads, std::string_view what, std::span<const std::byte> data,
                          uint32_t texel_bytes, VkBufferUsageFlags more_usage) {
    const VkBufferUsageFlags usage = table_usage(*uploads.gpu(), what, data.size(), texel_bytes) | more_usage;
    Buffer table = upload_bytes(uploads, what, data, usage);
    if (usage & VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT) table.allow_texels(texel_bytes);
    return table;
}

}  // namespace throng
