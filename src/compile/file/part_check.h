// What the checks of a character's parts share. Each throws what check_character() says.
#pragma once

#include "base/failure.h"
#include "base/finite.h"

#include <throng/character.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace throng {

// Ranges of an array that must follow one another without a gap, so that each element is looked at once.
struct Ranges {
    const char *begin_at, *end_at;  // for messages: "its times begin at "
    size_t size;                    // of the array
    uint64_t next = 0;
};

class PartCheck {
public:
    // Keeps the references.
    PartCheck(const Character& character, const std::string& place, ErrorCode code)
        : c_(character), place_(place), code_(code) {}

protected:
    static std::string at(const char* array, size_t index) { return joined(array, "[", index, "]"); }

    // Whether the corners are finite, and so is their difference, which can overflow.
    static bool is_finite_box(const Vec3<float>& low, const Vec3<float>& high) {
        return all_finite(low) && all_finite(high) && all_finite(high - low);
    }

    template <class... Parts>
    [[noreturn]] void fail(const std::string& where, const Parts&... what) const {
        throw Failure(code_, place_ + ": " + where, what...);
    }

    void check_limit(const char* where, uint64_t count, const char* of, uint64_t limit) const {
        if (count > limit)
            throw Failure(ErrorCode::kLimit, joined(place_, ": ", where), count, of, "; the limit is ", limit);
    }
    void check_count(const char* array, uint64_t count, uint64_t expected, const char* whose = ", not ") const {
        if (count != expected) fail(array, "has ", count, " elements", whose, expected);
    }

    template <class T>
    void check_finite(const char* array, const std::vector<T>& elements) const {
        check_finite(array, elements, [](const T& element) { return all_finite(element); });
    }
    template <class T, class IsFinite>
    void check_finite(const char* array, const std::vector<T>& elements, const IsFinite& is_finite) const {
        for (size_t i = 0; i < elements.size(); ++i)
            if (!is_finite(elements[i])) fail(at(array, i), "is not finite");
    }

    void advance(Ranges& ranges, const std::string& where, uint64_t first, uint64_t count) const {
        if (first != ranges.next) fail(where, ranges.begin_at, first, ", not ", ranges.next);
        ranges.next += count;
        if (ranges.next > ranges.size) fail(where, ranges.end_at, ranges.next, ", but there are only ", ranges.size);
    }

    void check_ascending(const char* array, const std::vector<float>& times_s, size_t begin, size_t end) const {
        for (size_t row = begin; row < end; ++row) {
            if (!(times_s[row] >= 0) || !std::isfinite(times_s[row]))
                fail(at(array, row), "must be finite and not negative");
            if (row > begin && !(times_s[row - 1] < times_s[row]))
                fail(at(array, row), "is not later than the time before it");
        }
    }

    // Position of the last key of a track of exact keys or weights.
    static uint64_t last_key(uint32_t word, uint32_t row_count, uint32_t row_stride) {
        const bool animated = (word & kTrackAnimated) != 0;
        return (word & kTrackPosition) + (animated ? (row_count - uint64_t{1}) * row_stride : 0);
    }

    const Character& c_;
    const std::string& place_;
    ErrorCode code_;
};

// Tracks of joints with their keys, and root motion. Sizes of arrays must have been checked.
void check_clips(const Character& character, const std::string& place, ErrorCode code);
// Palette, skins, sections and levels of detail.
void check_mesh(const Character& character, const std::string& place, ErrorCode code);
// Morphs and their tracks. The mesh must have been checked.
void check_morphs(const Character& character, const std::string& place, ErrorCode code);

}  // namespace throng
