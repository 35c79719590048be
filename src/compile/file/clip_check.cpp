#include "compile/file/part_check.h"

#include "compile/clip/packed_track.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

constexpr uint32_t kPackedLayoutBits = kPackedBitsMask | 3u << kPackedLeftOutShift | kPackedFull | kPackedStep;

class ClipCheck : public PartCheck {
public:
    using PartCheck::PartCheck;

    void run() const {
        check_times();
        check_root_rows();
        if (!c_.packed) check_finite("keys", c_.keys);
        for (size_t clip = 0; clip <= c_.clips.size(); ++clip) check_clip(clip);
    }

private:
    void check_times() const {
        Ranges times{"its times begin at ", "its times end at ", c_.times_s.size()};
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            const std::string where = at("clips", i);
            if (!(clip.duration_s >= 0) || !std::isfinite(clip.duration_s))
                fail(where, "its duration must be finite and not negative");
            if (!std::isfinite(clip.error)) fail(where, "its error is not finite");
            if (!is_finite_box(clip.bounds_min, clip.bounds_max)) fail(where, "its bounds are not finite");
            if (clip.row_count == 0) fail(where, "has no rows");
            advance(times, where, clip.first_time, clip.row_count);
            check_ascending("times", c_.times_s, clip.first_time, times.next);
        }
        check_count("times", times.size, times.next, ", but the clips have ");
    }

    void check_root_rows() const {
        Ranges rows{"its root motion begins at row ", "its root motion ends at row ", c_.root_rows.size()};
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            if (clip.root_row_count == 1)
                fail(at("clips", i), "has one row of root motion; it must have none or at least two");
            Ranges none{rows.begin_at, rows.end_at, rows.size};
            advance(clip.root_row_count > 0 ? rows : none, at("clips", i), clip.first_root_row, clip.root_row_count);
        }
        check_count("root rows", rows.size, rows.next, ", but the clips have ");
        constexpr float kUnit = 1e-3f;
        check_finite("root rows", c_.root_rows);
        for (size_t i = 0; i < c_.root_rows.size(); ++i) {
            const auto& [x, z, cosine, sine] = c_.root_rows[i];
            if (!(std::abs(std::hypot(cosine, sine) - 1) <= kUnit))
                fail(at("root rows", i), "its cosine and sine are not those of an angle");
        }
    }

    // `clip` may be the number of clips: the rest pose, which has constants only.
    void check_clip(size_t clip) const {
        const bool is_rest = clip == c_.clips.size();
        const Clip none{.row_count = 1};
        const Clip& of = is_rest ? none : c_.clips[clip];
        const uint64_t rows_end = of.first_row + uint64_t{of.row_count} * of.row_stride;
        const uint64_t room = c_.packed ? c_.words.size() - kPackedWordsBehind : c_.keys.size();
        if (rows_end > room)
            fail(at("clips", clip), "its rows end at ", rows_end, ", but there are only ", room,
                 c_.packed ? " words" : " keys");
        if (!c_.packed && of.first_row != 0)
            fail(at("clips", clip), "its rows begin at word ", of.first_row, ", but its keys are not packed");
        uint64_t in_row = 0;  // keys, or bits where they are packed
        for (size_t joint = 0; joint < c_.rig.joint_count(); ++joint) {
            const size_t index = clip * c_.rig.joint_count() + joint;
            const JointTracks& tracks = c_.tracks[index];
            for (const uint32_t word : {tracks.rotation, tracks.translation, tracks.scale})
                in_row += c_.packed ? check_packed_track(index, word, of, is_rest)
                                    : check_exact_track(index, word, of, is_rest);
        }
        // Tracks must not share keys. Otherwise a small file could have clips that take hours to go through
        if (in_row > uint64_t{of.row_stride} * (c_.packed ? 32 : 1))
            fail(at("clips", clip), "its tracks share keys: they have ", in_row, c_.packed ? " bits" : " keys",
                 " a row, but its rows are only ", of.row_stride, c_.packed ? " words" : " keys", " apart");
    }

    // Returns the number of keys that the track has in each row.
    uint64_t check_exact_track(size_t index, uint32_t word, const Clip& clip, bool is_rest) const {
        const bool animated = (word & kTrackAnimated) != 0;
        if (animated && is_rest) fail(at("tracks", index), "is animated, but belongs to the rest pose");
        const uint64_t last = last_key(word, clip.row_count, clip.row_stride);
        if (last >= c_.keys.size())
            fail(at("tracks", index), "has a key at ", last, ", but there are only ", c_.keys.size());
        return animated ? 1 : 0;
    }

    // Returns the number of bits that the track has in each row.
    uint64_t check_packed_track(size_t index, uint32_t position, const Clip& clip, bool is_rest) const {
        const auto refuse = [&](const auto&... what) { fail(at("tracks", index), what...); };
        if (position >= c_.keys.size()) refuse("is at key ", position, ", but there are only ", c_.keys.size());
        PackedTrack track;
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(c_.keys[0]));
        if (!all_finite(track.minimum)) refuse("is not finite");
        if ((track.layout & ~kPackedLayoutBits) != 0) refuse("its layout has unknown bits");
        const bool full = (track.layout & kPackedFull) != 0;
        uint32_t bits = 0;
        for (uint32_t component = 0; component < 3; ++component) {
            const uint32_t count = packed_bit_count(track, component);
            if (count > kPackedComponentBits || (full && count != kPackedFullBits))
                refuse("has a component of ", count, " bits");
            bits += count;
        }
        if (bits == 0) return 0;
        if (is_rest) refuse("is animated, but belongs to the rest pose");
        if (position + uint64_t{1} >= c_.keys.size())
            refuse("is at key ", position, " and takes two, but there are only ", c_.keys.size());
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(track));
        if (!all_finite(track.step)) refuse("is not finite");
        for (size_t c = 0; full && c < 3; ++c)
            if (track.minimum[c] != -1 || track.step[c] != kPackedFullStep)
                refuse("is a full rotation, but its minimum or step is not the one of full rotations");
        bits = packed_row_bits(track);
        static_assert(31 + std::max(3 * kPackedComponentBits, 4 * kPackedFullBits) <= 96,
                      "three words hold a track, wherever it begins in the first");
        const uint64_t end = uint64_t{track.first_bit} + bits, row_bits = uint64_t{clip.row_stride} * 32;
        if (end > row_bits) refuse("ends at bit ", end, ", but a row has only ", row_bits);
        return bits;
    }
};

}  // namespace

void check_clips(const Character& character, const std::string& place, ErrorCode code) {
    ClipCheck(character, place, code).run();
}

}  // namespace throng
