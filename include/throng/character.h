// A compiled character: the rig, the clips as rows of keys, the skin palette and the mesh, in the layout that the GPU
// reads.
#pragma once

#include <throng/asset.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace throng {

// The joints that matter: all joints of all skins, their ancestors, and the animated nodes that carry a mesh, numbered
// so that a parent comes before its children (depth first). Static nodes between them are folded into their children
// where that is exact. A rig may have several roots.
struct Rig {
    std::vector<std::string> names{};  // [joint_count]
    std::vector<uint32_t> parents{};   // [joint_count], parents[j] < j, or kNone
    std::vector<uint32_t> nodes{};     // [joint_count], AssetNode of each joint
    std::vector<Trs<float>> rest{};    // [joint_count], parent_from_joint of the rest pose
    uint32_t level_count = 0;          // joints on the longest path from a root, both ends included
    double mean_depth = 0;             // mean over joints of the number of joints from the root to the joint, inclusive
    uint32_t leaf_count = 0;           // joints without children
    bool uniform_scale = false;        // in the rest pose and all clips every scale is the same along x, y and z

    uint32_t joint_count() const { return static_cast<uint32_t>(parents.size()); }
    // The first joint with this name, or kNone; names need not be unique. joint_named() is the same, but a missing name
    // is an error that says which there are: kInvalidArgument.
    JointIndex find_joint(std::string_view joint_name) const;
    Result<JointIndex> joint_named(std::string_view joint_name) const;
};

// Where a joint's three tracks lie in Character::keys. In a character of exact keys each word is a position, in
// float4s, and flags. With kTrackAnimated the key of row r is at position + r * Clip::row_stride; without it the only
// value is at the position. With kTrackStep the value of the earlier row holds until the next one. In a packed
// character each word is the position of a PackedTrack, without flags. No two animated tracks of a clip share keys or
// bits.
struct JointTracks {
    uint32_t rotation = 0, translation = 0, scale = 0, unused = 0;
};
inline constexpr uint32_t kTrackAnimated = 0x80000000u;
inline constexpr uint32_t kTrackStep = 0x40000000u;
inline constexpr uint32_t kTrackPosition = 0x3FFFFFFFu;

// How a track of a packed character is decoded: two float4s of Character::keys. The second is left out if the track is
// constant: no component has any bits.
// - Where: row r begins at word Clip::first_row + r * Clip::row_stride of Character::words; bits are counted from the
//   least significant one of a word. Component 0 begins at bit first_bit of the row, the others follow one another.
//   Component c has bits_c bits, at most kPackedComponentBits. All lie within 96 bits of the start of the word that
//   contains the first.
// - Values: component c (0, 1, 2; in full rotations also 3) is minimum[c] + step[c] * bits; without bits, minimum[c].
// - Translations and scales are x, y, z.
// - Rotations are unit quaternions. The quaternion's component `left_out` is not stored: it is the non-negative root of
//   1 - the others' squares. Component c is the quaternion's (left_out + 1 + c) % 4.
// - Full rotations store all four, each in kPackedFullBits with minimum -1 and step kPackedFullStep; the fourth is the
//   quaternion's component `left_out`. As with exact keys, neighbouring rows must then lie in the same hemisphere.
// - Between rows: lerp; rotations are normalised afterwards.
struct PackedTrack {
    std::array<float, 3> minimum{};
    // Bits of component 0, 1, 2: 5 bits each from bit 0; left_out: kPackedLeftOutShift; and the flags below
    uint32_t layout = 0;
    std::array<float, 3> step{};
    uint32_t first_bit = 0;
};
static_assert(sizeof(PackedTrack) == 32);
inline constexpr uint32_t kPackedComponentBits = 21;
inline constexpr uint32_t kPackedFullBits = 16;
inline constexpr float kPackedFullStep = 2.0f / ((1u << kPackedFullBits) - 1);
inline constexpr uint32_t kPackedLeftOutShift = 15;
inline constexpr uint32_t kPackedBitsMask = (1u << kPackedLeftOutShift) - 1;  // 0 under it: a constant
inline constexpr uint32_t kPackedFull = 1u << 17;
inline constexpr uint32_t kPackedStep = 1u << 18;  // the value of the earlier row holds until the next one
inline constexpr uint32_t kPackedWordsBehind = 3;  // decoding reads three words from the one in which a track begins

