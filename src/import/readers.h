// The parts of a glTF file, one reader each; every reader has a file of its own. They run in the order of this header,
// and a later one may look at what the earlier ones have put into the Asset.
#pragma once

#include "import/accessor.h"

#include <throng/asset.h>

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

void read_nodes(Reading& reading, Asset& asset);
void read_skins(Reading& reading, Asset& asset);
void read_clips(Reading& reading, Asset& asset);
// Returns, for each material, the TEXCOORD set that its base colour texture uses.
std::vector<uint32_t> read_materials(Reading& reading, Asset& asset);
void read_meshes(Reading& reading, const std::vector<uint32_t>& texcoord_sets, Asset& asset);
void read_mesh_instances(Reading& reading, Asset& asset);

// The morph targets of `mesh`, an object of the file: those of its first primitive, to which read_meshes() holds the
// others.
uint32_t morph_target_count(const JsonView& mesh);
// The member `weights` of a mesh or a node; empty where absent. Fails where there are not `target_count` of them.
std::vector<float> read_morph_weights(Reading& reading, const JsonView& json, uint32_t target_count);

// The member `name`, or an empty name and a warning where it is not a string.
std::string read_name(Reading& reading, const JsonView& json);

}  // namespace throng::gltf
