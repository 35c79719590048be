#include "compile/file/character_check.h"

#include "base/failure.h"
#include "base/finite.h"
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

// Whether the corners are finite, and so is their difference, which can overflow.
bool is_finite_box(const Vec3<float>& low, const Vec3<float>& high) {
    return all_finite(low) && all_finite(high) && all_finite(high - low);
}

std::string at(const char* array, size_t index) { return joined(array, "[", index, "]"); }

// Ranges of an array that must follow one another without a gap, so that each element is looked at once.
struct Ranges {
    const char *begin_at, *end_at;  // for messages: "its times begin at "
    size_t size;                    // of the array
    uint64_t next = 0;
};

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
        if (!c_.packed) check_finite("keys", c_.keys);
        for (size_t clip = 0; clip <= c_.clips.size(); ++clip) check_clip(clip);
        if (c_.rig.uniform_scale && !has_uniform_scale(c_))
            fail("rig", "uniform_scale is set, but its scales are not uniform");
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

    // ---- Rig

    void check_rig() const {
        const std::vector<uint32_t>& parents = c_.rig.parents;
        if (parents.empty()) fail("rig", "has no joints");
        check_limit("rig", parents.size(), " joints", kJointLimit);
        if (c_.rig.names.size() != parents.size() || c_.rig.nodes.size() != parents.size() ||
            c_.rig.rest.size() != parents.size())
            fail("rig", "the numbers of names, parents, nodes and rest transforms differ");
        for (size_t joint = 0; joint < parents.size(); ++joint) {
            if (parents[joint] >= joint && parents[joint] != kNone)
                fail(at("parents", joint), parents[joint], " is not an earlier joint");
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
            fail("rig", "its numbers of levels and leaves, or its mean depth, do not match its parents");
    }

    void check_scalars() const {
        const Vec3<float>&low = c_.bounds_min, &high = c_.bounds_max;
        if (!is_finite_box(low, high) || low.x > high.x || low.y > high.y || low.z > high.z)
            fail("bounds", "bounds_min, bounds_max and their difference must be finite, and bounds_min not above");
        if (!(c_.size > 0) || !std::isfinite(c_.size)) fail("size", "is not positive and finite");
    }

    // ---- Clips

    void check_sizes() const {
        file::Records none;
        file::visit_sections(
            none, c_, [&](file::SectionId, const char* name, const auto& elements, uint64_t limit_bytes = ~0ull) {
                check_limit(name, std::span(elements).size_bytes(), " bytes", limit_bytes);
            });
        check_count("tracks", c_.tracks.size(), (c_.clips.size() + uint64_t{1}) * c_.rig.joint_count());
        if (c_.packed && c_.words.size() < kPackedWordsBehind)
            fail("words", "has ", c_.words.size(), " elements, fewer than the ", kPackedWordsBehind,
                 " after the last row");
    }

    void check_ascending(const char* array, const std::vector<float>& times_s, size_t begin, size_t end) const {
        for (size_t row = begin; row < end; ++row) {
            if (!(times_s[row] >= 0) || !std::isfinite(times_s[row]))
                fail(at(array, row), "must be finite and not negative");
            if (row > begin && !(times_s[row - 1] < times_s[row]))
                fail(at(array, row), "is not later than the time before it");
        }
    }

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

    // Position of the last key of a track of exact keys or weights.
    static uint64_t last_key(uint32_t word, uint32_t row_count, uint32_t row_stride) {
        const bool animated = (word & kTrackAnimated) != 0;
        return (word & kTrackPosition) + (animated ? (row_count - uint64_t{1}) * row_stride : 0);
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

    // ---- Skin and mesh

    void check_palette() const {
        check_limit("palette", c_.palette.size(), " entries", kPaletteLimit);
        for (size_t i = 0; i < c_.palette.size(); ++i)
            if (c_.palette[i].joint >= c_.rig.joint_count())
                fail(at("palette", i), "joint is ", c_.palette[i].joint, ", but there are ", c_.rig.joint_count(),
                     " joints");
        check_finite("palette", c_.palette, [](const PaletteEntry& entry) {
            return std::ranges::all_of(entry.joint_from_bind.row, [](const auto& row) { return all_finite(row); });
        });
        for (size_t i = 0; i < c_.skins.size(); ++i) {
            const uint64_t end = uint64_t{c_.skins[i].first_entry} + c_.skins[i].joint_count;
            if (end > c_.palette.size())
                fail(at("skins", i), "ends at entry ", end, ", but the palette has ", c_.palette.size());
        }
    }

    void check_mesh() const {
        Ranges vertices{"its vertices begin at ", "its vertices end at ", c_.vertices.size()},
            influences{"its influences begin at ", "its influences end at ", c_.influences.size()},
            indices{"its indices begin at ", "its indices end at ", c_.indices.size()};
        check_limit("mesh sections", c_.sections.size(), " sections", kSectionLimit);
        check_count("section names", c_.section_names.size(), c_.sections.size());
        for (size_t i = 0; i < c_.sections.size(); ++i) {
            const MeshSection& section = c_.sections[i];
            const std::string where = at("mesh sections", i);
            if (section.influence_sets == 0 || section.influence_sets > kPaletteLimit / 4)
                fail(where, "influence_sets is ", section.influence_sets, "; it must be 1 to ", kPaletteLimit / 4);
            advance(vertices, where, section.first_vertex, section.vertex_count);
            if (section.lod_vertex_count > section.vertex_count)
                fail(where, "lod_vertex_count is ", section.lod_vertex_count, ", but it has ", section.vertex_count,
                     " vertices");
            advance(influences, where, section.first_influences,
                    uint64_t{section.vertex_count} * section.influence_sets);
            advance(indices, where, section.first_index, section.index_count);
            check_triangles(where, "indices", c_.indices, {section.first_index, section.index_count},
                            section.own_vertex_count());
            if (section.skin != kNone && section.skin >= c_.skins.size())
                fail(where, "skin is ", section.skin, ", but there are ", c_.skins.size(), " skins");
            if (section.material != kNone && section.material >= c_.materials.size())
                fail(where, "material is ", section.material, ", but there are ", c_.materials.size(), " materials");
        }
        for (const Ranges& ranges : {vertices, influences, indices})
            if (ranges.next != ranges.size) fail("mesh sections", "do not have all vertices, influences and indices");
        check_finite("vertices", c_.vertices,
                     [](const Vertex& vertex) { return all_finite(vertex.position) && all_finite(vertex.texcoord); });
        for (size_t i = 0; i < c_.influences.size(); ++i)
            for (const uint16_t entry : c_.influences[i].entries)
                if (entry >= c_.palette.size())
                    fail(at("influences", i), "an entry is ", entry, ", but the palette has ", c_.palette.size());
        check_finite("influences", c_.influences,
                     [](const Influences& influences_of_vertex) { return all_finite(influences_of_vertex.weights); });
        for (size_t i = 0; i < c_.influences.size(); ++i)
            for (const float weight : c_.influences[i].weights)
                if (weight < 0) fail(at("influences", i), "a weight is negative");
    }

    void check_triangles(const std::string& where, const char* array, const std::vector<uint32_t>& indices,
                         const IndexRange& range, uint32_t vertex_count) const {
        if (range.index_count % 3 != 0)
            fail(where, "has ", range.index_count, " indices, which is not a multiple of 3");
        for (size_t k = range.first_index; k < size_t{range.first_index} + range.index_count; ++k)
            if (indices[k] >= vertex_count)
                fail(at(array, k), "is ", indices[k], ", but its section has ", vertex_count, " vertices");
    }

    void check_lods() const {
        check_limit("lods", c_.lods.size(), " levels of detail", kLodLimit);
        check_count("lod ranges", c_.lod_ranges.size(), c_.lods.size() * uint64_t{c_.sections.size()});
        float before = 0;
        for (size_t level = 0; level < c_.lods.size(); ++level) {
            const float error = c_.lods[level].error;
            if (!(error >= before) || !std::isfinite(error))
                fail(at("lods", level), "its error is less than that of the level before, or not finite");
            before = error;
        }
        Ranges indices{"begins at index ", "ends at index ", c_.lod_indices.size()};
        for (size_t i = 0; i < c_.lod_ranges.size(); ++i) {
            const IndexRange& range = c_.lod_ranges[i];
            const std::string where = at("lod ranges", i);
            advance(indices, where, range.first_index, range.index_count);
            check_triangles(where, "lod indices", c_.lod_indices, range,
                            c_.sections[i % c_.sections.size()].vertex_count);
        }
        check_count("lod indices", indices.size, indices.next, ", but the ranges have ");
    }

    // Must run after the checks of palette and skins.
    void check_joint_lods() const {
        const std::vector<uint32_t>& lods = c_.joint_lods;
        if (lods.empty()) return;
        check_count("joint lods", lods.size(), c_.rig.joint_count());
        for (size_t joint = 0; joint < lods.size(); ++joint) {
            if (lods[joint] > c_.lods.size())
                fail(at("joint lods", joint), "is ", lods[joint], ", but the last level is ", c_.lods.size());
            const uint32_t parent = c_.rig.parents[joint];
            if (parent == kNone ? lods[joint] < c_.lods.size() : lods[joint] > lods[parent])
                fail(at("joint lods", joint),
                     "moves in a level in which its parent does not, or is a root that does not move in all");
        }
        for (uint32_t lod = 1; lod <= c_.lods.size(); ++lod)
            for (const uint32_t entry : entries_of_lod(c_, lod))
                if (entry == kNone)
                    fail("joint lods", "in level ", lod,
                         ", the palette entry of a joint that rests has no replacement");
    }

    void check_morphs() const {
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
    void check_morph_times() const {
        Ranges times{"its morph times begin at ", "its morph times end at ", c_.morph_times_s.size()};
        for (size_t i = 0; i < c_.clips.size(); ++i) {
            const Clip& clip = c_.clips[i];
            advance(times, at("clips", i), clip.first_morph_time, clip.morph_row_count);
            check_ascending("morph times", c_.morph_times_s, clip.first_morph_time, times.next);
        }
        check_count("morph times", times.size, times.next, ", but the clips have ");
    }

    void check_morph_tracks() const {
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

    void check_materials() const {
        for (size_t i = 0; i < c_.materials.size(); ++i) {
            const AssetMaterial& material = c_.materials[i];
            visit_images([&](auto member) {
                if (material.*member != kNone && material.*member >= c_.images.size())
                    fail(at("materials", i), "an image is ", material.*member, ", but there are ", c_.images.size(),
                         " images");
            });
            const std::array factors{material.alpha_cutoff, material.metallic, material.roughness,
                                     material.normal_scale, material.occlusion_strength};
            if (!all_finite(material.base_color) || !all_finite(material.emissive) || !all_finite(factors))
                fail(at("materials", i), "a factor is not finite");
            if (!has_known_values(material))
                fail(at("materials", i), "alpha_mode, filter, wrap_u or wrap_v has an unknown value");
        }
    }

    // Names and warnings are printed: none may send control sequences to a terminal, or look like another line.
    void check_text() const {
        file::visit_strings(c_, [&](const std::string& string) {
            if (printable(string, std::string::npos) != string)
                fail("text", "'", printable(string),
                     "' has control characters or marks that override the text direction, or is not UTF-8; compile it "
                     "again");
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
