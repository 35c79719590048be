// Maliciously crafted compiled files: none makes a stage read outside its buffers.
#include "tests/host/character_file_cases.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace throng {
namespace {

using namespace test;
using namespace file;

// Whether every address that the stages compute (control.glsl, exact.glsl, packed.glsl, bind, skin.glsl,
// character.vert) is inside its array. Implemented independently, following the shaders.
bool all_addresses_in_bounds(const Character& c) {
    bool good = true;
    const auto need = [&](uint64_t index, size_t size) { good = good && index < size; };
    const uint32_t joint_count = c.rig.joint_count();
    for (uint32_t clip = 0; clip <= c.clips.size(); ++clip) {
        const bool is_rest = clip == c.clips.size();
        const uint32_t first_time = is_rest ? 0 : c.clips[clip].first_time,
                       row_count = is_rest ? 1 : c.clips[clip].row_count;
        if (!is_rest) need(uint64_t{first_time} + row_count - 1, c.times_s.size());
        if (!is_rest && c.clips[clip].root_row_count > 0)
            need(uint64_t{c.clips[clip].first_root_row} + c.clips[clip].root_row_count - 1, c.root_rows.size());
        for (uint32_t row = 0; good && row < row_count; ++row) {
            const uint64_t cursor = is_rest ? 0 : c.clips[clip].first_row + uint64_t{row} * c.clips[clip].row_stride;
            for (uint32_t joint = 0; joint < joint_count; ++joint) {
                const uint64_t index = uint64_t{clip} * joint_count + joint;
                need(index, c.tracks.size());
                if (!good) return false;
                for (const uint32_t word :
                     {c.tracks[index].rotation, c.tracks[index].translation, c.tracks[index].scale}) {
                    if (!c.packed) {
                        need((word & 0x3FFFFFFF) + (word & 0x80000000 ? cursor : 0), c.keys.size());
                        continue;
                    }
                    need(word, c.keys.size());
                    if (!good) return false;
                    uint32_t head = 0, tail = 0;
                    std::memcpy(&head, &c.keys[word][3], 4);
                    const bool is_constant = (head & 0x7FFF) == 0;
                    if (!is_constant) need(uint64_t{word} + 1, c.keys.size());
                    if (!good) return false;
                    if (!is_constant) std::memcpy(&tail, &c.keys[word + 1][3], 4);
                    need((is_constant ? 0 : cursor + (tail >> 5)) + 2, c.words.size());
                }
            }
        }
    }
    for (uint32_t joint = 0; joint < joint_count; ++joint)
        good = good && (c.rig.parents[joint] == kNone || c.rig.parents[joint] < joint);
    for (const PaletteEntry& entry : c.palette) need(entry.joint, joint_count);
    for (const Skin& skin : c.skins)
        if (skin.joint_count > 0) need(uint64_t{skin.first_entry} + skin.joint_count - 1, c.palette.size());
    for (const MeshSection& section : c.sections) {
        for (uint64_t i = 0; good && i < section.index_count; ++i) {
            need(section.first_index + i, c.indices.size());
            if (good) need(c.indices[section.first_index + i], section.vertex_count);
        }
        for (uint64_t v = 0; good && v < section.vertex_count; ++v) {
            need(section.first_vertex + v, c.vertices.size());
            if (good && section.morph_count > 0 && c.vertices[section.first_vertex + v].first_delta > 0)
                need(uint64_t{c.vertices[section.first_vertex + v].first_delta} - 1 + section.morph_count - 1,
                     c.morph_deltas.size());
            for (uint64_t set = 0; good && set < section.influence_sets; ++set) {
                const uint64_t at = section.first_influences + v * section.influence_sets + set;
                need(at, c.influences.size());
                if (good)
                    for (const uint16_t entry : c.influences[at].entries) need(entry, c.palette.size());
            }
        }
        if (section.skin != kNone) need(section.skin, c.skins.size());
        if (section.material != kNone) need(section.material, c.materials.size());
    }
    for (uint32_t clip = 0; good && clip < c.clips.size(); ++clip) {
        const Clip& of = c.clips[clip];
        if (of.morph_row_count > 0)
            need(uint64_t{of.first_morph_time} + of.morph_row_count - 1, c.morph_times_s.size());
        for (size_t morph = 0; good && morph < c.morphs.size(); ++morph) {
            need(clip * c.morphs.size() + morph, c.morph_tracks.size());
            if (!good) return false;
            const uint32_t word = c.morph_tracks[clip * c.morphs.size() + morph];
            if (word != 0xFFFFFFFF)
                need((word & 0x3FFFFFFF) + (word & 0x80000000 && of.morph_row_count > 0
                                                ? (of.morph_row_count - uint64_t{1}) * of.morph_row_stride
                                                : 0),
                     c.morph_values.size());
        }
    }
    for (const AssetMaterial& material : c.materials)
        visit_images([&](auto member) {
            if (material.*member != kNone) need(material.*member, c.images.size());
        });
    return good;
}

struct Crafted {
    const char* what;
    std::function<void(Forged&)> change;
    std::string named;  // the message must contain it
};

void expect_refused(double error, const std::vector<Crafted>& cases) {
    const Bytes bytes = small_file(error);
    for (const Crafted& crafted : cases) {
        Forged forged(bytes);
        crafted.change(forged);
        const Result<Character> result = load(forged.sealed());
        EXPECT_FALSE(result) << crafted.what;
        if (result) continue;
        const std::string text = result.error().text();
        EXPECT_TRUE(text.starts_with("small.throng: ") && text.find(crafted.named) != text.npos &&
                    text.find('\n') == text.npos)
            << crafted.what << ": " << text;
    }
}

constexpr uint32_t kAllOnes = 0xFFFFFFFFu;
constexpr uint64_t kMax64 = ~uint64_t{0};

TEST(CharacterFile, ACraftedTableIsRefused) {
    using S = SectionId;
    for (const double error : kErrors)
        expect_refused(
            error,
            {
                {"no sections", [](Forged& f) { f.header().section_count = 0; }, "sections"},
                {"too many sections", [](Forged& f) { f.header().section_count = kAllOnes; }, "sections"},
                {"a section's id twice", [](Forged& f) { f.entry(S::kKeys).id = static_cast<uint32_t>(S::kTimes); },
                 "keys"},
                {"an unknown id", [](Forged& f) { f.entry(S::kMeshSections).id = 29; }, "mesh sections"},
                {"elements of 0 bytes", [](Forged& f) { f.entry(S::kKeys).element_bytes = 0; }, "keys"},
                {"elements of other bytes", [](Forged& f) { f.entry(S::kKeys).element_bytes = 4; }, "keys"},
                {"a section in the header", [](Forged& f) { f.entry(S::kScalars).offset_bytes = 0; }, "scalars"},
                {"a section behind the file", [](Forged& f) { f.entry(S::kTimes).offset_bytes = f.bytes().size(); },
                 "times"},
                {"a section at the largest offset", [](Forged& f) { f.entry(S::kTimes).offset_bytes = kMax64; },
                 "times"},
                {"two sections in one place",
                 [](Forged& f) { f.entry(S::kTracks).offset_bytes = f.entry(S::kKeys).offset_bytes; }, "tracks"},
                {"a section beside its alignment", [](Forged& f) { f.entry(S::kTracks).offset_bytes += 4; }, "tracks"},
                {"the largest size", [](Forged& f) { f.entry(S::kVertices).size_bytes = kMax64; }, "vertices"},
                {"a size beyond the file", [](Forged& f) { f.entry(S::kVertices).size_bytes = f.bytes().size(); },
                 "vertices"},
                {"a size and a count beyond the file",
                 [](Forged& f) {
                     f.entry(S::kVertices).size_bytes = 32'000'000, f.entry(S::kVertices).element_count = 1'000'000;
                 },
                 "are left"},
                {"no scalars",
                 [](Forged& f) {
                     const SectionEntry gone = f.entry(S::kScalars);
                     const auto first = f.bytes().begin() + static_cast<ptrdiff_t>(gone.offset_bytes);
                     f.bytes().erase(first, first + static_cast<ptrdiff_t>(gone.size_bytes));
                     for (uint32_t id = 1; id < kSectionCount; ++id)
                         f.entry(static_cast<SectionId>(id)).offset_bytes -= gone.size_bytes;
                     f.entry(S::kScalars).size_bytes = f.entry(S::kScalars).element_count = 0;
                     f.header().size_bytes = f.bytes().size();
                 },
                 "scalars"},
                {"another magic", [](Forged& f) { f.header().magic[3] = 'X'; }, "is not a compiled character"},
                {"a size that is no whole elements", [](Forged& f) { f.entry(S::kVertices).size_bytes -= 1; },
                 "vertices"},
                {"the largest count", [](Forged& f) { f.entry(S::kVertices).element_count = kMax64; }, "vertices"},
                {"a count whose bytes wrap around",
                 [](Forged& f) { f.entry(S::kVertices).element_count += uint64_t{1} << 59; }, "vertices"},
                {"one element fewer", [](Forged& f) { f.entry(S::kIndices).element_count -= 1; }, "indices"},
                {"a size and a count of fewer elements",
                 [](Forged& f) {
                     f.entry(S::kMorphValues).element_count -= 1, f.entry(S::kMorphValues).size_bytes -= sizeof(float);
                 },
                 "lods"},
                {"padding that is not zero",
                 [](Forged& f) {
                     f.bytes()[f.entry(S::kImages).offset_bytes + f.entry(S::kImages).size_bytes] = std::byte{1};
                 },
                 "parents"},
                {"text ends that go back", [](Forged& f) { f.at<uint64_t>(S::kTextEnds, 1) = 0; }, "text ends"},
                {"a text end beyond the text", [](Forged& f) { f.at<uint64_t>(S::kTextEnds, -1) = kMax64; },
                 "text ends"},
                {"a text end before the text's", [](Forged& f) { f.at<uint64_t>(S::kTextEnds, -1) -= 1; }, "text ends"},
                {"an image end beyond the images", [](Forged& f) { f.at<uint64_t>(S::kImageEnds, 1) = kMax64; },
                 "image ends"},
                {"image ends that go back", [](Forged& f) { f.at<uint64_t>(S::kImageEnds, 0) = 34; }, "image ends"},
            });
}

TEST(CharacterFile, CraftedContentIsRefused) {
    using S = SectionId;
    for (const double error : kErrors)
        expect_refused(
            error,
            {
                {"more warnings than strings",
                 [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).warning_count = kAllOnes; }, "strings"},
                {"fewer warnings than strings", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).warning_count = 0; },
                 "strings"},
                {"a truth value of 2", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).packed = 2; }, "packed"},
                {"a truth value of all bits",
                 [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).uniform_scale = kAllOnes; }, "uniform_scale"},
                {"what is reserved", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).reserved[1] = 1; }, "reserved"},
                {"more levels than joints", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).level_count = kAllOnes; },
                 "levels"},
                {"no leaves", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).leaf_count = 0; }, "leaves"},
                {"a mean depth that is no number",
                 [](Forged& f) {
                     f.at<ScalarsRecord>(S::kScalars).mean_depth = std::numeric_limits<double>::quiet_NaN();
                 },
                 "mean depth"},
                {"bounds inside out", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).bounds_min.x = 1e30f; },
                 "bounds"},
                {"bounds that are not finite",
                 [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).bounds_max.y = kInfinity; }, "bounds"},
                {"bounds wider than any number",
                 [](Forged& f) {
                     f.at<ScalarsRecord>(S::kScalars).bounds_min.x = -3e38f,
                     f.at<ScalarsRecord>(S::kScalars).bounds_max.x = 3e38f;
                 },
                 "bounds"},
                {"no size", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).size = 0; }, "size"},
                {"a size that is no number", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).size = kNan; }, "size"},

                {"a joint its own parent", [](Forged& f) { f.at<uint32_t>(S::kParents, 2) = 2; }, "parents[2]"},
                {"a parent after its child", [](Forged& f) { f.at<uint32_t>(S::kParents, 1) = 3; }, "parents[1]"},
                {"a parent beyond the joints", [](Forged& f) { f.at<uint32_t>(S::kParents, -1) = kAllOnes - 1; },
                 "parents[3]"},
                {"a rest pose that is not finite", [](Forged& f) { f.at<Trs<float>>(S::kRest, 1).scale.z = kNan; },
                 "rest[1]"},

                {"a clip without rows", [](Forged& f) { f.at<ClipRecord>(S::kClips).row_count = 0; }, "clips[0]"},
                {"a clip of most rows", [](Forged& f) { f.at<ClipRecord>(S::kClips).row_count = kAllOnes; },
                 "clips[0]"},
                {"a clip of one more row", [](Forged& f) { f.at<ClipRecord>(S::kClips, -1).row_count += 1; },
                 "clips[1]"},
                {"a clip whose times are another's", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_time = 0; },
                 "clips[1]"},
                {"a clip whose times begin behind all",
                 [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_time = kAllOnes; }, "clips[1]"},
                {"the largest stride", [](Forged& f) { f.at<ClipRecord>(S::kClips).row_stride = kAllOnes; },
                 "clips[0]"},
                {"a stride that wraps around", [](Forged& f) { f.at<ClipRecord>(S::kClips).row_stride = 0x80000000u; },
                 "clips[0]"},
                {"rows that begin behind all", [](Forged& f) { f.at<ClipRecord>(S::kClips).first_row = kAllOnes; },
                 "clips[0]"},
                {"a negative duration", [](Forged& f) { f.at<ClipRecord>(S::kClips).duration_s = -1; }, "duration"},
                {"a duration without end", [](Forged& f) { f.at<ClipRecord>(S::kClips).duration_s = kInfinity; },
                 "duration"},
                {"an error that is no number",
                 [](Forged& f) { f.at<ClipRecord>(S::kClips).error = std::numeric_limits<double>::quiet_NaN(); },
                 "error"},
                {"bounds of a clip that are wider than any number",
                 [](Forged& f) {
                     f.at<ClipRecord>(S::kClips).bounds_min.z = -3e38f,
                     f.at<ClipRecord>(S::kClips).bounds_max.z = 3e38f;
                 },
                 "clips[0]"},
                {"a time that is no number", [](Forged& f) { f.at<float>(S::kTimes, 1) = kNan; }, "times[1]"},
                {"a negative time", [](Forged& f) { f.at<float>(S::kTimes, 0) = -1; }, "times[0]"},
                {"a time without end", [](Forged& f) { f.at<float>(S::kTimes, -1) = kInfinity; }, "times["},
                {"two rows at one time", [](Forged& f) { f.at<float>(S::kTimes, 1) = f.at<float>(S::kTimes, 0); },
                 "times[1]"},

                {"root motion behind its rows", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).root_row_count += 1; },
                 "clips[1]"},
                {"root motion of most rows", [](Forged& f) { f.at<ClipRecord>(S::kClips).root_row_count = kAllOnes; },
                 "clips[0]"},
                {"root motion of one row", [](Forged& f) { f.at<ClipRecord>(S::kClips).root_row_count = 1; },
                 "clips[0]"},
                {"root motion left out",
                 [](Forged& f) {
                     f.at<ClipRecord>(S::kClips, 1).root_row_count = f.at<ClipRecord>(S::kClips, 1).first_root_row = 0;
                 },
                 "root rows"},
                {"root motion of another clip", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_root_row = 0; },
                 "clips[1]"},
                {"the largest row of root motion",
                 [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_root_row = kAllOnes; }, "clips[1]"},
                {"a place that is not finite",
                 [](Forged& f) { f.at<std::array<float, 4>>(S::kRootRows, 1)[0] = kInfinity; }, "root rows[1]"},
                {"a turn that is no number", [](Forged& f) { f.at<std::array<float, 4>>(S::kRootRows, 4)[3] = kNan; },
                 "root rows[4]"},
                {"a turn of another length", [](Forged& f) { f.at<std::array<float, 4>>(S::kRootRows, 1)[2] = 0.802f; },
                 "root rows[1]"},

                {"a rest pose behind the keys",
                 [](Forged& f) {
                     f.at<JointTracks>(S::kTracks, -1).rotation = static_cast<uint32_t>(
                         f.entry(S::kKeys).element_count);
                 },
                 "tracks[11]"},
                {"the largest position", [](Forged& f) { f.at<JointTracks>(S::kTracks, 0).rotation = kTrackPosition; },
                 "tracks[0]"},
                {"all bits of a track", [](Forged& f) { f.at<JointTracks>(S::kTracks, 5).translation = kAllOnes; },
                 "tracks[5]"},
                {"a scale behind the keys",
                 [](Forged& f) {
                     f.at<JointTracks>(S::kTracks, 5).scale = static_cast<uint32_t>(f.entry(S::kKeys).element_count);
                 },
                 "tracks[5]"},
                {"an animated rest pose", [](Forged& f) { f.at<JointTracks>(S::kTracks, -1).scale |= kTrackAnimated; },
                 "tracks[11]"},

                {"a palette entry of no joint", [](Forged& f) { f.at<PaletteEntry>(S::kPalette, 1).joint = 4; },
                 "palette[1]"},
                {"a palette entry of the largest joint",
                 [](Forged& f) { f.at<PaletteEntry>(S::kPalette, 0).joint = kAllOnes; }, "palette[0]"},
                {"an inverse bind that is not finite",
                 [](Forged& f) { f.at<PaletteEntry>(S::kPalette, 0).joint_from_bind.row[1][2] = kInfinity; },
                 "palette[0]"},
                {"a skin behind the palette", [](Forged& f) { f.at<SkinRecord>(S::kSkins).first_entry = kAllOnes; },
                 "skins[0]"},
                {"a skin larger than the palette", [](Forged& f) { f.at<SkinRecord>(S::kSkins).joint_count = 5; },
                 "skins[0]"},
                {"a skin whose end wraps around",
                 [](Forged& f) {
                     f.at<SkinRecord>(S::kSkins).first_entry = 2, f.at<SkinRecord>(S::kSkins).joint_count = kAllOnes;
                 },
                 "skins[0]"},

                {"an index of no vertex", [](Forged& f) { f.at<uint32_t>(S::kIndices, 0) = 6; }, "indices[0]"},
                {"the largest index", [](Forged& f) { f.at<uint32_t>(S::kIndices, -1) = kAllOnes; }, "indices["},
                {"an influence of no palette entry",
                 [](Forged& f) { f.at<Influences>(S::kInfluences, 3).entries[2] = 4; }, "influences[3]"},
                {"a negative weight", [](Forged& f) { f.at<Influences>(S::kInfluences, 2).weights[1] = -0.25f; },
                 "influences[2]"},
                {"the largest palette entry",
                 [](Forged& f) { f.at<Influences>(S::kInfluences, -1).entries[3] = 0xFFFF; }, "influences["},
                {"a weight that is no number", [](Forged& f) { f.at<Influences>(S::kInfluences, 0).weights[0] = kNan; },
                 "influences[0]"},
                {"a vertex that is not finite", [](Forged& f) { f.at<Vertex>(S::kVertices, 2).position.y = kInfinity; },
                 "vertices[2]"},
                {"a section of another's vertices",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).first_vertex = 0; }, "mesh sections[1]"},
                {"a section of most vertices",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).vertex_count = kAllOnes; }, "mesh sections[0]"},
                {"a section of one vertex fewer",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).vertex_count -= 1; }, "indices"},
                {"a section of more vertices of levels than vertices",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).lod_vertex_count = kAllOnes; },
                 "mesh sections[0]: lod_vertex_count is 4294967295"},
                {"a section whose triangles have vertices of levels",
                 [](Forged& f) {
                     MeshSection& section = f.at<MeshSection>(S::kMeshSections, 0);
                     section.lod_vertex_count = section.vertex_count;
                 },
                 "indices["},
                {"a section of another's influences",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).first_influences = kAllOnes; },
                 "mesh sections[1]"},
                {"a section without influences",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).influence_sets = 0; }, "mesh sections[0]"},
                {"most sets of influences",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).influence_sets = kAllOnes; },
                 "mesh sections[0]"},
                {"one set of influences more",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).influence_sets += 1; }, "mesh sections[1]"},
                {"a section of another's indices",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).first_index = 0; }, "mesh sections[1]"},
                {"most indices", [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).index_count = kAllOnes; },
                 "mesh sections[0]"},
                {"indices that make no triangles",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).index_count -= 1; }, "mesh sections[1]"},
                {"a triangle left out", [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).index_count -= 3; },
                 "mesh sections"},
                {"a section of no skin", [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).skin = 1; },
                 "mesh sections[0]"},
                {"a section of no material", [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).material = 3; },
                 "mesh sections[0]"},
                {"a section of no morph", [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 1).morph_count += 1; },
                 "mesh sections[1]"},
                {"morphs whose end wraps around",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).first_morph = kAllOnes; }, "mesh sections[0]"},
                {"a section whose morphs are gone",
                 [](Forged& f) { f.at<MeshSection>(S::kMeshSections, 0).morph_count = 0; }, "its section has none"},
                {"a default weight that is no number",
                 [](Forged& f) { f.at<MorphRecord>(S::kMorphs, 1).default_weight = kNan; }, "morphs[1]"},
                {"differences behind all",
                 [](Forged& f) {
                     f.at<Vertex>(S::kVertices, 0).first_delta = static_cast<uint32_t>(
                         f.entry(S::kMorphDeltas).element_count);
                 },
                 "vertices[0]"},
                {"the largest difference", [](Forged& f) { f.at<Vertex>(S::kVertices, -1).first_delta = kAllOnes; },
                 "vertices[11]"},
                {"a difference that is not finite",
                 [](Forged& f) { f.at<MorphDelta>(S::kMorphDeltas, 1).position.y = kInfinity; }, "morph deltas[1]"},
                {"weights behind all",
                 [](Forged& f) {
                     f.at<uint32_t>(S::kMorphTracks, 0) = static_cast<uint32_t>(f.entry(S::kMorphValues).element_count);
                 },
                 "morph tracks[0]"},
                {"rows of weights behind all",
                 [](Forged& f) {
                     f.at<uint32_t>(S::kMorphTracks,
                                    0) = static_cast<uint32_t>(f.entry(S::kMorphValues).element_count - 1) |
                                         kTrackAnimated,
                                    f.at<ClipRecord>(S::kClips).morph_row_stride = 1;
                 },
                 "morph tracks[0]"},
                {"the largest stride of weights",
                 [](Forged& f) { f.at<ClipRecord>(S::kClips).morph_row_stride = kAllOnes; }, "morph tracks["},
                {"weights that tracks share", [](Forged& f) { f.at<ClipRecord>(S::kClips).morph_row_stride = 0; },
                 "share weights"},
                {"rows of weights of another clip",
                 [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_morph_time = kAllOnes; }, "clips[1]"},
                {"one row of weights more", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).morph_row_count += 1; },
                 "clips[1]"},
                {"a weight without end", [](Forged& f) { f.at<float>(S::kMorphValues, -1) = kInfinity; },
                 "morph values["},
                {"a time of weights that is no number", [](Forged& f) { f.at<float>(S::kMorphTimes, 0) = kNan; },
                 "morph times[0]"},
                {"two rows of weights at one time",
                 [](Forged& f) { f.at<float>(S::kMorphTimes, 1) = f.at<float>(S::kMorphTimes, 0); }, "morph times[1]"},
                {"a material of no image", [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).image = 2; },
                 "materials[0]"},
                {"an emission of no image",
                 [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).emissive_image = 2; }, "materials[0]"},
                {"a roughness that is no number",
                 [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 2).roughness = kNan; }, "materials[2]"},
                {"a name of two lines", [](Forged& f) { f.at<char>(S::kText, 0) = '\n'; }, "control characters"},
                {"a warning that rewrites the terminal", [](Forged& f) { f.at<char>(S::kText, -1) = '\x1B'; },
                 "control characters"},
                {"an unknown alpha mode", [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).alpha_mode = 3; },
                 "alpha_mode"},
                {"a side too many", [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).double_sided = 2; },
                 "double_sided"},
                {"a filter too many", [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).filter = 2; }, "filter"},
                {"a wrap too many", [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 0).wrap_v = 3; }, "wrap_v"},
                {"a colour that is not finite",
                 [](Forged& f) { f.at<MaterialRecord>(S::kMaterials, 1).base_color[3] = kNan; }, "materials[1]"},
            });
}

