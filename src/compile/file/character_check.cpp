#include "compile/file/character_file.h"

#include "base/failure.h"
#include "compile/file/character_layout.h"
#include "compile/rig/joint_lod.h"
#include "compile/limits.h"
#include "compile/clip/packed_track.h"
#include "compile/rig/rig.h"
#include "compile/rig/uniform_scale.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

constexpr uint32_t kPackedLayoutBits = kPackedBitsMask | 3u << kPackedLeftOutShift | kPackedFull | kPackedStep;

template <class Floats>
bool all_finite(const Floats& floats) {
    return std::all_of(std::begin(floats), std::end(floats), [](auto f) { return std::isfinite(f); });
}
bool all_finite(const Vec3<float>& v) { return all_finite(std::array{v.x, v.y, v.z}); }
// And so is the extent between two that are finite.
bool all_finite(const Vec3<float>& low, const Vec3<float>& high) {
    return all_finite(low) && all_finite(high) && all_finite(high - low);
}

std::string at(const char* array, size_t index) { return std::string(array) + "[" + std::to_string(index) + "]"; }
std::string text(uint64_t number) { return std::to_string(number); }

class Checker {
public:
    Checker(const Character& character, const std::string& place, ErrorCode code)
        : c_(character), place_(place), code_(code) {}

    void run() const {
        check_rig();
        check_scalars();
        check_sizes();
        check_times();
        check_root_rows();
        if (!c_.packed) check_exact_keys();
        for (size_t clip = 0; clip <= c_.clips.size(); ++clip) check_clip(clip);
        if (c_.rig.uniform_scale && !has_uniform_scale(c_)) fail("rig", "its scales are not uniform, which it claims");
        check_palette();
        check_mesh();
        check_lods();
        check_joint_lods();
        check_morphs();
        check_morph_times();
        check_morph_tracks();
        check_materials();
        check_text();
    }

private:
    [[noreturn]] void fail(const std::string& where, const std::string& what) const {
        throw Failure(code_, place_ + ": " + where, what);
    }
    [[noreturn]] void exceeds(const std::string& where, uint64_t count, const char* of, uint64_t limit) const {
        throw Failure(ErrorCode::kLimit, place_ + ": " + where, text(count) + of + "; the limit is " + text(limit));
    }

    // ---- Rig

    void check_rig() const {
        const std::vector<uint32_t>& parents = c_.rig.parents;
        if (parents.empty()) fail("rig", "has no joints");
        if (parents.size() > kJointLimit) exceeds("rig", parents.size(), " joints", kJointLimit);
        if (c_.rig.names.size() != parents.size() || c_.rig.nodes.size() != parents.size() ||
            c_.rig.rest.size() != parents.size())
            fail("rig", "the numbers of names, parents, nodes and rest transforms differ");
        for (size_t joint = 0; joint < parents.size(); ++joint) {
            if (parents[joint] >= joint && parents[joint] != kNone)
                fail(at("parents", joint), text(parents[joint]) + " is no earlier joint");
            const Trs<float>& rest = c_.rig.rest[joint];
            const Quaternion<float>& q = rest.rotation;
            if (!all_finite(std::array{q.x, q.y, q.z, q.w}) || !all_finite(rest.translation) || !all_finite(rest.scale))
                fail(at("rest", joint), "is not finite");
        }
        Rig measured;
        measured.parents = parents;
        measure_rig(measured);
        if (measured.level_count != c_.rig.level_count || measured.leaf_count != c_.rig.leaf_count ||
            measured.mean_depth != c_.rig.mean_depth)
            fail("rig", "its levels, leaves or mean depth are not those of its parents");
    }

    void check_scalars() const {
        const Vec3<float>&low = c_.bounds_min, &high = c_.bounds_max;
        if (!all_finite(low, high) || low.x > high.x || low.y > high.y || low.z > high.z) fail("bounds", "are no box");
        if (!(c_.size > 0) || !std::isfinite(c_.size)) fail("size", "is not positive");
    }

