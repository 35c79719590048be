// Files that an earlier build wrote must still mean the same. The reader and the writer share one layout, so if two
// fields were swapped, new files would still load bit for bit, but users' existing files would be misread.
// || After a change of the format: throng_host_tests --gtest_also_run_disabled_tests --gtest_filter='*WriteThisVersion'
#include "tests/files.h"
#include "tests/host/character_file_cases.h"

#include <fstream>
#include <iomanip>
#include <sstream>

namespace throng {
namespace {

using namespace test;

// Also the fields of structs that the file stores as they are.
using test::fields_of;
auto fields_of(const Vec3<float>& v) { return std::tie(v.x, v.y, v.z); }
auto fields_of(const Quaternion<float>& q) { return std::tie(q.x, q.y, q.z, q.w); }
auto fields_of(const Trs<float>& trs) { return std::tie(trs.rotation, trs.translation, trs.scale); }
auto fields_of(const Affine& affine) { return std::tie(affine.row); }
auto fields_of(const JointTracks& tracks) {
    const auto& [rotation, translation, scale, unused] = tracks;
    return std::tie(rotation, translation, scale, unused);
}
auto fields_of(const PaletteEntry& entry) {
    const auto& [joint, joint_from_bind] = entry;
    return std::tie(joint, joint_from_bind);
}
auto fields_of(const Vertex& vertex) {
    const auto& [position, normal, texcoord, color, first_delta] = vertex;
    return std::tie(position, normal, texcoord, color, first_delta);
}
auto fields_of(const Influences& influences) {
    const auto& [weights, entries] = influences;
    return std::tie(weights, entries);
}
auto fields_of(const MeshSection& section) {
    const auto& [node, mesh, primitive, skin, first_vertex, vertex_count, lod_vertex_count, first_influences,
                 influence_sets, first_index, index_count, material, first_morph, morph_count] = section;
    return std::tie(node, mesh, primitive, skin, first_vertex, vertex_count, lod_vertex_count, first_influences,
                    influence_sets, first_index, index_count, material, first_morph, morph_count);
}
auto fields_of(const MorphDelta& delta) {
    const auto& [position, normal] = delta;
    return std::tie(position, normal);
}
auto fields_of(const Lod& lod) { return std::tie(lod.error); }
auto fields_of(const IndexRange& range) {
    const auto& [first_index, index_count] = range;
    return std::tie(first_index, index_count);
}

template <class T>
void put(std::ostream& out, const T& value) {
    if constexpr (std::is_same_v<T, std::string>) {
        out << '"';
        for (const char c : value)
            if (c >= ' ' && c <= '~')
                out << c;
            else
                out << "\\" << int{static_cast<unsigned char>(c)};
        out << '"';
    } else if constexpr (std::is_enum_v<T>) {
        out << static_cast<int>(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
        out << +value;
    } else if constexpr (requires { value.begin(); }) {
        out << '[';
        for (const auto& element : value) put(out << ' ', element);
        out << " ]";
    } else {
        out << '(';
        std::apply([&](const auto&... field) { (put(out << ' ', field), ...); }, fields_of(value));
        out << " )";
    }
}

// One line per field, with its whole content.
std::string text_of(const Character& character) {
    const auto& [name, rig, clips, times_s, packed, keys, words, root_rows, tracks, skins, palette, vertices,
                 influences, indices, sections, section_names, lods, lod_ranges, lod_indices, joint_lods, materials,
                 images, bounds_min, bounds_max, size, morphs, morph_deltas, morph_tracks, morph_times_s, morph_values,
                 warnings] = character;
    const auto& [joint_names, parents, nodes, rest, level_count, mean_depth, leaf_count, uniform_scale] = rig;
    std::ostringstream out;
    out << std::setprecision(9);
    const auto line = [&](const char* field, const auto& value) {
        out << field << ": ";
        put(out, value);
        out << '\n';
    };
    line("name", name);
    line("rig.names", joint_names);
    line("rig.parents", parents);
    line("rig.nodes", nodes);
    line("rig.rest", rest);
    line("rig.level_count", level_count);
    line("rig.mean_depth", mean_depth);
    line("rig.leaf_count", leaf_count);
    line("rig.uniform_scale", uniform_scale);
    line("clips", clips);
    line("times_s", times_s);
    line("packed", packed);
    line("keys", keys);
    line("words", words);
    line("root_rows", root_rows);
    line("tracks", tracks);
    line("skins", skins);
    line("palette", palette);
    line("vertices", vertices);
    line("influences", influences);
    line("indices", indices);
    line("sections", sections);
    line("section_names", section_names);
    line("lods", lods);
    line("lod_ranges", lod_ranges);
    line("lod_indices", lod_indices);
    line("joint_lods", joint_lods);
    line("materials", materials);
    line("images", images);
    line("bounds_min", bounds_min);
    line("bounds_max", bounds_max);
    line("size", size);
    line("morphs", morphs);
    line("morph_deltas", morph_deltas);
    line("morph_tracks", morph_tracks);
    line("morph_times_s", morph_times_s);
    line("morph_values", morph_values);
    line("warnings", warnings);
    return out.str();
}

// tests/data/version_N_exact.throng and _packed, each with its content as text in a file beside it.
std::filesystem::path path_of(double error, const char* type) {
    return std::filesystem::path(THRONG_SOURCE_DIR) / "tests/data" /
           ("version_" + std::to_string(file::kVersion) + (error > 0 ? "_packed" : "_exact") + type);
}

TEST(CharacterFileVersion, AFileOfAnEarlierBuildLoadsTheSame) {
    for (const double error : kErrors) {
        const Result<Character> character = load_character(path_of(error, ".throng"));
        ASSERT_TRUE(character) << character.error().text();
        std::istringstream now(text_of(*character)), then(test::read_file(path_of(error, ".txt")));
        std::string line_now, line_then;
        while (std::getline(now, line_now)) {
            ASSERT_TRUE(std::getline(then, line_then)) << line_now;
            EXPECT_EQ(line_now, line_then);
        }
        EXPECT_FALSE(std::getline(then, line_then)) << line_then;
    }
}

TEST(CharacterFileVersion, DISABLED_WriteThisVersion) {
    for (const double error : kErrors) {
        Character character = *load(small_file(error));
        // Fields that would otherwise be empty or equal
        character.clips[0].refined_row_count = 1;
        character.clips[0].dropped_row_count = 2;
        character.images.resize(5, {.name = "more", .encoded = {}});
        AssetMaterial& cloth = character.materials[0];
        cloth.metallic_roughness_image = 2;
        cloth.occlusion_image = 3;
        cloth.emissive_image = 4;
        cloth.normal_image = 0;
        character.lods = {{.error = 0.25f}};
        for (const MeshSection& section : character.sections) {
            const auto first = static_cast<uint32_t>(character.lod_indices.size());
            character.lod_ranges.push_back({.first_index = first, .index_count = 3});
            const uint32_t* const triangle = character.indices.data() + section.first_index;
            character.lod_indices.insert(character.lod_indices.end(), triangle, triangle + 3);
        }
        character.joint_lods = {1, 1, 1, 0};
        const Result<void> saved = save_character(character, path_of(error, ".throng"));
        ASSERT_TRUE(saved) << saved.error().text();
        std::ofstream(path_of(error, ".txt")) << text_of(character);
    }
}

}  // namespace
}  // namespace throng