// The first track that has rows, as it is in the file.
struct FirstTrack {
    static JointTracks& tracks(Forged& f) {
        for (int64_t i = 0; i < 8; ++i)
            if (is_animated(f, f.at<JointTracks>(SectionId::kTracks, i).rotation))
                return f.at<JointTracks>(SectionId::kTracks, i);
        ADD_FAILURE() << "no rotation is animated";
        return f.at<JointTracks>(SectionId::kTracks);
    }
    static bool is_animated(Forged& f, uint32_t word) {
        if (f.at<ScalarsRecord>(SectionId::kScalars).packed == 0) return (word & kTrackAnimated) != 0;
        return (f.at<std::array<uint32_t, 4>>(SectionId::kKeys, word)[3] & 0x7FFF) != 0;
    }
    static std::array<uint32_t, 4>& head(Forged& f) {
        return f.at<std::array<uint32_t, 4>>(SectionId::kKeys, tracks(f).rotation);
    }
    static std::array<uint32_t, 4>& tail(Forged& f) {
        return f.at<std::array<uint32_t, 4>>(SectionId::kKeys, tracks(f).rotation + int64_t{1});
    }
};

TEST(CharacterFile, CraftedExactTracksAreRefused) {
    using S = SectionId;
    expect_refused(
        0,
        {
            {"rows of a track beyond the keys",
             [](Forged& f) {
                 FirstTrack::tracks(f).rotation = static_cast<uint32_t>(f.entry(S::kKeys).element_count - 1) |
                                                  kTrackAnimated;
             },
             "tracks["},
            {"a stride of one more",
             [](Forged& f) {
                 f.at<ClipRecord>(S::kClips, 1).row_stride += static_cast<uint32_t>(f.entry(S::kKeys).element_count /
                                                                                    2);
             },
             "[1]"},
            {"a stride of one less", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).row_stride -= 1; }, "share keys"},
            {"rows that begin later", [](Forged& f) { f.at<ClipRecord>(S::kClips, 1).first_row = 1; }, "clips[1]"},
            {"scales that are not uniform", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).uniform_scale = 1; },
             "uniform"},
            {"a key that is no number", [](Forged& f) { f.at<std::array<float, 4>>(S::kKeys, 7)[3] = kNan; },
             "keys[7]"},
            {"exact keys read as packed ones", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).packed = 1; }, "words"},
        });
}

