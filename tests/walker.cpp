#include "tests/walker.h"

#include <cmath>

namespace throng::test {

using std::numbers::pi;

ModelPose walk(double time_s) {
    const double yaw = 50 * pi / 180 * time_s, radius = 1.2 / (50 * pi / 180), phase = 2 * pi * time_s;
    const Quaternion<double> swing = axis_angle(normalized(Vec3<double>{1, 0, 0.4}), 0.15 * std::sin(phase));
    return {axis_angle(kUp, yaw) * swing,
            {0.1 + radius * (1 - std::cos(yaw)), 0.9 + 0.04 * std::sin(2 * phase), -0.2 + radius * std::sin(yaw)}};
}

Walker::Walker(bool armature_is_joint) {
    asset.nodes.push_back({.name = "armature", .parent_from_node = armature});
    asset.nodes.push_back({.name = "hips", .parent = kArmature, .parent_from_node = {.translation = {0, 90, 0}}});
    asset.nodes.push_back({.name = "leg", .parent = kHips, .parent_from_node = {.translation = {10, -40, 0}}});
    Affine large;
    for (size_t i = 0; i < 3; ++i) large.row[i][i] = 100;
    asset.skins.push_back({.name = "skin", .joints = {kHips, kLeg}, .inverse_binds = {large, large}});
    if (armature_is_joint) {
        asset.skins[0].joints.push_back(kArmature);
        asset.skins[0].inverse_binds.push_back(large);
    }
    AssetPrimitive primitive{.positions = {{0, 0, 0},
                                           {0.3f, 0.9f, 0.1f},
                                           {-0.2f, 0.4f, 0.3f},
                                           {0, -0.8f, 0},
                                           {0.1f, -0.4f, 0.2f},
                                           {0.1f, 0.2f, -0.5f}},
                             .indices = {0, 1, 2, 3, 4, 5}};
    primitive.influence_count = 4;
    for (uint16_t v = 0; v < 6; ++v) {
        const auto joint = static_cast<uint16_t>(v / 3);
        primitive.influence_joints.insert(primitive.influence_joints.end(), {joint, 0, 0, 0});
        primitive.influence_weights.insert(primitive.influence_weights.end(), {1, 0, 0, 0});
    }
    asset.meshes.push_back({.name = "mesh", .primitives = {primitive}});
    asset.mesh_instances.push_back({.node = kHips, .mesh = 0, .skin = 0});
}

void Walker::move(const char* name, const std::vector<float>& times_s, const Motion& motion,
                  Interpolation interpolation) {
    clip(name, times_s.back());
    const Quaternion<double> back{-armature.rotation.x, -armature.rotation.y, -armature.rotation.z,
                                  armature.rotation.w};
    std::vector<float> rotations, translations, swings;
    const auto append = [](std::vector<float>& to, std::initializer_list<double> values) {
        for (const double value : values) to.push_back(static_cast<float>(value));
    };
    for (const float time_s : times_s) {
        const ModelPose pose = motion(time_s);
        const Quaternion<double> q = back * pose.rotation,
                                 swing = axis_angle(Vec3<double>{1, 0, 0}, 0.5 * std::sin(2 * pi * double{time_s}));
        const Vec3<double> p = transform_vector(to_affine(Trs<double>{.rotation = back}),
                                                pose.position - armature.translation) *
                               (1 / armature.scale.x);
        append(rotations, {q.x, q.y, q.z, q.w});
        append(translations, {p.x, p.y, p.z});
        append(swings, {swing.x, swing.y, swing.z, swing.w});
    }
    track(kHips, TrackTarget::kRotation, times_s, rotations, interpolation);
    track(kHips, TrackTarget::kTranslation, times_s, translations, interpolation);
    track(kLeg, TrackTarget::kRotation, times_s, swings);
}

std::vector<float> times(double duration_s, double rate) {
    std::vector<float> out;
    for (int key = 0; key / rate < duration_s - 1e-6; ++key) out.push_back(static_cast<float>(key / rate));
    out.push_back(static_cast<float>(duration_s));
    return out;
}

}  // namespace throng::test
