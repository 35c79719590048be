// The bytes of a compiled character's file. docs/file_format.md describes them; kVersion grows with every change of
// either.
#pragma once

#include <throng/character.h>

#include <array>
#include <bit>
#include <string_view>
#include <type_traits>

namespace throng::file {

static_assert(std::endian::native == std::endian::little,
              "compiled files are little-endian, and their arrays are used as they are");

// As PNG's: no text begins with such a byte, and a transfer that rewrites line ends spoils it ("PNG Specification",
// second edition, 5.2).
inline constexpr std::array<char, 8> kMagic{'\x89', 't', 'h', 'r', 'o', 'n', 'g', '\n'};
inline constexpr uint32_t kVersion = 2;
inline constexpr uint64_t kAlignment_bytes = 16;  // of sections

struct Header {
    std::array<char, 8> magic = kMagic;
    uint32_t version = kVersion;
    uint32_t section_count = 0;
    uint64_t size_bytes = 0;  // of the file
    uint64_t checksum = 0;    // crc64() of all of the file but these eight bytes
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
    kImages,  // records of their own
    // As the Character has them
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
    kMorphs,  // records of their own
    kMorphDeltas,
    kMorphTracks,
    kMorphTimes,
    kMorphValues,  // as the Character has them
    kLods,
    kLodRanges,
    kLodIndices,
    kJointLods,
};

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

// Of a Clip, all but its name.
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
    uint32_t double_sided = 0;  // 0 or 1
    float metallic = 0, roughness = 0;
    uint32_t metallic_roughness_image = kNone, normal_image = kNone, occlusion_image = kNone, emissive_image = kNone;
    float normal_scale = 0, occlusion_strength = 0;
    std::array<float, 3> emissive{};
};
static_assert(sizeof(MaterialRecord) == 76);

// Of a Morph, all but its name.
struct MorphRecord {
    uint32_t node = 0, target = 0;
    float default_weight = 0;
};
static_assert(sizeof(MorphRecord) == 12);

// Of what is stored as the Character has it.
static_assert(sizeof(Trs<float>) == 40 && sizeof(JointTracks) == 16 && sizeof(PaletteEntry) == 52 &&
              sizeof(MeshSection) == 52 && sizeof(Lod) == 4 && sizeof(IndexRange) == 8);

struct SectionKind {
    std::string_view name;
    uint32_t element_bytes;
};
inline constexpr std::array<SectionKind, 30> kSections{{{"scalars", sizeof(ScalarsRecord)},
                                                        {"clips", sizeof(ClipRecord)},
                                                        {"skins", sizeof(SkinRecord)},
                                                        {"materials", sizeof(MaterialRecord)},
                                                        {"text ends", 8},
                                                        {"text", 1},
                                                        {"image ends", 8},
                                                        {"images", 1},
                                                        {"parents", 4},
                                                        {"nodes", 4},
                                                        {"rest", sizeof(Trs<float>)},
                                                        {"times", 4},
                                                        {"keys", 16},
                                                        {"words", 4},
                                                        {"root rows", 16},
                                                        {"tracks", sizeof(JointTracks)},
                                                        {"palette", sizeof(PaletteEntry)},
                                                        {"vertices", sizeof(Vertex)},
                                                        {"influences", sizeof(Influences)},
                                                        {"indices", 4},
                                                        {"mesh sections", sizeof(MeshSection)},
                                                        {"morphs", sizeof(MorphRecord)},
                                                        {"morph deltas", sizeof(MorphDelta)},
                                                        {"morph tracks", 4},
                                                        {"morph times", 4},
                                                        {"morph values", 4},
                                                        {"lods", sizeof(Lod)},
                                                        {"lod ranges", sizeof(IndexRange)},
                                                        {"lod indices", 4},
                                                        {"joint lods", 4}}};
static_assert(kSections.size() == static_cast<size_t>(SectionId::kJointLods) + 1);

constexpr uint64_t aligned(uint64_t offset_bytes) {
    return (offset_bytes + kAlignment_bytes - 1) / kAlignment_bytes * kAlignment_bytes;
}

// Calls visit(id, array) for each array that is stored as it is, in the order of the ids: those before the morphs, and
// those behind.
template <class C, class Visit>
void visit_arrays(C& character, const Visit& visit) {
    visit(SectionId::kParents, character.rig.parents);
    visit(SectionId::kNodes, character.rig.nodes);
    visit(SectionId::kRest, character.rig.rest);
    visit(SectionId::kTimes, character.times_s);
    visit(SectionId::kKeys, character.keys);
    visit(SectionId::kWords, character.words);
    visit(SectionId::kRootRows, character.root_rows);
    visit(SectionId::kTracks, character.tracks);
    visit(SectionId::kPalette, character.palette);
    visit(SectionId::kVertices, character.vertices);
    visit(SectionId::kInfluences, character.influences);
    visit(SectionId::kIndices, character.indices);
    visit(SectionId::kMeshSections, character.sections);
}
template <class C, class Visit>
void visit_later_arrays(C& character, const Visit& visit) {
    visit(SectionId::kMorphDeltas, character.morph_deltas);
    visit(SectionId::kMorphTracks, character.morph_tracks);
    visit(SectionId::kMorphTimes, character.morph_times_s);
    visit(SectionId::kMorphValues, character.morph_values);
    visit(SectionId::kLods, character.lods);
    visit(SectionId::kLodRanges, character.lod_ranges);
    visit(SectionId::kLodIndices, character.lod_indices);
    visit(SectionId::kJointLods, character.joint_lods);
}

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
    for (auto& warning : character.warnings) visit(warning);
}

}  // namespace throng::file