TEST(CharacterFile, CraftedPackedTracksAreRefused) {
    using S = SectionId;
    expect_refused(
        1e-4,
        {
            {"packed keys read as exact ones", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).packed = 0; }, ""},
            {"a clip whose rows reach the words behind",
             [](Forged& f) { f.at<ClipRecord>(S::kClips, -1).first_row += 1; }, "clips[1]"},
            {"a stride of one word more", [](Forged& f) { f.at<ClipRecord>(S::kClips, -1).row_stride += 1; },
             "clips[1]"},
            {"a stride of no words", [](Forged& f) { f.at<ClipRecord>(S::kClips, 0).row_stride = 0; }, "a row"},
            {"a component of 31 bits", [](Forged& f) { FirstTrack::head(f)[3] |= 31; }, "31 bits"},
            {"a component of 22 bits", [](Forged& f) { FirstTrack::head(f)[3] = (FirstTrack::head(f)[3] & ~31u) | 22; },
             "22 bits"},
            {"a full rotation of other bits", [](Forged& f) { FirstTrack::head(f)[3] |= kPackedFull; }, "bits"},
            {"unknown bits of a layout", [](Forged& f) { FirstTrack::head(f)[3] |= 1u << 19; }, "unknown bits"},
            {"the highest bit of a layout", [](Forged& f) { FirstTrack::head(f)[3] |= 1u << 31; }, "unknown bits"},
            {"a track behind its row",
             [](Forged& f) { FirstTrack::tail(f)[3] = 32 * f.at<ClipRecord>(S::kClips, 0).row_stride; }, "a row"},
            {"the largest first bit", [](Forged& f) { FirstTrack::tail(f)[3] = kAllOnes; }, ""},
            {"the largest first bit of a word", [](Forged& f) { FirstTrack::tail(f)[3] = kAllOnes & ~31u; }, "a row"},
            {"tracks of the same bits",
             [](Forged& f) {
                 FirstTrack::tracks(f).translation = FirstTrack::tracks(f).rotation;
                 FirstTrack::tracks(f).scale = FirstTrack::tracks(f).rotation;
             },
             "share keys"},
            {"a minimum that is not finite",
             [](Forged& f) { f.at<std::array<float, 4>>(S::kKeys, FirstTrack::tracks(f).rotation)[0] = kInfinity; },
             "finite"},
            {"a step that is no number",
             [](Forged& f) {
                 f.at<std::array<float, 4>>(S::kKeys, FirstTrack::tracks(f).rotation + int64_t{1})[2] = kNan;
             },
             "finite"},
            {"a rest pose that is animated",
             [](Forged& f) { f.at<JointTracks>(S::kTracks, -1).rotation = FirstTrack::tracks(f).rotation; },
             "rest pose"},
            {"scales that are not uniform", [](Forged& f) { f.at<ScalarsRecord>(S::kScalars).uniform_scale = 1; },
             "uniform"},
            {"two keys where one is left",
             [](Forged& f) {
                 const auto last = static_cast<uint32_t>(f.entry(S::kKeys).element_count - 1);
                 f.at<std::array<uint32_t, 4>>(S::kKeys, last) = {0, 0, 0, 5};
                 FirstTrack::tracks(f).rotation = last;
             },
             "takes two"},
        });
}

