#include "tools/creatures/creature.h"

#include "tools/creatures/model.h"

#include <new>

namespace throng {
namespace {

struct Kind {
    const char* name;
    creature::Model (*make)(const CreatureSettings&);
    CreatureSettings usual;
};
constexpr Kind kKinds[] = {{"dragon", creature::make_dragon, {}},
                           {"willow", creature::make_willow, {240, 30, 3000, 1, CreatureKind::kWillow}},
                           {"walker", creature::make_walker, {160, 40, 2500, 1, CreatureKind::kWalker}},
                           {"centipede", creature::make_centipede, {1000, 330, 3000, 1, CreatureKind::kCentipede}}};

const Kind& kind_of(CreatureKind kind) { return kKinds[size_t(kind)]; }

Result<void> check(const CreatureSettings& s) {
    const auto bad = [](const char* option, std::string message) {
        return Error{ErrorCode::kInvalidArgument, option, std::move(message)};
    };
    if (s.joint_count < 1 || s.joint_count > 65535)
        return bad("joints", std::to_string(s.joint_count) + " is not between 1 and 65535");
    if (s.level_count < 1 || s.level_count > s.joint_count)
        return bad("levels", std::to_string(s.level_count) + " is not between 1 and the number of joints, " +
                                 std::to_string(s.joint_count));
    if (s.level_count == 1 && s.joint_count > 1) return bad("levels", "a tree of one level has one joint");
    if (s.face_count > 10'000'000) return bad("faces", std::to_string(s.face_count) + " is more than 10000000");
    return {};
}

Trs<double> parent_from_joint(const creature::Body& body, uint32_t joint) {
    const uint32_t parent = body.parent[joint];
    if (parent == kNone) return {body.rotation[joint], body.position[joint], {1, 1, 1}};
    const creature::Rotation parent_from_model = creature::conjugate(body.rotation[parent]);
    return {normalized(parent_from_model * body.rotation[joint]),
            creature::rotate(parent_from_model, body.position[joint] - body.position[parent]),
            {1, 1, 1}};
}

Affine joint_from_model(const creature::Body& body, uint32_t joint) {
    const creature::Rotation rotation = creature::conjugate(body.rotation[joint]);
    const creature::Vec translation = creature::rotate(rotation, body.position[joint]) * -1.0;
    return to_affine(Trs<double>{rotation, translation, {1, 1, 1}}).as<float>();
}

Asset assemble(const CreatureSettings& settings) {
    creature::Model model = kind_of(settings.kind).make(settings);
    const creature::Body& body = model.body;
    Asset asset;
    asset.name = "creature";
    asset.nodes.resize(body.joint_count());
    asset.nodes[0].name = "body";  // not "root": three.js takes that name for the whole scene
    for (const creature::Chain& chain : body.chains)
        for (uint32_t k = 0; k < chain.joint_count; ++k)
            asset.nodes[chain.first_joint + k].name = std::string(chain.part) + "_" +
                                                      std::to_string(&chain - body.chains.data()) + "_" +
                                                      std::to_string(k);
    AssetSkin skin{"creature", {}, {}};
    for (uint32_t joint = 0; joint < body.joint_count(); ++joint) {
        asset.nodes[joint].parent = body.parent[joint];
        asset.nodes[joint].parent_from_node = parent_from_joint(body, joint);
        skin.joints.push_back(joint);
        skin.inverse_binds.push_back(joint_from_model(body, joint));
    }
    asset.skins = {std::move(skin)};
    asset.clips = creature::make_clips(body, asset.nodes, model.motion);
    asset.meshes = {creature::make_mesh(std::move(model.pieces), settings.face_count)};
    for (const creature::Material& of : model.materials) {
        AssetMaterial& material = asset.materials.emplace_back();
        material.name = of.name;
        const Vec3<float> color = of.color.as<float>();
        material.base_color = {color.x, color.y, color.z, 1};
        material.double_sided = true;  // membranes, cloth and leaves are single sheets
    }
    asset.mesh_instances = {{body.joint_count(), 0, 0}};
    asset.nodes.push_back({"creature", kNone, {}});
    return asset;
}

}  // namespace

CreatureSettings creature_settings(CreatureKind kind) { return kind_of(kind).usual; }

Result<CreatureKind> creature_kind(const std::string& name) {
    std::string known;
    for (const Kind& kind : kKinds) {
        if (name == kind.name) return kind.usual.kind;
        known += (known.empty() ? "" : ", ") + std::string(kind.name);
    }
    return Error{ErrorCode::kInvalidArgument, "kind", "there is no '" + name + "'. There are: " + known};
}

Result<Asset> make_creature(const CreatureSettings& settings) {
    if (const Result<void> checked = check(settings); !checked) return checked.error();
    try {
        return assemble(settings);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kOutOfMemory, "creature", "out of memory"};
    }
}

}  // namespace throng
