// The parts of a glTF file, one reader each; every reader has a file of its own. They run in the order of this header,
// and a later one may look at what the earlier ones have put into the Asset.
#pragma once

#include "import/accessor.h"

#include <throng/asset.h>

#include <array>
#include <span>

namespace throng::gltf {

// What all readers share.
struct Reading {
    JsonView root;
    Buffers& buffers;
    Accessors& accessors;
    Budget& budget;
    Warnings& warnings;
    bool quantized;          // KHR_mesh_quantization is used
    Progress progress = {};  // of the reader that runs

    // An array of the file, with `element_bytes` charged for each element.
    JsonView charged_array(const char* key, uint64_t element_bytes) {
        JsonView array = root.optional_array(key);
        budget.charge(array.size(), element_bytes, array.place());
        return array;
    }
};

// Where all textures of a material take their coordinates from.
struct TextureCoordinates {
    uint32_t set = 0;  // of TEXCOORD_n
    // KHR_texture_transform: texture_from_mesh, two rows of three
    std::array<std::array<double, 3>, 2> transform{{{1, 0, 0}, {0, 1, 0}}};

    bool operator==(const TextureCoordinates&) const = default;
};

// How many joints the skins of a mesh must have.
struct NeededJoints {
    uint32_t count = 0;   // one more than the largest joint that has weight
    uint32_t vertex = 0;  // of the file: one that follows that joint
    std::string place{};  // of the JOINTS_n that say so
};

void read_nodes(Reading& reading, Asset& asset);
void read_skins(Reading& reading, Asset& asset);
void read_clips(Reading& reading, Asset& asset);
// Returns the texture coordinates that each material uses.
std::vector<TextureCoordinates> read_materials(Reading& reading, Asset& asset);
// Returns what each mesh needs of its skins.
std::vector<NeededJoints> read_meshes(Reading& reading, std::span<const TextureCoordinates> of_materials, Asset& asset);
void read_mesh_instances(Reading& reading, std::span<const NeededJoints> of_meshes, Asset& asset);

// The number of morph targets of `mesh`, an object of the file: that of its first primitive; read_meshes() requires the
// same of the others.
uint32_t morph_target_count(const JsonView& mesh);
// The member `weights` of a mesh or a node; empty if absent. Fails unless there are `target_count` of them.
std::vector<float> read_morph_weights(Reading& reading, const JsonView& json, uint32_t target_count);

// The member `name`, or an empty name and a warning where it is not a string.
std::string read_name(Reading& reading, const JsonView& json);

}  // namespace throng::gltf
