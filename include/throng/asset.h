// A glTF file as read: nodes, skins, clips and meshes with every index checked, nothing compiled yet.
// An engine with its own importer fills an Asset itself and hands it to compile_character().
#pragma once

#include <throng/index.h>
#include <throng/load_hooks.h>
#include <throng/result.h>
#include <throng/transform.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct AssetNode {
    std::string name{};
    uint32_t parent = kNone;
    Trs<double> parent_from_node{};  // a node given by a matrix is decomposed; rotation is unit
};

struct AssetSkin {
    std::string name{};
    std::vector<uint32_t> joints{};  // node of each joint, in the file's order
    // joint_from_model at bind time, one per joint (identities where the file has none)
    std::vector<Affine> inverse_binds{};
};

enum class Interpolation : uint8_t { kStep, kLinear, kCubicSpline };
enum class TrackTarget : uint8_t { kTranslation, kRotation, kScale };

// Keys of one property of one node.
struct AssetTrack {
    uint32_t node = 0;
    TrackTarget target = TrackTarget::kTranslation;
    Interpolation interpolation = Interpolation::kLinear;
    std::vector<float> times_s{};  // strictly increasing, finite, at least one
    // 3 components a value (4, xyzw, for rotations; not necessarily unit). kCubicSpline has three values a key:
    // in-tangent, value, out-tangent (glTF 2.0, appendix C).
    std::vector<float> values{};
};

// Keys of the morph weights of one node's mesh, all of them at once.
struct AssetMorphTrack {
    uint32_t node = 0;
    Interpolation interpolation = Interpolation::kLinear;
    std::vector<float> times_s{};  // strictly increasing, finite, at least one
    std::vector<float> values{};   // [key][target]; kCubicSpline: [key][3][target], in-tangents, values, out-tangents
};

struct AssetClip {
    std::string name{};                           // may be empty
    double duration_s = 0;                        // largest key time of any track; a clip starts at 0
    std::vector<AssetTrack> tracks{};             // at most one per node and target
    std::vector<AssetMorphTrack> morph_tracks{};  // at most one per node
};

enum class AlphaMode : uint8_t { kOpaque, kMask, kBlend };
enum class TextureFilter : uint8_t { kLinear, kNearest };       // how texels that are larger than pixels are read
enum class TextureWrap : uint8_t { kRepeat, kClamp, kMirror };  // what a coordinate outside of 0..1 reads

struct AssetMaterial {
    std::string name{};
    std::array<float, 4> base_color{1, 1, 1, 1};  // linear
    uint32_t image = kNone;                       // base colour texture, sRGB
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    // How all textures of the material are read. Texels that are smaller than pixels are always mixed, with mipmaps
    TextureFilter filter = TextureFilter::kLinear;
    TextureWrap wrap_u = TextureWrap::kRepeat, wrap_v = TextureWrap::kRepeat;
    float metallic = 1, roughness = 1;          // 0..1
    uint32_t metallic_roughness_image = kNone;  // linear: green times roughness, blue times metallic
    uint32_t normal_image = kNone;              // linear; tangent space: x along texture u, y against v
    float normal_scale = 1;                     // of x and y
    uint32_t occlusion_image = kNone;           // linear: red, the part of the ambient light that arrives
    float occlusion_strength = 1;               // 0..1
    std::array<float, 3> emissive{};            // linear; KHR_materials_emissive_strength is a factor of it
    uint32_t emissive_image = kNone;            // sRGB, times `emissive`
};

// Calls visit(member) for each member of AssetMaterial that is an index of an image.
template <class Visit>
void visit_images(const Visit& visit) {
    for (const auto member :
         {&AssetMaterial::image, &AssetMaterial::metallic_roughness_image, &AssetMaterial::normal_image,
          &AssetMaterial::occlusion_image, &AssetMaterial::emissive_image})
        visit(member);
}

// A texture in use: PNG, JPEG or WebP bytes, still encoded.
struct AssetImage {
    std::string name{};
    std::vector<std::byte> encoded{};  // empty where the file could not be found; a warning says so
};

// What a morph target adds to a primitive's vertices, times its weight.
struct AssetMorphTarget {
    std::vector<Vec3<float>> positions{};  // differences, as all arrays here; empty: none
    std::vector<Vec3<float>> normals{};    // empty: none
};

// A triangle list. Arrays are indexed by vertex; optional ones are empty or complete. load_asset() keeps the vertices
// that the file's indices name, in the file's order, or all of them where it has no indices.
struct AssetPrimitive {
    uint32_t material = kNone;
    std::vector<Vec3<float>> positions{};
    std::vector<Vec3<float>> normals{};             // optional
    std::vector<std::array<float, 2>> texcoords{};  // optional; the set that the material's textures use
    std::vector<std::array<float, 4>> colors{};     // optional, linear
    // Per vertex: 4 per JOINTS_n set, so a multiple of 4; 0 where the primitive is not skinned
    uint32_t influence_count = 0;
    // [vertex][influence_count], index into AssetSkin::joints. A vertex without weight follows the first of its joints;
    // where that one is out of range, the first of the skin.
    std::vector<uint16_t> influence_joints{};
    std::vector<float> influence_weights{};   // [vertex][influence_count], as stored: not rescaled to sum 1
    std::vector<uint32_t> indices{};          // three per triangle
    std::vector<AssetMorphTarget> targets{};  // [target_count] of its mesh, or empty where it has no positions
};

