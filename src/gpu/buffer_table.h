// Buffers by their numbers (docs/buffers.md): those that a part of a crowd owns, and those that a kernel is bound to.
#pragma once

#include "gpu/buffer.h"
#include "gpu/buffers_io.h"

#include <array>
#include <initializer_list>

namespace throng {

// As docs/buffers.md has it, for messages.
std::string_view name_of_buffer(uint32_t number);

// The buffers that a group, a batch or a crowd has.
class Buffers {
public:
    Buffer& operator[](uint32_t number) { return buffers_[number]; }
    const Buffer& operator[](uint32_t number) const { return buffers_[number]; }
    bool has(uint32_t number) const { return static_cast<bool>(buffers_[number]); }
    uint64_t size_bytes() const;

private:
    std::array<Buffer, io::kBufferCount> buffers_;
};

// What a kernel finds at each binding. A shader may declare buffers that its specialization constants leave unused. If
// such a buffer does not exist, a stand-in is bound (set_absent()), which no kernel touches. The stand-in must be a
// buffer that no other dispatch writes before the next barrier, since synchronization validation treats a binding as an
// access.
class BufferTable {
public:
    struct Entry {
        uint32_t number = 0;
        BufferRange range;
    };
    BufferTable() = default;
    BufferTable(std::initializer_list<Entry> entries) { set(entries); }

    BufferTable& set(std::initializer_list<Entry> entries);
    BufferTable& add(const Buffers& buffers);
    // Sets what stands in for a missing storage buffer, and for a missing table (gpu/table.glsl).
    BufferTable& set_absent(const BufferRange& storage, const BufferRange& table);
    // The same, with some entries replaced or added.
    BufferTable with(std::initializer_list<Entry> entries) const { return BufferTable(*this).set(entries); }

    const BufferRange& storage(uint32_t number) const { return or_else(number, absent_storage_); }
    const BufferRange& table(uint32_t number) const { return or_else(number, absent_table_); }

private:
    const BufferRange& or_else(uint32_t number, const BufferRange& absent) const {
        return ranges_[number] ? ranges_[number] : absent;
    }

    std::array<BufferRange, io::kBufferCount> ranges_;
    BufferRange absent_storage_, absent_table_;
};

}  // namespace throng
