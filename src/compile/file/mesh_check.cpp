#include "compile/file/part_check.h"

#include "compile/limits.h"
#include "compile/rig/joint_lod.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

class MeshCheck : public PartCheck {
public:
    using PartCheck::PartCheck;

    void run() const {
        check_palette();
        check_sections();
        check_lods();
        check_joint_lods();
    }

private:
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

    void check_sections() const {
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
};

}  // namespace

void check_mesh(const Character& character, const std::string& place, ErrorCode code) {
    MeshCheck(character, place, code).run();
}

}  // namespace throng
