// The bytes of a compiled character's file. docs/file_format.md describes them; kVersion grows with every change of
// either.
#pragma once

#include "compile/limits.h"
#include "base/count.h"

#include <throng/character.h>

#include <array>
#include <bit>
#include <concepts>
#include <span>
#include <type_traits>

namespace throng::file {

static_assert(std::endian::native == std::endian::little,
              "compiled files are little-endian, and their arrays are used as they are");

// Like PNG's signature: no text begins with its first byte, and a transfer that rewrites line ends corrupts it ("PNG
// Specification", second edition, 5.2).
inline constexpr std::array<char, 8> kMagic{'\x89', 't', 'h', 'r', 'o', 'n', 'g', '\n'};
inline constexpr uint32_t kVersion = 4;
inline constexpr uint64_t kAlignment_bytes = 16;  // of sections

struct Header {
    std::array<char, 8> magic = kMagic;
    uint32_t version = kVersion;
    uint32_t section_count = 0;
    uint64_t size_bytes = 0;  // of the file
    uint64_t checksum = 0;    // crc64() of the file without these eight bytes
};
static_assert(sizeof(Header) == 32);

// One for each section, behind the header.
struct SectionEntry {
    uint32_t id = 0;
    uint32_t element_bytes = 0;
    uint64_t offset_bytes = 0;  // from the beginning of the file
    uint64_t size_bytes = 0;
    uint64_t element_count = 0;
};
static_assert(sizeof(SectionEntry) == 32);

enum class SectionId : uint32_t {
    kScalars,
    kClips,
    kSkins,
    kMaterials,
    kTextEnds,
    kText,
    kImageEnds,
    kImages,
    kParents,
    kNodes,
    kRest,
    kTimes,
    kKeys,
    kWords,
    kRootRows,
    kTracks,
    kPalette,
    kVertices,
    kInfluences,
    kIndices,
    kMeshSections,
    kMorphs,
    kMorphDeltas,
    kMorphTracks,
    kMorphTimes,
    kMorphValues,
    kLods,
    kLodRanges,
    kLodIndices,
    kJointLods,
};
inline constexpr size_t kSectionCount = static_cast<size_t>(SectionId::kJointLods) + 1;

struct ScalarsRecord {
    double mean_depth = 0;
    uint32_t level_count = 0, leaf_count = 0;
    uint32_t uniform_scale = 0, packed = 0;  // 0 or 1
    uint32_t warning_count = 0;
    Vec3<float> bounds_min, bounds_max;
    float size = 0;
    std::array<uint32_t, 2> reserved{};
};
static_assert(sizeof(ScalarsRecord) == 64);

// A Clip without its name.
struct ClipRecord {
    float duration_s = 0;
    uint32_t first_time = 0, row_count = 0, row_stride = 0, first_row = 0;
    uint32_t channel_count = 0, animated_track_count = 0, refined_row_count = 0, dropped_row_count = 0;
    uint32_t first_root_row = 0, root_row_count = 0;
    uint32_t first_morph_time = 0, morph_row_count = 0, morph_row_stride = 0;
    uint64_t source_key_count = 0, size_bytes = 0, raw_size_bytes = 0;
    double error = 0;
    Vec3<float> bounds_min, bounds_max;
};
static_assert(sizeof(ClipRecord) == 112);

struct SkinRecord {
    uint32_t first_entry = 0, joint_count = 0;
};

struct MaterialRecord {
    std::array<float, 4> base_color{};
    uint32_t image = kNone;
    uint32_t alpha_mode = 0;  // of AlphaMode
    float alpha_cutoff = 0;
    uint8_t double_sided = 0;        // 0 or 1
    uint8_t filter = 0;              // of TextureFilter
    uint8_t wrap_u = 0, wrap_v = 0;  // of TextureWrap
    float metallic = 0, roughness = 0;
    uint32_t metallic_roughness_image = kNone, normal_image = kNone, occlusion_image = kNone, emissive_image = kNone;
    float normal_scale = 0, occlusion_strength = 0;
    std::array<float, 3> emissive{};
};
static_assert(sizeof(MaterialRecord) == 76);

// A Morph without its name.
struct MorphRecord {
    uint32_t node = 0, target = 0;
    float default_weight = 0;
};
static_assert(sizeof(MorphRecord) == 12);

// What the file stores in another form than the Character.
struct Records {
    std::vector<ScalarsRecord> scalars;  // one
    std::vector<ClipRecord> clips;
    std::vector<SkinRecord> skins;
    std::vector<MaterialRecord> materials;
    std::vector<uint64_t> text_ends;  // of each string in `text`
    std::span<const char> text;
    std::vector<uint64_t> image_ends;  // of each image in `images`
    std::span<const std::byte> images;
    std::vector<MorphRecord> morphs;
};

// These are stored exactly as they are in the Character.
static_assert(sizeof(Trs<float>) == 40 && sizeof(JointTracks) == 16 && sizeof(PaletteEntry) == 52 &&
              sizeof(MeshSection) == 56 && sizeof(Lod) == 4 && sizeof(IndexRange) == 8);

// All sections in the order of their ids: calls visit(id, name, elements), or visit(id, name, elements, limit_bytes)
// for those whose size is limited.
void visit_sections(auto& records, auto& character, const auto& visit) {
    using enum SectionId;
    visit(kScalars, "scalars", records.scalars);
    visit(kClips, "clips", records.clips);
    visit(kSkins, "skins", records.skins);
    visit(kMaterials, "materials", records.materials);
    visit(kTextEnds, "text ends", records.text_ends);
    visit(kText, "text", records.text);
    visit(kImageEnds, "image ends", records.image_ends);
    visit(kImages, "images", records.images);
    visit(kParents, "parents", character.rig.parents);
    visit(kNodes, "nodes", character.rig.nodes);
    visit(kRest, "rest", character.rig.rest);
    visit(kTimes, "times", character.times_s);
    visit(kKeys, "keys", character.keys, kKeyLimit_bytes);
    visit(kWords, "words", character.words, kKeyLimit_bytes);
    visit(kRootRows, "root rows", character.root_rows, kKeyLimit_bytes);
    visit(kTracks, "tracks", character.tracks, kKeyLimit_bytes);
    visit(kPalette, "palette", character.palette);
    visit(kVertices, "vertices", character.vertices);
    visit(kInfluences, "influences", character.influences);
    visit(kIndices, "indices", character.indices);
    visit(kMeshSections, "mesh sections", character.sections);
    visit(kMorphs, "morphs", records.morphs);
    visit(kMorphDeltas, "morph deltas", character.morph_deltas, kKeyLimit_bytes);
    visit(kMorphTracks, "morph tracks", character.morph_tracks, kKeyLimit_bytes);
    visit(kMorphTimes, "morph times", character.morph_times_s);
    visit(kMorphValues, "morph values", character.morph_values, kKeyLimit_bytes);
    visit(kLods, "lods", character.lods);
    visit(kLodRanges, "lod ranges", character.lod_ranges);
    visit(kLodIndices, "lod indices", character.lod_indices);
    visit(kJointLods, "joint lods", character.joint_lods);
}

// T or const T.
template <class U, class T>
concept Either = std::same_as<std::remove_const_t<U>, T>;

// Calls visit(stored, value) for each field of a record and the value that it stores, or visit(stored, value, name) if
// not every number is a valid value.
void visit_fields(Either<ScalarsRecord> auto& record, auto& character, const auto& visit) {
    visit(record.mean_depth, character.rig.mean_depth);
    visit(record.level_count, character.rig.level_count);
    visit(record.leaf_count, character.rig.leaf_count);
    visit(record.uniform_scale, character.rig.uniform_scale, "uniform_scale");
    visit(record.packed, character.packed, "packed");
    visit(record.bounds_min, character.bounds_min);
    visit(record.bounds_max, character.bounds_max);
    visit(record.size, character.size);
}
void visit_fields(Either<ClipRecord> auto& record, auto& clip, const auto& visit) {
    visit(record.duration_s, clip.duration_s);
    visit(record.first_time, clip.first_time);
    visit(record.row_count, clip.row_count);
    visit(record.row_stride, clip.row_stride);
    visit(record.first_row, clip.first_row);
    visit(record.channel_count, clip.channel_count);
    visit(record.animated_track_count, clip.animated_track_count);
    visit(record.refined_row_count, clip.refined_row_count);
    visit(record.dropped_row_count, clip.dropped_row_count);
    visit(record.first_root_row, clip.first_root_row);
    visit(record.root_row_count, clip.root_row_count);
    visit(record.first_morph_time, clip.first_morph_time);
    visit(record.morph_row_count, clip.morph_row_count);
    visit(record.morph_row_stride, clip.morph_row_stride);
    visit(record.source_key_count, clip.source_key_count);
    visit(record.size_bytes, clip.size_bytes);
    visit(record.raw_size_bytes, clip.raw_size_bytes);
    visit(record.error, clip.error);
    visit(record.bounds_min, clip.bounds_min);
    visit(record.bounds_max, clip.bounds_max);
}
void visit_fields(Either<MaterialRecord> auto& record, auto& material, const auto& visit) {
    visit(record.base_color, material.base_color);
    visit(record.image, material.image);
    visit(record.alpha_mode, material.alpha_mode, "alpha_mode");
    visit(record.alpha_cutoff, material.alpha_cutoff);
    visit(record.double_sided, material.double_sided, "double_sided");
    visit(record.filter, material.filter, "filter");
    visit(record.wrap_u, material.wrap_u, "wrap_u");
    visit(record.wrap_v, material.wrap_v, "wrap_v");
    visit(record.metallic, material.metallic);
    visit(record.roughness, material.roughness);
    visit(record.metallic_roughness_image, material.metallic_roughness_image);
    visit(record.normal_image, material.normal_image);
    visit(record.occlusion_image, material.occlusion_image);
    visit(record.emissive_image, material.emissive_image);
    visit(record.normal_scale, material.normal_scale);
    visit(record.occlusion_strength, material.occlusion_strength);
    visit(record.emissive, material.emissive);
}
void visit_fields(Either<SkinRecord> auto& record, auto& skin, const auto& visit) {
    visit(record.first_entry, skin.first_entry);
    visit(record.joint_count, skin.joint_count);
}
void visit_fields(Either<MorphRecord> auto& record, auto& morph, const auto& visit) {
    visit(record.node, morph.node);
    visit(record.target, morph.target);
    visit(record.default_weight, morph.default_weight);
}

constexpr uint64_t aligned(uint64_t offset_bytes) { return rounded_up(offset_bytes, kAlignment_bytes); }

// Calls visit(string) for each string, in the order in which they follow one another in the section of text.
template <class C, class Visit>
void visit_strings(C& character, const Visit& visit) {
    visit(character.name);
    for (auto& name : character.rig.names) visit(name);
    for (auto& clip : character.clips) visit(clip.name);
    for (auto& skin : character.skins) visit(skin.name);
    for (auto& material : character.materials) visit(material.name);
    for (auto& image : character.images) visit(image.name);
    for (auto& morph : character.morphs) visit(morph.name);
    for (auto& name : character.section_names) visit(name);
    for (auto& warning : character.warnings) visit(warning);
}

}  // namespace throng::file