    // ---- Clips

    void check_sizes() const {
        const auto limit = [&](const char* array, uint64_t size_bytes) {
            if (size_bytes > kKeyLimit_bytes) exceeds(array, size_bytes, " bytes", kKeyLimit_bytes);
        };
        limit("keys", c_.keys.size() * sizeof(c_.keys[0]));
        limit("words", c_.words.size() * sizeof(c_.words[0]));
        limit("root rows", c_.root_rows.size() * sizeof(c_.root_rows[0]));
        limit("tracks", c_.tracks.size() * sizeof(c_.tracks[0]));
        const uint64_t track_count = (c_.clips.size() + uint64_t{1}) * c_.rig.joint_count();
        if (c_.tracks.size() != track_count)
            fail("tracks", "are " + text(c_.tracks.size()) + ", not " + text(track_count));
        if (c_.packed && c_.words.size() < kPackedWordsBehind)
            fail("words", "are " + text(c_.words.size()) + ", fewer than the " + text(kPackedWordsBehind) +
                              " behind the last row");
    }

    void check_ascending(const char* array, const std::vector<float>& times_s, size_t begin, size_t end) const {
        for (size_t row = begin; row < end; ++row) {
            if (!(times_s[row] >= 0) || !std::isfinite(times_s[row])) fail(at(array, row), "is no time");
            if (row > begin && !(times_s[row - 1] < times_s[row]))
                fail(at(array, row), "does not come after the one before");
        }
    }

