#include "import/read_primitive.h"

namespace throng::gltf {
namespace {

// mesh.extras.targetNames: only a convention of exporters, so names that do not fit are no error.
std::vector<std::string> read_target_names(Reading& reading, const JsonView& mesh, uint32_t target_count) {
    const auto extras = mesh.find("extras");
    if (!extras || !extras->is_object()) return {};
    const auto names = extras->find("targetNames");
    if (!names) return {};
    std::vector<std::string> out;
    if (names->is_array() && names->size() == target_count)
        for (size_t t = 0; t < target_count; ++t)
            if ((*names)[t].is_string()) out.push_back((*names)[t].as_string());
    if (out.size() == target_count) return out;
    reading.warnings.add(names->place(), "does not have a name for each morph target: it is ignored");
    return {};
}

// One warning for each kind: exporters that write such attributes write many.
void warn_of(Reading& reading, const AttributeNotes& notes, const AttributeNotes::Repair& repair, const char* what) {
    if (repair.count > 0)
        reading.warnings.add(repair.first_place, repair.count, " of ", notes.count,
                             " attributes, the first of them here, ", what);
}

}  // namespace

uint32_t morph_target_count(const JsonView& mesh) {
    const JsonView primitives = mesh.optional_array("primitives");
    return primitives.size() == 0 ? 0 : uint32_t(primitives[0].as_object().optional_array("targets").size());
}

std::vector<float> read_morph_weights(Reading& reading, const JsonView& json, uint32_t target_count) {
    if (!json.has("weights")) return {};
    const JsonView weights = json.required_array("weights");
    if (weights.size() != target_count)
        weights.fail("has ", weights.size(), " numbers, but the mesh has ", target_count, " morph targets");
    reading.budget.charge(target_count, sizeof(float), weights.place());
    std::vector<float> out;
    for (const JsonView weight : weights) out.push_back(weight.as_float());
    return out;
}

std::vector<NeededJoints> read_meshes(Reading& reading, std::span<const TextureCoordinates> of_materials,
                                      Asset& asset) {
    const JsonView meshes = reading.charged_array("meshes", sizeof(AssetMesh) + sizeof(NeededJoints));
    asset.meshes.reserve(meshes.size());
    std::vector<NeededJoints> needed(meshes.size());
    AttributeNotes notes;
    for (const JsonView json : meshes) {
        reading.progress.report(asset.meshes.size(), meshes.size());
        AssetMesh mesh;
        mesh.name = read_name(reading, json);
        const uint32_t target_count = morph_target_count(json);
        const JsonView primitives = json.required_array("primitives");
        reading.budget.charge(primitives.size(), sizeof(AssetPrimitive), primitives.place());
        mesh.primitives.reserve(primitives.size());
        for (const JsonView primitive : primitives) {
            const JsonView targets = primitive.as_object().optional_array("targets");
            if (targets.size() != target_count)
                primitive.fail_at("targets", "has ", targets.size(), " morph targets, but the first primitive has ",
                                  target_count);
            mesh.primitives.push_back(
                read_primitive(reading, primitive, asset, of_materials, notes, needed[asset.meshes.size()]));
        }
        mesh.weights = read_morph_weights(reading, json, target_count);
        mesh.weights.resize(target_count);
        mesh.target_names = read_target_names(reading, json, target_count);
        asset.meshes.push_back(std::move(mesh));
    }
    warn_of(reading, notes, notes.taken_as_normalised,
            "are integers that glTF does not allow there: they are taken as normalised");
    warn_of(reading, notes, notes.left_out, "have a format that normals cannot have: they are left out");
    return needed;
}

}  // namespace throng::gltf
