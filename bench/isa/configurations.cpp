#include "bench/isa/configurations.h"

#include "bench/control_bench.h"
#include "bench/value_of.h"
#include "scan/scan_shaders.h"
#include "scan/scan_table.h"
#include "tools/creatures/creature.h"

#include <algorithm>

namespace throng::bench {
namespace {

Asset creature_of(uint32_t joints, uint32_t levels) {
    return value_of(make_creature({.joint_count = joints, .level_count = levels}));
}

std::string size_text(uint32_t characters, const Character& character) {
    return std::to_string(characters) + " x " + std::to_string(character.rig.joint_count()) + ", " +
           std::to_string(character.rig.level_count) + " levels";
}

struct Visits {
    const Character& character;
    const VisitIsa& visit;

    void operator()(const std::string& name, const CrowdGroup& group, CrowdSettings settings = {},
                    uint32_t characters = 0) const {
        settings.groups = {group};
        settings.groups[0].character = &character;
        // Enough that each has one subgroup, as in the crowds that the records are about; in a small crowd each gets
        // more
        constexpr uint32_t kMany = 10'000;
        settings.groups[0].instance_count = group.shader_commands ? 0 : std::max(characters, kMany);
        settings.timestamps = false;
        visit({name, characters, &character, settings});
    }
};

void visit_fused_forms(const Character& character, const Visits& visits) {
    for (const ScanMethod& method : scan_table())
        if (!scan_shaders(method.name).fused.empty())
            visits("by " + std::string(method.name), {}, {.path = UpdatePath::kFused, .scan = std::string(method.name)},
                   10'000);
    visits("24 bytes", {}, {.skin_format = SkinFormat::kHalfAffine}, 10'000);
    visits("32 bytes", {}, {.skin_format = SkinFormat::kSimilarity}, 10'000);
    visits("model matrices", {}, {.keep_model_matrices = true});
    visits("sockets", {.sockets = {0, character.rig.joint_count() / 2}});
    visits("pose overrides", {.pose_capacity = 1});
    visits("for a view", {}, {.culling = Culling{.skips_updates = true, .reduces_joints = true}});
    const Controller controller = control_bench_controller(character);
    visits("controller", {.controller = &controller});
    visits("controller, overrides, for a view", {.controller = &controller, .pose_capacity = 1},
           {.skin_format = SkinFormat::kHalfAffine, .culling = Culling{}});
    const Controller inertial = direct_layers(2, {}, true);
    visits("inertial", {.controller = &inertial});
}

// The kernels of staged updates, and of stages that move no joints: steering, skinning, morphs.
void visit_stages(const Character& character, const Visits& visits) {
    const CrowdSettings staged{.path = UpdatePath::kStaged};
    visits("staged", {}, staged);
    visits("staged, 24 bytes", {}, {.path = UpdatePath::kStaged, .skin_format = SkinFormat::kHalfAffine});
    const Controller controller = control_bench_controller(character);
    visits("staged, controller", {.controller = &controller}, staged);
    Controller in_model = direct_layers(2);
    in_model.layers.back().model_space_rotations = true;
    visits("layers in model space", {.controller = &in_model});
    const std::string& joint = character.rig.names[character.rig.joint_count() / 2];
    const ProceduralRules rules{
        .targets = {"target"},
        .rules = {WindRule{.joint = joint}, SpringRule{.joint = joint}, LookAtRule{.joint = joint, .target = "target"},
                  ReachRule{.joint = joint, .target = "target"}}};
    visits("procedural", {.procedural = &rules});
    const Terrain flat{.columns = 2, .rows = 2, .heights = {0, 0, 0, 0}};
    visits("agents on terrain", {.steering = Steering{}, .terrain = &flat});
    visits("looks", {.outfits = {{}}});
    visits("carried", {.is_carried = true});
    visits("commanded", {.controller = &controller, .capacity = 1, .shader_commands = ShaderCommands{1, true}});
    visits("skinned once", {}, {.skins_once = true});
    visits("skinned once, dual quaternions, for a view", {},
           {.culling = Culling{}, .skin_blend = SkinBlend::kDualQuaternion, .skins_once = true});
}

// The same asset with a morph target added to its first mesh.
Asset with_morph(Asset asset) {
    AssetMesh& mesh = asset.meshes.front();
    mesh.weights = {1};
    for (AssetPrimitive& primitive : mesh.primitives)
        primitive.targets = {{.positions = std::vector<Vec3<float>>(primitive.positions.size(), {0, 0.1f, 0})}};
    return asset;
}

}  // namespace

void visit_default_forms(const VisitIsa& visit) {
    struct Size {
        uint32_t characters, joints, levels;
    };
    constexpr std::array kSizes{Size{10'000, 300, 15},  Size{10'000, 300, 30}, Size{10'000, 300, 60},
                                Size{10'000, 300, 120}, Size{100'000, 64, 15}, Size{100'000, 19, 8}};
    for (const Size& size : kSizes) {
        const Character character = value_of(compile_character(creature_of(size.joints, size.levels), {.lods = false}));
        Visits{character, visit}(size_text(size.characters, character), {}, {}, size.characters);
    }
}

void visit_other_forms(const VisitIsa& visit) {
    const Asset asset = creature_of(300, 60);
    const Character character = value_of(compile_character(asset)), exact = value_of(compile_character(asset, kExact)),
                    morphed = value_of(compile_character(with_morph(asset)));
    Visits{exact, visit}("exact keys", {});
    visit_fused_forms(character, {character, visit});
    visit_stages(character, {character, visit});
    const Controller controller = direct_layers(2);
    Visits{morphed, visit}("morphs", {}, {.skins_once = true});
    Visits{morphed, visit}("morphs in layers", {.controller = &controller});
}

}  // namespace throng::bench