    // Clip after clip, with no gap: so each time is looked at once.
    void check_times() const {
        uint64_t next = 0;
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            if (!(clip.duration_s >= 0) || !std::isfinite(clip.duration_s))
                fail(at("clips", i), "its duration is no time");
            if (!std::isfinite(clip.error)) fail(at("clips", i), "its error is not finite");
            if (!all_finite(clip.bounds_min, clip.bounds_max)) fail(at("clips", i), "its bounds are not finite");
            if (clip.row_count == 0) fail(at("clips", i), "has no rows");
            if (clip.first_time != next)
                fail(at("clips", i), "its times begin at " + text(clip.first_time) + ", not " + text(next));
            next += clip.row_count;
            if (next > c_.times_s.size())
                fail(at("clips", i), "its times end at " + text(next) + " of " + text(c_.times_s.size()));
            check_ascending("times", c_.times_s, clip.first_time, next);
        }
        if (next != c_.times_s.size())
            fail("times", "are " + text(c_.times_s.size()) + ", and the clips have " + text(next));
    }

    // Clip after clip too, of those that have any.
    void check_root_rows() const {
        uint64_t next = 0;
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            if (clip.root_row_count == 1)
                fail(at("clips", i), "one row of root motion; there are none, or one at each end and those between");
            if (clip.first_root_row != (clip.root_row_count > 0 ? next : 0))
                fail(at("clips", i), "its root motion begins at row " + text(clip.first_root_row) + ", not " +
                                         text(clip.root_row_count > 0 ? next : 0));
            next += clip.root_row_count;
            if (next > c_.root_rows.size())
                fail(at("clips", i), "its root motion ends at row " + text(next) + " of " + text(c_.root_rows.size()));
        }
        if (next != c_.root_rows.size())
            fail("root rows", "are " + text(c_.root_rows.size()) + ", and the clips have " + text(next));
        constexpr float kUnit = 1e-3f;
        for (size_t i = 0; i < c_.root_rows.size(); ++i) {
            const auto& [x, z, cosine, sine] = c_.root_rows[i];
            if (!all_finite(c_.root_rows[i])) fail(at("root rows", i), "is not finite");
            if (!(std::abs(std::hypot(cosine, sine) - 1) <= kUnit))
                fail(at("root rows", i), "its cosine and sine are of no turn");
        }
    }

    // `clip` may be the number of clips: the rest pose, which has constants only.
    void check_clip(size_t clip) const {
        const bool is_rest = clip == c_.clips.size();
        const Clip none{.row_count = 1};
        const Clip& of = is_rest ? none : c_.clips[clip];
        const uint64_t rows_end = of.first_row + uint64_t{of.row_count} * of.row_stride;
        const uint64_t room = c_.packed ? c_.words.size() - kPackedWordsBehind : c_.keys.size();
        if (rows_end > room) fail(at("clips", clip), "its rows end at " + text(rows_end) + " of " + text(room));
        if (!c_.packed && of.first_row != 0)
            fail(at("clips", clip), "its rows begin at word " + text(of.first_row) + ", but its keys are not packed");
        for (size_t joint = 0; joint < c_.rig.joint_count(); ++joint) {
            const size_t index = clip * c_.rig.joint_count() + joint;
            const JointTracks& tracks = c_.tracks[index];
            for (const uint32_t word : {tracks.rotation, tracks.translation, tracks.scale}) {
                if (c_.packed)
                    check_packed_track(index, word, of, is_rest);
                else
                    check_exact_track(index, word, of, is_rest);
            }
        }
    }

    void check_exact_keys() const {
        for (size_t i = 0; i < c_.keys.size(); ++i)
            if (!all_finite(c_.keys[i])) fail(at("keys", i), "is not finite");
    }

    void check_exact_track(size_t index, uint32_t word, const Clip& clip, bool is_rest) const {
        const bool animated = (word & kTrackAnimated) != 0;
        if (animated && is_rest) fail(at("tracks", index), "is animated, in the rest pose");
        const uint64_t last = (word & kTrackPosition) +
                              (animated ? (clip.row_count - uint64_t{1}) * clip.row_stride : 0);
        if (last >= c_.keys.size())
            fail(at("tracks", index), "has a key at " + text(last) + " of " + text(c_.keys.size()));
    }

    void check_packed_track(size_t index, uint32_t position, const Clip& clip, bool is_rest) const {
        const auto refuse = [&](const std::string& what) { fail(at("tracks", index), what); };
        if (position >= c_.keys.size()) refuse("is at key " + text(position) + " of " + text(c_.keys.size()));
        PackedTrack track;
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(c_.keys[0]));
        if (!all_finite(track.minimum)) refuse("is not finite");
        if ((track.layout & ~kPackedLayoutBits) != 0) refuse("its layout has unknown bits");
        const bool full = (track.layout & kPackedFull) != 0;
        uint32_t bits = 0;
        for (uint32_t component = 0; component < 3; ++component) {
            const uint32_t count = packed_bit_count(track, component);
            if (count > kPackedComponentBits || (full && count != kPackedFullBits))
                refuse("has a component of " + text(count) + " bits");
            bits += count;
        }
        if (bits == 0) return;
        if (is_rest) refuse("is animated, in the rest pose");
        if (position + uint64_t{1} >= c_.keys.size())
            refuse("is at key " + text(position) + " of " + text(c_.keys.size()) + ", and takes two");
        std::memcpy(static_cast<void*>(&track), &c_.keys[position], sizeof(track));
        if (!all_finite(track.step)) refuse("is not finite");
        for (size_t c = 0; full && c < 3; ++c)
            if (track.minimum[c] != -1 || track.step[c] != kPackedFullStep)
                refuse("is a full rotation with a minimum or step of its own");
        bits = packed_row_bits(track);
        static_assert(31 + std::max(3 * kPackedComponentBits, 4 * kPackedFullBits) <= 96,
                      "three words hold a track, wherever it begins in the first");
        const uint64_t end = uint64_t{track.first_bit} + bits, row_bits = uint64_t{clip.row_stride} * 32;
        if (end > row_bits) refuse("ends at bit " + text(end) + " of " + text(row_bits) + " a row");
    }

    // ---- Skin and mesh

    void check_palette() const {
        if (c_.palette.size() > kPaletteLimit) exceeds("palette", c_.palette.size(), " entries", kPaletteLimit);
        for (size_t i = 0; i < c_.palette.size(); ++i) {
            if (c_.palette[i].joint >= c_.rig.joint_count())
                fail(at("palette", i), "joint " + text(c_.palette[i].joint) + " of " + text(c_.rig.joint_count()));
            const auto& row = c_.palette[i].joint_from_bind.row;
            if (!all_finite(row[0]) || !all_finite(row[1]) || !all_finite(row[2]))
                fail(at("palette", i), "is not finite");
        }
        for (size_t i = 0; i < c_.skins.size(); ++i) {
            const uint64_t end = uint64_t{c_.skins[i].first_entry} + c_.skins[i].joint_count;
            if (end > c_.palette.size())
                fail(at("skins", i), "ends at entry " + text(end) + " of " + text(c_.palette.size()));
        }
    }

    // Section after section, with no gap: so each vertex, influence and index is looked at once.
    void check_mesh() const {
        uint64_t vertices = 0, influences = 0, indices = 0;
        for (size_t i = 0; i < c_.sections.size(); ++i) {
            const MeshSection& section = c_.sections[i];
            const auto refuse = [&](const std::string& what) { fail(at("sections", i), what); };
            const auto advance = [&](const char* what, uint32_t first, uint64_t count, size_t room, uint64_t& next) {
                if (first != next)
                    refuse(std::string("its ") + what + " begin at " + text(first) + ", not " + text(next));
                next += count;
                if (next > room) refuse(std::string("its ") + what + " end at " + text(next) + " of " + text(room));
            };
            if (section.influence_sets == 0 || section.influence_sets > kPaletteLimit / 4)
                refuse(text(section.influence_sets) + " sets of influences");
            advance("vertices", section.first_vertex, section.vertex_count, c_.vertices.size(), vertices);
            advance("influences", section.first_influences, uint64_t{section.vertex_count} * section.influence_sets,
                    c_.influences.size(), influences);
            advance("indices", section.first_index, section.index_count, c_.indices.size(), indices);
            if (section.index_count % 3 != 0) refuse(text(section.index_count) + " indices make no triangles");
            for (size_t k = section.first_index; k < indices; ++k)
                if (c_.indices[k] >= section.vertex_count)
                    fail(at("indices", k), text(c_.indices[k]) + " of " + text(section.vertex_count) + " vertices");
            if (section.skin != kNone && section.skin >= c_.skins.size())
                refuse("skin " + text(section.skin) + " of " + text(c_.skins.size()));
            if (section.material != kNone && section.material >= c_.materials.size())
                refuse("material " + text(section.material) + " of " + text(c_.materials.size()));
        }
        if (vertices != c_.vertices.size() || influences != c_.influences.size() || indices != c_.indices.size())
            fail("sections", "leave vertices, influences or indices out");
        for (size_t i = 0; i < c_.vertices.size(); ++i)
            if (!all_finite(c_.vertices[i].position) || !all_finite(c_.vertices[i].texcoord))
                fail(at("vertices", i), "is not finite");
        for (size_t i = 0; i < c_.influences.size(); ++i) {
            for (const uint16_t entry : c_.influences[i].entries)
                if (entry >= c_.palette.size())
                    fail(at("influences", i), "palette entry " + text(entry) + " of " + text(c_.palette.size()));
            if (!all_finite(c_.influences[i].weights)) fail(at("influences", i), "is not finite");
        }
    }

    void check_lods() const {
        if (c_.lods.size() > kLodLimit) exceeds("lods", c_.lods.size(), " of them", kLodLimit);
        const uint64_t range_count = c_.lods.size() * uint64_t{c_.sections.size()};
        if (c_.lod_ranges.size() != range_count)
            fail("lod ranges", "are " + text(c_.lod_ranges.size()) + ", not " + text(range_count));
        for (size_t level = 0; level < c_.lods.size(); ++level)
            if (!(c_.lods[level].error >= (level > 0 ? c_.lods[level - 1].error : 0)) ||
                !std::isfinite(c_.lods[level].error))
                fail(at("lods", level), "its error is less than that of the level before, or not finite");
        uint64_t next = 0;
        for (size_t i = 0; i < c_.lod_ranges.size(); ++i) {
            const IndexRange& range = c_.lod_ranges[i];
            const uint32_t vertex_count = c_.sections[i % c_.sections.size()].vertex_count;
            if (range.first_index != next)
                fail(at("lod ranges", i), "begins at index " + text(range.first_index) + ", not " + text(next));
            next += range.index_count;
            if (next > c_.lod_indices.size())
                fail(at("lod ranges", i), "ends at index " + text(next) + " of " + text(c_.lod_indices.size()));
            if (range.index_count % 3 != 0)
                fail(at("lod ranges", i), text(range.index_count) + " indices make no triangles");
            for (size_t k = range.first_index; k < next; ++k)
                if (c_.lod_indices[k] >= vertex_count)
                    fail(at("lod indices", k), text(c_.lod_indices[k]) + " of " + text(vertex_count) + " vertices");
        }
        if (next != c_.lod_indices.size())
            fail("lod indices", "are " + text(c_.lod_indices.size()) + ", and the ranges have " + text(next));
    }

    // After palette and skins.
    void check_joint_lods() const {
        const std::vector<uint32_t>& lods = c_.joint_lods;
        if (lods.empty()) return;
        if (lods.size() != c_.rig.joint_count())
            fail("joint lods", "are " + text(lods.size()) + ", not " + text(c_.rig.joint_count()));
        for (size_t joint = 0; joint < lods.size(); ++joint) {
            if (lods[joint] > c_.lods.size())
                fail(at("joint lods", joint), "level " + text(lods[joint]) + " of " + text(c_.lods.size()));
            const uint32_t parent = c_.rig.parents[joint];
            if (parent == kNone ? lods[joint] < c_.lods.size() : lods[joint] > lods[parent])
                fail(at("joint lods", joint), "it moves where its parent does not, or rests without one");
        }
        for (uint32_t lod = 1; lod <= c_.lods.size(); ++lod)
            for (const uint32_t entry : entries_of_lod(c_, lod))
                if (entry == kNone)
                    fail("joint lods", "level " + text(lod) + " leaves a palette entry without one that stands for it");
    }

    void check_morphs() const {
        if (c_.morphs.size() > kMorphLimit) exceeds("morphs", c_.morphs.size(), " of them", kMorphLimit);
        for (size_t i = 0; i < c_.morphs.size(); ++i)
            if (!std::isfinite(c_.morphs[i].default_weight)) fail(at("morphs", i), "its weight is not finite");
        for (size_t i = 0; i < c_.sections.size(); ++i) {
            const MeshSection& section = c_.sections[i];
            const uint64_t end = uint64_t{section.first_morph} + section.morph_count;
            if (end > c_.morphs.size())
                fail(at("sections", i), "its morphs end at " + text(end) + " of " + text(c_.morphs.size()));
            for (size_t v = section.first_vertex; v < size_t{section.first_vertex} + section.vertex_count; ++v) {
                const uint32_t first = c_.vertices[v].first_delta;
                if (first == 0) continue;
                if (section.morph_count == 0) fail(at("vertices", v), "is moved by morphs, and its section has none");
                const uint64_t deltas_end = uint64_t{first} - 1 + section.morph_count;
                if (deltas_end > c_.morph_deltas.size())
                    fail(at("vertices", v),
                         "its morphs' differences end at " + text(deltas_end) + " of " + text(c_.morph_deltas.size()));
            }
        }
        for (size_t i = 0; i < c_.morph_deltas.size(); ++i)
            if (!all_finite(c_.morph_deltas[i].position)) fail(at("morph deltas", i), "is not finite");
    }

    // As those of joints, but a clip may have none.
    void check_morph_times() const {
        uint64_t next = 0;
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            if (clip.first_morph_time != next)
                fail(at("clips", i),
                     "its times of morphs begin at " + text(clip.first_morph_time) + ", not " + text(next));
            next += clip.morph_row_count;
            if (next > c_.morph_times_s.size())
                fail(at("clips", i),
                     "its times of morphs end at " + text(next) + " of " + text(c_.morph_times_s.size()));
            check_ascending("morph times", c_.morph_times_s, clip.first_morph_time, next);
        }
        if (next != c_.morph_times_s.size())
            fail("morph times", "are " + text(c_.morph_times_s.size()) + ", and the clips have " + text(next));
    }

    void check_morph_tracks() const {
        const auto limit = [&](const char* array, uint64_t size_bytes) {
            if (size_bytes > kKeyLimit_bytes) exceeds(array, size_bytes, " bytes", kKeyLimit_bytes);
        };
        limit("morph deltas", c_.morph_deltas.size() * sizeof(c_.morph_deltas[0]));
        limit("morph tracks", c_.morph_tracks.size() * sizeof(c_.morph_tracks[0]));
        limit("morph values", c_.morph_values.size() * sizeof(c_.morph_values[0]));
        const uint64_t track_count = c_.clips.size() * uint64_t{c_.morphs.size()};
        if (c_.morph_tracks.size() != track_count)
            fail("morph tracks", "are " + text(c_.morph_tracks.size()) + ", not " + text(track_count));
        for (size_t i = 0; i < c_.morph_tracks.size(); ++i) {
            const uint32_t word = c_.morph_tracks[i];
            if (word == kNone) continue;
            const Clip& clip = c_.clips[i / c_.morphs.size()];
            const bool animated = (word & kTrackAnimated) != 0;
            if (animated && clip.morph_row_count == 0)
                fail(at("morph tracks", i), "is animated, and its clip has no rows");
            const uint64_t last = (word & kTrackPosition) +
                                  (animated ? (clip.morph_row_count - uint64_t{1}) * clip.morph_row_stride : 0);
            if (last >= c_.morph_values.size())
                fail(at("morph tracks", i), "has a weight at " + text(last) + " of " + text(c_.morph_values.size()));
        }
        for (size_t i = 0; i < c_.morph_values.size(); ++i)
            if (!std::isfinite(c_.morph_values[i])) fail(at("morph values", i), "is not finite");
    }

    void check_materials() const {
        for (size_t i = 0; i < c_.materials.size(); ++i) {
            const AssetMaterial& material = c_.materials[i];
            visit_images([&](auto member) {
                if (material.*member != kNone && material.*member >= c_.images.size())
                    fail(at("materials", i), "image " + text(material.*member) + " of " + text(c_.images.size()));
            });
            const std::array factors{material.alpha_cutoff, material.metallic, material.roughness,
                                     material.normal_scale, material.occlusion_strength};
            if (!all_finite(material.base_color) || !all_finite(material.emissive) || !all_finite(factors))
                fail(at("materials", i), "is not finite");
        }
    }

    // Names and warnings are printed: none rewrites a terminal, or looks like another line.
    void check_text() const {
        file::visit_strings(c_, [&](const std::string& string) {
            if (printable(string, std::string::npos) != string)
                fail("text", "'" + printable(string) + "' has control characters in it");
        });
    }

    const Character& c_;
    const std::string& place_;
    ErrorCode code_;
};

}  // namespace

void check_character(const Character& character, const std::string& place, ErrorCode code) {
    Checker(character, place, code).run();
}

}  // namespace throng