// Keys of a clip are rows over one time axis. Exact keys: the union of the key times of its tracks, without rows that
// interpolation of the others reproduces; consecutive rotations of a track lie in the same hemisphere; between rows
// slerp for rotations, lerp for translations and scales. Two keys half a turn apart have a row between them, so that
// rounding cannot change the side on which the arc runs. Packed keys: rows chosen so that the skin stays within the
// error bound, and read as PackedTrack says.
struct Clip {
    std::string name{};
    float duration_s = 0;
    uint32_t first_time = 0;  // index of the first of its times in Character::times_s
    uint32_t row_count = 0;   // at least 1
    // From one row of keys to the next: float4s (one for each animated track) or, in a packed character, words
    uint32_t row_stride = 0;
    uint32_t first_row = 0;  // word in which a packed clip's rows begin; exact: 0

    uint32_t channel_count = 0;         // of the file: translation, rotation, scale
    uint64_t source_key_count = 0;      // keys of these channels
    uint32_t animated_track_count = 0;  // that are not constant
    // Rows added to keep cubic tracks within 1e-6 of the character's size, and the motion that remains when root motion
    // is taken out within 1e-4
    uint32_t refined_row_count = 0;
    // Rows of the union that were left out because the others reproduce them: exact keys within 1e-6 too, packed ones
    // within the error bound
    uint32_t dropped_row_count = 0;
    uint64_t size_bytes = 0;      // keys, words, times and track table
    uint64_t raw_size_bytes = 0;  // of 10 floats (rotation, translation, scale) a joint at every row of exact keys
    // In Character::root_rows, evenly spaced over the duration, both ends included; 0: none
    uint32_t first_root_row = 0, root_row_count = 0;
    // packed: largest displacement of a skinned point against exact keys, as a fraction of the character's size; also
    // measured with one morph at weight 1
    double error = 0;
    // Rows of morph weights, on a time axis of their own: its times in Character::morph_times_s; no rows if all weights
    // that the clip animates are constant.
    uint32_t first_morph_time = 0, morph_row_count = 0;
    uint32_t morph_row_stride = 0;  // from one row to the next in Character::morph_values
    // Box around the mesh at all times of the clip, model space, with all weights of morphs that clips set, and with
    // one morph at weight 1
    Vec3<float> bounds_min{}, bounds_max{};
};

// A morph target of a mesh that a node carries: what it adds to the mesh's vertices, times a weight that each instance
// has.
struct Morph {
    std::string name{};             // mesh.extras.targetNames, else "<mesh>.<target>"
    uint32_t node = 0, target = 0;  // of the file
    float default_weight = 0;       // of instances whose clips do not animate it
};

inline constexpr float kMinMorphWeight = 1e-6f;  // a weight whose magnitude is not larger counts as 0

// What one morph at weight 1 adds to one vertex, in the bind space of its mesh. The position is exact floats. The
// normal is three signed integers of 10 bits, x lowest, in units of kMorphNormalStep; it may be off by 0.002 a
// component and is clamped to -2..2. The sum with the vertex's unit normal is normalised. 16 bytes.
struct MorphDelta {
    Vec3<float> position{};
    uint32_t normal = 0;
};
static_assert(sizeof(MorphDelta) == 16);
inline constexpr float kMorphNormalStep = 2.0f / 511;

// One skin matrix of a character: model_from_joint(joint) * joint_from_bind.
struct PaletteEntry {
    uint32_t joint = 0;
    Affine joint_from_bind{};  // the file's inverse bind matrix; for a rigid mesh, joint_from_mesh
};

// A skin of the file: joint k of the file is palette entry first_entry + k.
struct Skin {
    std::string name{};
    uint32_t first_entry = 0;
    uint32_t joint_count = 0;
};

// 32 bytes. Shared with the shaders (src/skin/skin_io.h has the same layout).
struct Vertex {
    Vec3<float> position{};  // bind space of the mesh
    // The normal, octahedral. In GLSL: vec2 e = unpackSnorm2x16(normal_octahedral); float z = 1 - abs(e.x) - abs(e.y);
    // if (z < 0) e = (1 - abs(e.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(e, vec2(0)));
    // normal = normalize(vec3(e, z));
    uint32_t normal_octahedral = 0;
    std::array<float, 2> texcoord{};
    uint32_t color = 0xFFFFFFFFu;  // linear, four unsigned bytes, red lowest
    // 0: no morph moves it; else 1 + the index of the first of its MorphDeltas, one for each morph of its section
    uint32_t first_delta = 0;
};
static_assert(sizeof(Vertex) == 32);

