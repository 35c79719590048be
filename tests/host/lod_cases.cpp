#include "tests/host/lod_cases.h"

#include "tools/creatures/creature.h"

#include <algorithm>

namespace throng::test {

Character with_lods() {
    return *compile_character(*make_creature({.joint_count = 60, .level_count = 15, .face_count = 1500}));
}

Asset make_strip() {
    constexpr uint32_t kColumns = 33, kRows = 5;
    Asset asset{.name = "strip"};
    asset.nodes = {{.name = "root"}, {.name = "middle", .parent = 0, .parent_from_node = {.translation = {1, 0, 0}}}};
    asset.skins = {{.name = "skin",
                    .joints = {0, 1},
                    .inverse_binds = {Affine{}, to_affine(Trs<float>{.translation = {-1, 0, 0}})}}};
    AssetPrimitive strip{.influence_count = 4};
    for (uint32_t row = 0; row < kRows; ++row) {
        for (uint32_t column = 0; column < kColumns; ++column) {
            const float along = 2.0f * static_cast<float>(column) / (kColumns - 1),
                        weight = std::clamp(along - 0.5f, 0.0f, 1.0f);
            strip.positions.push_back({along, 0.1f * static_cast<float>(row), 0});
            strip.influence_joints.insert(strip.influence_joints.end(), {0, 1, 0, 0});
            strip.influence_weights.insert(strip.influence_weights.end(), {1 - weight, weight, 0, 0});
            if (row + 1 == kRows || column + 1 == kColumns) continue;
            const uint32_t at = row * kColumns + column;
            for (const uint32_t step : {0u, 1u, kColumns, kColumns, 1u, kColumns + 1})
                strip.indices.push_back(at + step);
        }
    }
    asset.meshes = {{.name = "strip", .primitives = {strip}}};
    asset.mesh_instances = {{.node = 0, .mesh = 0, .skin = 0}};
    const Quaternion<float> bent = axis_angle(Vec3<float>{0, 1, 0}, 2.0f);
    asset.clips = {{.name = "bends",
                    .duration_s = 1,
                    .tracks = {{.node = 1,
                                .target = TrackTarget::kRotation,
                                .times_s = {0, 1},
                                .values = {0, 0, 0, 1, bent.x, bent.y, bent.z, bent.w}}}}};
    return asset;
}

std::vector<ReferencePose> rest_and_random_poses(const Character& character, int count, Random& random) {
    std::vector<ReferencePose> poses{*reference_pose(character, {})};
    while (poses.size() <= static_cast<size_t>(count)) {
        const uint32_t clip = random.below(static_cast<uint32_t>(character.clips.size()));
        poses.push_back(*reference_pose(
            character, {.first = {.clip = clip, .time_s = random.between(0, character.clips[clip].duration_s)}}));
    }
    return poses;
}

}  // namespace throng::test
