#include "morph/morph.h"

#include "morph/morph.kernel.h"

#include <bit>

namespace throng {
namespace {

static_assert(io::kMorphNormalStepBits == std::bit_cast<uint32_t>(kMorphNormalStep) &&
              io::kMinMorphWeightBits == std::bit_cast<uint32_t>(kMinMorphWeight));
static_assert(io::kMorphAnimatedBit == kTrackAnimated && io::kMorphStepBit == kTrackStep &&
              io::kMorphPositionMask == kTrackPosition);
static_assert(sizeof(io::ActiveMorph) == 8);

uint32_t up_to_four(size_t count) { return static_cast<uint32_t>((count + 3) / 4 * 4); }

std::vector<uint32_t> timelines_of(const Character& character) {
    // For clips without rows, whose weights are all constant
    constexpr io::ClipTimeline kNoRows{
        .first_time = 0, .row_count = 1, .row_stride = 0, .first_row = 0, .duration_s = 0};
    std::vector<io::ClipTimeline> timelines;
    for (const Clip& clip : character.clips)
        timelines.push_back(clip.morph_row_count == 0 ? kNoRows
                                                      : io::ClipTimeline{.first_time = clip.first_morph_time,
                                                                         .row_count = clip.morph_row_count,
                                                                         .row_stride = clip.morph_row_stride,
                                                                         .first_row = 0,
                                                                         .duration_s = clip.duration_s});
    timelines.push_back(kNoRows);  // the rest pose
    return as_words(timelines);
}

// Rows of four words. Positions count from the beginning of values_of(), which begins with the default weights.
std::vector<std::array<uint32_t, 4>> tracks_of(const Character& character) {
    const size_t morph_count = character.morphs.size(), quad_count = up_to_four(morph_count) / 4;
    std::vector<std::array<uint32_t, 4>> quads((character.clips.size() + 1) * quad_count, {kNone, kNone, kNone, kNone});
    for (size_t i = 0; i < character.morph_tracks.size(); ++i) {
        const uint32_t word = character.morph_tracks[i];
        const size_t morph = i % morph_count;
        if (word != kNone) quads[i / morph_count * quad_count + morph / 4][morph % 4] = word + up_to_four(morph_count);
    }
    return quads;
}

std::vector<float> values_of(const Character& character) {
    std::vector<float> values;
    for (const Morph& morph : character.morphs) values.push_back(morph.default_weight);
    values.resize(up_to_four(values.size()));
    values.insert(values.end(), character.morph_values.begin(), character.morph_values.end());
    return values;
}

}  // namespace

MorphTables make_morph_tables(const Character& character) {
    return {timelines_of(character), tracks_of(character), values_of(character)};
}

void upload_morph_tables(Uploads& uploads, const Character& character, Buffers& buffers) {
    const std::string& name = character.name;
    const MorphTables tables = make_morph_tables(character);
    buffers[io::kMorphTimelineBuffer] = upload_table(uploads, name + ": morph timelines", tables.timelines);
    buffers[io::kMorphTimesBuffer] = upload_table(uploads, name + ": morph times", character.morph_times_s);
    buffers[io::kMorphTracksBuffer] = upload_table(uploads, name + ": morph tracks", tables.tracks);
    buffers[io::kMorphValuesBuffer] = upload_table(uploads, name + ": morph weights", tables.values);
    buffers[io::kMorphDeltasBuffer] = upload(uploads, name + ": morph differences", character.morph_deltas);
}

Kernel morph_kernel(const std::shared_ptr<Gpu>& gpu, bool layered, bool varies) {
    return kernels::morph.on(gpu, {layered, varies});
}

}  // namespace throng