// Four influences of a vertex; a vertex of a primitive with 8 has two of them, one after the other. 24 bytes.
struct Influences {
    std::array<float, 4> weights{};     // all influences of a vertex sum to 1
    std::array<uint16_t, 4> entries{};  // palette entries
};
static_assert(sizeof(Influences) == 24);

// A primitive of the file that has triangles, as one draw.
struct MeshSection {
    uint32_t node = 0, mesh = 0, primitive = 0;  // of the file
    uint32_t skin = kNone;                       // kNone: rigid
    // In Character::vertices: first the vertices of the AssetPrimitive, in its order, then moved copies of some of
    // them, which only coarser levels of detail use
    uint32_t first_vertex = 0, vertex_count = 0;
    uint32_t lod_vertex_count = 0;  // of vertex_count: the moved copies
    uint32_t first_influences = 0;  // of Character::influences
    uint32_t influence_sets = 1;    // Influences per vertex
    uint32_t first_index = 0, index_count = 0;
    uint32_t material = kNone;
    uint32_t first_morph = 0, morph_count = 0;  // of Character::morphs

    uint32_t own_vertex_count() const { return vertex_count - lod_vertex_count; }  // those of the AssetPrimitive
};

// A coarser mesh, of vertices of level 0 and of copies of them that lie elsewhere, where this brings it closer to level
// 0. Level 0 is the sections' own triangles; Lods are the levels from 1 on.
struct Lod {
    // The largest distance between this level and level 0, both ways, model space, when only the joints move that
    // joint_lods gives to this level: in the rest pose and in poses of clips that the compiler has sampled. Above 0 in
    // compiled levels. Not less than that of the level before.
    float error = 0;
};
struct IndexRange {
    uint32_t first_index = 0, index_count = 0;
};
inline constexpr uint32_t kLodLimit = 3;

struct Character {
    std::string name{};
    Rig rig{};
    std::vector<Clip> clips{};
    std::vector<float> times_s{};  // of all clips, each clip's ascending
    bool packed = false;           // clips are compressed; the rest pose too is then read as PackedTracks
    // exact: rest pose (3 * joint_count), then each clip's constants and rows; packed: PackedTracks
    std::vector<std::array<float, 4>> keys{};
    std::vector<uint32_t> words{};  // packed: rows of bits, and kPackedWordsBehind words behind the last
    // Root motion of clips: x, z, cosine and sine of the turn about +y, model space, relative to the clip's beginning
    std::vector<std::array<float, 4>> root_rows{};
    std::vector<JointTracks> tracks{};  // [clip_count + 1][joint_count]; the last row is the rest pose
    std::vector<Skin> skins{};
    std::vector<PaletteEntry> palette{};
    std::vector<Vertex> vertices{};
    std::vector<Influences> influences{};
    std::vector<uint32_t> indices{};  // relative to the section's first vertex
    std::vector<MeshSection> sections{};
    std::vector<std::string> section_names{};  // [sections]: the node's, or the mesh's where that has none
    std::vector<Lod> lods{};                   // at most kLodLimit
    std::vector<IndexRange> lod_ranges{};      // [lods][sections], of lod_indices
    std::vector<uint32_t> lod_indices{};       // relative to the section's first vertex
    // [joint_count]: the coarsest level of detail in which the joint moves by itself, never coarser than its parent's.
    // In coarser levels its skin matrices are those of its nearest ancestor that moves by itself, as if the joints
    // between them were in the bind pose; in the rest pose and in at least eight poses of each clip, this displaces
    // vertices by no more than a third of the level's error. Empty if that is not known, for example for a character
    // without clips.
    std::vector<uint32_t> joint_lods{};
    std::vector<AssetMaterial> materials{};
    std::vector<AssetImage> images{};
    Vec3<float> bounds_min{}, bounds_max{};  // of the mesh in the rest pose, model space
    // Diagonal of these bounds (1 where they are a point): the unit of every error bound
    float size = 0;
    std::vector<Morph> morphs{};             // those of a node one after another
    std::vector<MorphDelta> morph_deltas{};  // of the vertices that any morph moves
    // [clip_count][morph_count]: kNone if the clip does not animate the morph, else flags as in JointTracks and the
    // position in morph_values of its only weight or, if animated, of its weight in the first row. Between rows weights
    // are interpolated linearly; with kTrackStep the weight of the earlier row holds.
    std::vector<uint32_t> morph_tracks{};
    std::vector<float> morph_times_s{};   // of all clips, each clip's ascending
    std::vector<float> morph_values{};    // constants and rows of all clips
    std::vector<std::string> warnings{};  // of the file and of the compilation, a line each