// Changes every word of a file to extreme values. Either the file is refused, or all addresses are inside their arrays
// and poses can be computed.
TEST(CharacterFile, ChangedWordsCannotCauseAccessOutOfBounds) {
    for (const double error : kErrors) {
        const Bytes bytes = small_file(error);
        int accepted = 0, refused = 0;
        for (size_t at = sizeof(Header); at + 4 <= bytes.size(); at += 4) {
            uint32_t before = 0;
            std::memcpy(&before, bytes.data() + at, 4);
            for (const uint32_t word : {0u, 1u, 2u, before + 1, before - 1, before ^ 0x80000000u, before ^ 0x40000000u,
                                        before << 8, 0x7FFFFFFFu, 0x7F800000u, 0xFFFFFFFEu, kAllOnes}) {
                if (word == before) continue;
                Forged forged(bytes);
                std::memcpy(forged.bytes().data() + at, &word, 4);
                const Result<Character> result = load(forged.sealed());
                ++(result ? accepted : refused);
                if (!result) continue;
                ASSERT_TRUE(all_addresses_in_bounds(*result)) << "byte " << at << " is " << word;
                for (uint32_t clip = 0; clip < result->clips.size(); ++clip)
                    for (const double part : {0.0, 0.5, 1.0}) {
                        const Result<ReferencePose> pose = reference_pose(
                            *result, {.first = {clip, part * double{result->clips[clip].duration_s}, 1, false}});
                        ASSERT_TRUE(pose);
                        ASSERT_EQ(reference_positions(*result, *pose).size(), result->vertices.size());
                    }
            }
        }
        EXPECT_GT(accepted, 0);
        EXPECT_GT(refused, 1000);
    }
}

}  // namespace
}  // namespace throng
