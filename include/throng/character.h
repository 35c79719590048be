// A compiled character: the rig, the clips as rows of keys, the skin palette and the mesh, in the layout that the GPU reads.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace throng {

// The joints that matter: all joints of all skins, their ancestors, and the animated nodes that carry a mesh, numbered
// so that a parent comes before its children (depth first). Static nodes between them are folded into their children where
// that is exact. A rig may have several roots.
struct Rig {
    std::vector<std::string> names;        // [joint_count]
    std::vector<uint32_t> parents;         // [joint_count], parents[j] < j, or kNone
    std::vector<uint32_t> nodes;           // [joint_count], AssetNode of each joint
    std::vector<Trs<float>> rest;          // [joint_count], parent_from_joint of the rest pose
    uint32_t level_count = 0;              // joints on the longest path from a root, both ends included
    double mean_depth = 0;                 // mean over joints of the joints on the path from the root, both included
    uint32_t leaf_count = 0;               // joints without children
    bool uniform_scale = false;            // in the rest pose and all clips every scale is the same along x, y and z

    uint32_t joint_count() const { return static_cast<uint32_t>(parents.size()); }
};

// Where a joint's three tracks lie in Character::keys. Each word is a position in float4s, plus the flags:
// kTrackAnimated: the key of row r is at position + r * Clip::column_count; without it, the position is the one value.
// kTrackStep: the value of the earlier row holds until the next one.
struct JointTracks {
    uint32_t rotation = 0, translation = 0, scale = 0, unused = 0;
};
inline constexpr uint32_t kTrackAnimated = 0x80000000u;
inline constexpr uint32_t kTrackStep = 0x40000000u;
inline constexpr uint32_t kTrackPosition = 0x3FFFFFFFu;

// Keys of a clip are rows over one time axis, the union of the key times of its tracks; consecutive rotations of a
// track lie in the same hemisphere. Between rows: slerp for rotations, lerp for translations and scales. Two keys half a turn
// apart have a row between them, so that rounding cannot change the side on which the arc runs.
struct Clip {
    std::string name;
    float duration_s = 0;
    uint32_t first_time = 0;    // of its times in Character::times_s
    uint32_t row_count = 0;     // at least 1
    uint32_t column_count = 0;  // animated tracks

    uint32_t channel_count = 0;      // of the file: translation, rotation, scale
    uint64_t source_key_count = 0;   // keys of these channels
    uint32_t refined_row_count = 0;  // rows added so that cubic tracks stay within 1e-6 of the character's size
    uint32_t dropped_row_count = 0;  // rows of the union left out, because the others reproduce them within that bound
    uint64_t size_bytes = 0;         // keys, times and track table
};

// One skin matrix of a character: model_from_joint(joint) * joint_from_bind.
struct PaletteEntry {
    uint32_t joint = 0;
    Affine joint_from_bind;  // the file's inverse bind matrix; for a rigid mesh, joint_from_mesh
};

// A skin of the file: joint k of the file is palette entry first_entry + k.
struct Skin {
    std::string name;
    uint32_t first_entry = 0;
    uint32_t joint_count = 0;
};

// 32 bytes. Shared with the shaders (src/skin/skin_io.h has the same layout).
struct Vertex {
    Vec3<float> position;           // bind space of the mesh
    uint32_t normal_octahedral = 0; // two signed 16-bit fractions
    std::array<float, 2> texcoord{};
    uint32_t color = 0xFFFFFFFFu;   // linear, four unsigned bytes, red lowest
    uint32_t unused = 0;
};
static_assert(sizeof(Vertex) == 32);

// Four influences of a vertex; a vertex of a primitive with 8 has two of them, one after the other. 24 bytes.
struct Influences {
    std::array<float, 4> weights{};   // all influences of a vertex sum to 1
    std::array<uint16_t, 4> entries{};  // palette entries
};
static_assert(sizeof(Influences) == 24);

// A primitive of the file, as one draw.
struct MeshSection {
    uint32_t node = 0, mesh = 0, primitive = 0;  // of the file
    uint32_t skin = kNone;                       // kNone: rigid
    uint32_t first_vertex = 0, vertex_count = 0; // in the file's vertex order
    uint32_t first_influences = 0;               // of Character::influences
    uint32_t influence_sets = 1;                 // Influences per vertex
    uint32_t first_index = 0, index_count = 0;
    uint32_t material = kNone;
};

struct Character {
    std::string name;
    Rig rig;
    std::vector<Clip> clips;
    std::vector<float> times_s;                  // of all clips, each clip's ascending
    std::vector<std::array<float, 4>> keys;      // rest pose (3 * joint_count), then each clip's constants and rows
    std::vector<JointTracks> tracks;             // [clip_count + 1][joint_count]; the last row is the rest pose
    std::vector<Skin> skins;
    std::vector<PaletteEntry> palette;
    std::vector<Vertex> vertices;
    std::vector<Influences> influences;
    std::vector<uint32_t> indices;               // relative to the section's first vertex
    std::vector<MeshSection> sections;
    std::vector<AssetMaterial> materials;
    std::vector<AssetImage> images;
    Vec3<float> bounds_min, bounds_max;          // of the mesh in the rest pose, model space
    float size = 0;                              // diagonal of these bounds (1 where they are a point): the unit of every error bound
    uint32_t morph_target_count = 0;             // of the file; not animated
    std::vector<std::string> warnings;           // of the file and of the compilation, a line each

    // Index of the clip with this name, or kNone.
    uint32_t find_clip(std::string_view clip_name) const;
};

// Limits: 65,535 joints; 65,536 palette entries; 256 MiB of keys. Errors: kUnsupported (nothing to animate), kLimit.
Result<Character> compile_character(const Asset& asset);

// load_asset() and compile_character() in one.
Result<Character> load_character(const std::filesystem::path& path);

}  // namespace throng
