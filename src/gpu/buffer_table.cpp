#include "gpu/buffer_table.h"

#include <algorithm>

namespace throng {
namespace {

constexpr std::array<std::string_view, io::kBufferCount> kNames{{
#include "gpu/buffer_names.inc"
}};

}  // namespace

std::string_view name_of_buffer(uint32_t number) { return number < kNames.size() ? kNames[number] : "unknown"; }

uint64_t Buffers::size_bytes() const {
    uint64_t sum = 0;
    for (const Buffer& buffer : buffers_) sum += buffer.size_bytes();
    return sum;
}

BufferTable& BufferTable::set(std::initializer_list<Entry> entries) {
    for (const Entry& entry : entries) ranges_.at(entry.number) = entry.range;
    return *this;
}

BufferTable& BufferTable::add(const Buffers& buffers) {
    for (uint32_t number = 0; number < io::kBufferCount; ++number)
        if (buffers.has(number)) ranges_[number] = buffers[number];
    return *this;
}

BufferTable& BufferTable::set_absent(const BufferRange& storage, const BufferRange& table) {
    absent_storage_ = storage;
    absent_table_ = table;
    return *this;
}

}  // namespace throng