    // Index of the clip, or of the first morph, with this name, or kNone. clip_named() and morph_named() are the same,
    // but a missing name is an error that says which there are: kInvalidArgument. (A Playback of clip kNone is the rest
    // pose, not an error.)
    ClipIndex find_clip(std::string_view clip_name) const;
    uint32_t find_morph(std::string_view morph_name) const;
    Result<ClipIndex> clip_named(std::string_view clip_name) const;
    Result<uint32_t> morph_named(std::string_view morph_name) const;
    // Indices of all sections with this name, and of all whose material has this name: for outfits.
    std::vector<uint32_t> find_sections(std::string_view section_name) const;
    std::vector<uint32_t> find_sections_of_material(std::string_view material_name) const;
    uint32_t find_material(std::string_view material_name) const;  // the first with this name, or kNone
};

struct CompileSettings {
    // How far a skinned point may be displaced by compressing the clips, as a fraction of the character's size: 1e-6 to
    // 0.1; 0 keeps exact float keys.
    double error = 1e-4;
    // Name of the joint of the rig whose motion over the ground, a translation in x and z and a turn about +y, is taken
    // out of each clip and kept as Character::root_rows, to move instances that have a controller. Empty: none. Joints
    // above it must not be animated.
    std::string root_motion_joint{};
    // Whether to make coarser levels of detail, at most kLodLimit: Character::lods and what belongs to them. Without
    // them CrowdSettings::culling draws the finest mesh at any distance, and reduces_joints leaves out no joints; all
    // else is the same.
    bool lods = true;
};
inline const CompileSettings kExact{.error = 0};

// Compiles an asset. Computes with threads of its own: up to three that pack clips, and meanwhile up to ten that make
// levels of detail. Each that packs, and at last the calling one, may take some 400 MB for a clip of very many rows.
//
// Limits: 65,535 joints; 65,536 palette entries; 256 MiB each of keys, of packed words and of the track table; for
// packing, 2^28 poses of a joint (rows of exact keys, of all clips, times joints); 4,096 morphs, and 256 MiB each of
// their differences, their track table and their weights.
//
// Cubic tracks of morph weights become rows, linear in between, within 0.0001 (times the largest weight of the track,
// if that exceeds 1); at most 4,000,000 such weights a clip. Names of morphs are cut at 256 bytes. Control characters
// in names become '?'.
//
// Errors: kInvalidArgument (an asset that is not as asset.h says; the error bound, no joint of that name for root
// motion), kInvalidFile (poses that are not finite), kUnsupported (nothing to animate; an animated or unevenly scaled
// joint above that of root motion), kLimit, kCancelled.
Result<Character> compile_character(const Asset& asset, const CompileSettings& settings = {},
                                    const LoadHooks& hooks = {});

// Whether `path` is a regular file that begins like one that save_character() wrote, or whether `bytes` begin like such
// a file.
bool is_compiled_file(const std::filesystem::path& path);
bool is_compiled_file(std::span<const std::byte> bytes);

// Character::influences for a coarser level of detail: influences of joints that do not move in it go to the nearest
// ancestor that does (Character::joint_lods). Unchanged if joint_lods is empty.
std::vector<Influences> influences_of_lod(const Character& character, uint32_t lod);

// load_asset() and compile_character() in one. A file that save_character() wrote, known by its first bytes, is read as
// it is: the settings are not used then.
Result<Character> load_character(const std::filesystem::path& path, const CompileSettings& settings = {},
                                 const LoadHooks& hooks = {});

// Writes a compiled character to a file (docs/file_format.md), bit for bit: under a temporary name first, then renamed,
// so that an incomplete file is never seen. Errors: kFile, and kInvalidArgument or kLimit for a Character that
// load_character() would refuse.
Result<void> save_character(const Character& character, const std::filesystem::path& path);
// The content of such a file. Errors: also kOutOfMemory.
Result<std::vector<std::byte>> save_character(const Character& character);

// Reads the content of such a file from memory; `name` appears in messages. The content is not trusted: what is
// accepted cannot make a stage access memory outside its buffers. Errors: kInvalidFile (damaged, cut short, or not such
// a file), kUnsupported (another version), kLimit.
Result<Character> load_compiled_character(std::span<const std::byte> bytes, std::string_view name);

}  // namespace throng
