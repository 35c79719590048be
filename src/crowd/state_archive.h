// The state that a crowd continues from, as bytes: each part is written and read by the same function.
#pragma once

#include "base/failure.h"
#include "base/finite.h"
#include "base/populate.h"
#include "crowd/dirty_ranges.h"
#include "gpu/shader_types.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

namespace throng {

// The bytes that it reads may be damaged: callers refuse() impossible values.
class StateArchive {
public:
    StateArchive() = default;  // writes
    explicit StateArchive(std::span<const std::byte> bytes) : unread_(bytes), reads_(true) {}

    bool reads() const { return reads_; }
    bool is_at_end() const { return unread_.empty(); }
    const std::vector<std::byte>& written() const { return written_; }
    std::vector<std::byte> take() { return std::move(written_); }

    // Numbers of instances in the bytes are those of the crowd that wrote them; `renumber` returns the number in the
    // one that reads them, or kNone where the instance is not there. Unset: they are the same.
    void set_renumber(std::function<uint32_t(uint32_t number)> renumber) { renumber_ = std::move(renumber); }
    uint32_t renumbered(uint32_t number) const { return renumber_ ? renumber_(number) : number; }

    [[noreturn]] static void refuse(std::string_view why) {
        throw Failure(ErrorCode::kInvalidFile, "crowd state", why);
    }
    static void require(bool holds, std::string_view why) {
        if (!holds) refuse(why);
    }

    // Writes or reads `all`. The number of values is not stored.
    template <class T>
    void values(std::span<T> all) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
        const size_t size_bytes = all.size_bytes();
        if (reads_) {
            require(size_bytes <= unread_.size(), "it ends too early");
            if (size_bytes > 0) std::memcpy(all.data(), unread_.data(), size_bytes);
            unread_ = unread_.subspan(size_bytes);
        } else {
            const auto bytes = std::as_bytes(all);
            written_.insert(written_.end(), bytes.begin(), bytes.end());
        }
    }
    // Reuses this memory for writing; what it holds is lost.
    void write_into(std::vector<std::byte>&& memory) {
        written_ = std::move(memory);
        written_.clear();
    }
    // Reserves `size_bytes`, of which at least `sure_bytes` will be written.
    void reserve(size_t size_bytes, size_t sure_bytes) {
        if (written_.capacity() >= size_bytes) return;  // memory that has been written to, so its pages exist
        written_.reserve(size_bytes);
        populate({written_.data(), sure_bytes});
    }
    // Appends this many bytes, which the caller fills before it writes anything else.
    std::span<std::byte> room_for(size_t size_bytes) {
        written_.resize(written_.size() + size_bytes);
        return std::span(written_).last(size_bytes);
    }
    template <class T>
    void value(T& one) {
        values(std::span<T>(&one, 1));
    }
    void value(bool& one) {
        auto byte = static_cast<uint8_t>(one);
        value(byte);
        require(byte <= 1, "a flag is neither 0 nor 1");
        one = byte != 0;
    }
    // As values(). Refuses vectors that are not finite, with `why`.
    void finite_values(std::span<io::vec4> all, std::string_view why) {
        values(all);
        for (const io::vec4& v : all) require(all_finite(std::array{v.x, v.y, v.z, v.w}), why);
    }
    // Stores the number of values too. Reading refuses more than `most`.
    template <class T>
    void list(std::vector<T>& all, uint64_t most) {
        auto count = static_cast<uint64_t>(all.size());
        value(count);
        if (reads_) {
            require(count <= most && count <= unread_.size() / sizeof(T), "a list is too long");
            all.resize(count);
        }
        values(std::span(all));
    }
    // The changes among the `count` items from `first` on.
    void changes(DirtyRanges& changed, uint32_t first, uint32_t count) {
        std::vector<DirtyRanges::Range> ranges;
        for (const auto& [begin, length] : changed.pending()) {
            const uint32_t from = std::max(begin, first), end = std::min(begin + length, first + count);
            if (from < end) ranges.push_back({from - first, end - from});
        }
        list(ranges, count);
        if (!reads_) return;
        changed.remove(first, count);
        for (const auto& [begin, length] : ranges) {
            require(begin <= count && length <= count - begin, "a range of changes is out of bounds");
            changed.add(first + begin, length);
        }
    }

private:
    std::vector<std::byte> written_;
    std::span<const std::byte> unread_;
    bool reads_ = false;
    std::function<uint32_t(uint32_t)> renumber_;
};

}  // namespace throng
