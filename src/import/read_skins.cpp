#include "import/readers.h"

#include <cmath>
#include <unordered_set>

namespace throng::gltf {
namespace {

std::vector<Affine> read_inverse_binds(Reading& reading, const JsonView& json, size_t joint_count) {
    std::vector<Affine> out(joint_count);
    if (!json.has("inverseBindMatrices")) return out;
    const auto fail = [&](const auto&... what) { json.fail_at("inverseBindMatrices", what...); };
    const AccessorView matrices = reading.accessors.open(json, "inverseBindMatrices", Missing::kAreLeftOut);
    if (matrices.format.type != "MAT4" || !matrices.format.is_float())
        fail("must be MAT4 of floats, but is ", matrices.format.text());
    if (matrices.count() < joint_count) fail("has ", matrices.count(), " matrices for ", joint_count, " joints");
    for (uint32_t joint = 0; joint < joint_count; ++joint)
        for (uint32_t row = 0; row < 3; ++row)
            for (uint32_t column = 0; column < 4; ++column) {
                const float value = matrices.number(joint, column * 4 + row);
                if (!std::isfinite(value)) fail("matrix ", joint, " is not finite");
                out[joint].row[row][column] = value;
            }
    return out;
}

}  // namespace

void read_skins(Reading& reading, Asset& asset) {
    const JsonView skins = reading.charged_array("skins", sizeof(AssetSkin));
    asset.skins.reserve(skins.size());
    for (const JsonView json : skins) {
        AssetSkin skin;
        skin.name = read_name(reading, json);
        const JsonView joints = json.required_array("joints");
        if (joints.size() == 0) joints.fail("is empty");
        reading.budget.charge(joints.size(), sizeof(uint32_t) + sizeof(Affine), joints.place());
        std::unordered_set<uint32_t> seen;
        for (const JsonView joint : joints) {
            const uint32_t node = joint.as_index(asset.nodes.size(), "nodes");
            if (!seen.insert(node).second)
                reading.warnings.add(joint.place(), "nodes[", node, "] is a joint of this skin twice");
            skin.joints.push_back(node);
        }
        json.optional_index("skeleton", asset.nodes.size(), "nodes");  // not used, but must be valid
        skin.inverse_binds = read_inverse_binds(reading, json, joints.size());
        asset.skins.push_back(std::move(skin));
    }
}

}  // namespace throng::gltf