struct AssetMesh {
    std::string name{};
    std::vector<float> weights{};             // [target_count]: of morph targets, where a node does not say otherwise
    std::vector<std::string> target_names{};  // [target_count], or empty
    // One per primitive of the file, in its order; one that draws no triangles (points, lines) has no indices.
    std::vector<AssetPrimitive> primitives{};
};

// A mesh that a node of the scene draws, unless the node is hidden (KHR_node_visibility).
struct AssetMeshInstance {
    uint32_t node = 0;
    uint32_t mesh = 0;
    uint32_t skin = kNone;         // where kNone, the mesh follows its node rigidly
    std::vector<float> weights{};  // [target_count] of the mesh, in place of its own; or empty
};

struct Asset {
    std::string name{};  // of the file, for messages
    std::vector<AssetNode> nodes{};
    std::vector<AssetSkin> skins{};
    std::vector<AssetClip> clips{};
    std::vector<AssetMesh> meshes{};
    std::vector<AssetMeshInstance> mesh_instances{};  // ordered by node
    std::vector<AssetMaterial> materials{};
    std::vector<AssetImage> images{};
    std::vector<std::string> warnings{};  // what was ignored or mended, a line each, with its place
};

// Reads a .glb or .gltf file (glTF 2.0), its buffers and its images.
// Extensions: KHR_mesh_quantization, EXT_meshopt_compression, KHR_meshopt_compression, KHR_draco_mesh_compression,
// KHR_texture_transform, KHR_node_visibility, EXT_texture_webp, KHR_materials_emissive_strength, and the colours of
// KHR_materials_pbrSpecularGlossiness.
// Other extensions of materials and images are ignored, with a warning if that can be seen; any other one in
// `extensionsRequired` is refused by name. Side files must lie in the file's own folder or below it. Errors: kFile,
// kInvalidFile, kUnsupported, kLimit, kCancelled; each names the file and the place in it. Thread-safe.
Result<Asset> load_asset(const std::filesystem::path& path, const LoadHooks& hooks = {});

// Returns the whole content of a side file, a buffer or an image, from wherever the application has it.
//
// `path` is relative to the file's folder and normalised: percent-decoded, with '/' as the only separator, without
// empty segments, without '.' and '..' ("parts/../skin.png" is "skin.png"); never a data: URI. It begins with '..' only
// if it leads out of the folder: a resolver that opens files must refuse such a path, or make sure that it may be read.
//
// Called on the thread that called throng; within one call, not again for a file that it has returned. If it returns
// kFile or kInvalidFile for an image, the image is left out with a warning; other errors, and those of buffers, end the
// call. What it throws becomes kInvalidArgument.
using AssetResolver = std::function<Result<std::vector<std::byte>>(std::string_view path)>;

// The same for the content of a file in memory; `name` becomes Asset::name and appears in messages. Without a resolver
// there are no side files: a buffer in one is refused with kFile. As on disk, the side files can have at most 2 GiB in
// total.
Result<Asset> load_asset(std::span<const std::byte> bytes, std::string_view name, const AssetResolver& resolver = {},
                         const LoadHooks& hooks = {});

// Appends the clips of another asset to those of `asset`, for the nodes that have the same names: `from` can be a file
// with nothing but animation, or another character on such a rig. Names may differ in case, in a prefix that all have
// ("mixamorig:") and in characters other than letters and digits. Tracks without a node of that name are left out, with
// a warning.
//
// Joints turn in model space as they do in `from`, so they must have the same axes in both. If clips turn a joint that
// lies between them and that `asset` lacks, it is taken as it is at rest, with a warning. Bones of another length keep
// their own, and motion over the ground is scaled by the ratio of the mean bone lengths. Morph targets are matched by
// name, with a warning for those that `asset` lacks; where a mesh has no names for them, by their order, if both have
// as many.
//
// A clip keeps its name. One without a name of its own (none, or one that contains "mixamo.com" or "Take 001") is named
// after `from.name` without its extension. If `asset` has a clip of this name already, the name of the file is put
// before it ("more Jump"), and a number behind it if that is taken too ("more Jump 2").
//
// Errors: kInvalidArgument: no clips in `from`, none that animates a node whose name `asset` has, or an asset that
// compile_character() would not take; then `asset` is unchanged.
Result<void> add_clips(Asset& asset, const Asset& from);

// Appends the meshes of another asset to those of `asset`, with its materials and images: clothes, hair or weapons that
// come in files of their own for the same rig. CrowdGroup::outfits can then choose among them. Joints and the nodes
// above them are matched by name, as by add_clips(), and must have the same axes in both. Joints that `asset` lacks are
// added below those that it has, with a warning, since no clip moves them. All other nodes are added, even if `asset`
// has one of the same name. If the rigs differ in units or size, the meshes are scaled by the ratio of the mean bone
// lengths.
//
// Each mesh gets a node of its own, behind those of `asset`, with the name of its node in `from`, or of the mesh where
// the node has none: what Character::find_sections() finds. If a mesh of `asset` has this name already, the name of the
// file is put before it ("coat Body"), and a number behind it if that is taken too; a mesh without a name is named
// after the file. An image that `asset` has already is not added again. Clips are not taken over; use add_clips() for
// these, after add_meshes() if they move joints or morph targets that this call adds.
//
// Errors: kInvalidArgument: no meshes in `from`, none that follows a joint of `asset`, or an asset that
// compile_character() would not take; then `asset` is unchanged.
Result<void> add_meshes(Asset& asset, const Asset& from);

}  // namespace throng
