#include "compile/file/part_check.h"

#include "compile/limits.h"

#include <cmath>

namespace throng {
namespace {

class MorphCheck : public PartCheck {
public:
    using PartCheck::PartCheck;

    void run() const {
        check_deltas();
        check_times();
        check_tracks();
    }

private:
    void check_deltas() const {
        check_limit("morphs", c_.morphs.size(), " morphs", kMorphLimit);
        for (size_t i = 0; i < c_.morphs.size(); ++i)
            if (!std::isfinite(c_.morphs[i].default_weight)) fail(at("morphs", i), "default_weight is not finite");
        for (size_t i = 0; i < c_.sections.size(); ++i) {
            const MeshSection& section = c_.sections[i];
            const uint64_t end = uint64_t{section.first_morph} + section.morph_count;
            if (end > c_.morphs.size())
                fail(at("mesh sections", i), "its morphs end at ", end, ", but there are only ", c_.morphs.size());
            for (size_t v = section.first_vertex; v < size_t{section.first_vertex} + section.vertex_count; ++v) {
                const uint32_t first = c_.vertices[v].first_delta;
                if (first == 0) continue;
                if (section.morph_count == 0) fail(at("vertices", v), "is moved by morphs, but its section has none");
                const uint64_t deltas_end = uint64_t{first} - 1 + section.morph_count;
                if (deltas_end > c_.morph_deltas.size())
                    fail(at("vertices", v), "its morph deltas end at ", deltas_end, ", but there are only ",
                         c_.morph_deltas.size());
            }
        }
        check_finite("morph deltas", c_.morph_deltas,
                     [](const MorphDelta& delta) { return all_finite(delta.position); });
    }

    // Like the times of joints, but a clip can have none.
    void check_times() const {
        Ranges times{"its morph times begin at ", "its morph times end at ", c_.morph_times_s.size()};
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            advance(times, at("clips", i), clip.first_morph_time, clip.morph_row_count);
            check_ascending("morph times", c_.morph_times_s, clip.first_morph_time, times.next);
        }
        check_count("morph times", times.size, times.next, ", but the clips have ");
    }

    void check_tracks() const {
        check_count("morph tracks", c_.morph_tracks.size(), c_.clips.size() * uint64_t{c_.morphs.size()});
        std::vector<uint64_t> in_row(c_.clips.size());  // weights
        for (size_t i = 0; i < c_.morph_tracks.size(); ++i) {
            const uint32_t word = c_.morph_tracks[i];
            if (word == kNone) continue;
            const Clip& clip = c_.clips[i / c_.morphs.size()];
            if ((word & kTrackAnimated) != 0 && clip.morph_row_count == 0)
                fail(at("morph tracks", i), "is animated, but its clip has no rows of weights");
            const uint64_t last = last_key(word, clip.morph_row_count, clip.morph_row_stride);
            if (last >= c_.morph_values.size())
                fail(at("morph tracks", i), "has a weight at ", last, ", but there are only ", c_.morph_values.size());
            in_row[i / c_.morphs.size()] += (word & kTrackAnimated) != 0;
        }
        for (size_t clip = 0; clip < c_.clips.size(); ++clip)
            if (in_row[clip] > c_.clips[clip].morph_row_stride)  // as for joints
                fail(at("clips", clip), "its morph tracks share weights: they have ", in_row[clip],
                     " a row, but its rows are only ", c_.clips[clip].morph_row_stride, " apart");
        check_finite("morph values", c_.morph_values);
    }
};

}  // namespace

void check_morphs(const Character& character, const std::string& place, ErrorCode code) {
    MorphCheck(character, place, code).run();
}

}  // namespace throng
