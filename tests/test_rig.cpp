#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace throng::test {
namespace {

// Sorted times within 0..duration_s; the first axis has both ends, the others neither, so that tracks start late and
// end early.
std::vector<float> make_axis(Random& random, double duration_s, uint32_t key_count, bool with_ends) {
    std::vector<float> times_s;
    for (uint32_t k = 0; k < key_count; ++k)
        times_s.push_back(static_cast<float>(duration_s * (k + random.between(0.2, 0.8)) / key_count));
    if (with_ends) {
        times_s.front() = 0;
        times_s.back() = static_cast<float>(duration_s);
    }
    return times_s;
}

AssetTrack make_track(Random& random, uint32_t node, TrackTarget target, const Trs<double>& rest,
                      const std::vector<float>& times_s, const AssetSettings& settings) {
    AssetTrack track{.node = node, .target = target, .times_s = times_s};
    track.interpolation = settings.cubic && random.chance(0.33) ? Interpolation::kCubicSpline
                          : random.chance(0.2)                  ? Interpolation::kStep
                                                                : Interpolation::kLinear;
    const auto put = [&](std::initializer_list<double> values) {
        for (double value : values) track.values.push_back(static_cast<float>(value));
    };
    Quaternion<double> q = rest.rotation;
    for (size_t key = 0; key < times_s.size(); ++key) {
        const bool cubic = track.interpolation == Interpolation::kCubicSpline;
        const auto put_tangent = [&] {
            if (!cubic) return;
            const Vec3<double> t = random.vector(0.2);
            if (target == TrackTarget::kRotation)
                put({t.x, t.y, t.z, random.between(-0.2, 0.2)});
            else
                put({t.x, t.y, t.z});
        };
        put_tangent();
        if (target == TrackTarget::kRotation) {
            q = normalized(q * axis_angle(random.direction(), random.between(0, 1.2)));
            const double side = !cubic && random.chance(0.3) ? -1 : 1;  // a negated quaternion is the same rotation
            put({side * q.x, side * q.y, side * q.z, side * q.w});
        } else if (target == TrackTarget::kTranslation) {
            const Vec3<double> t = rest.translation + random.vector(0.1);
            put({t.x, t.y, t.z});
        } else {
            const auto one = [&] { return random.between(1 - settings.scale_spread, 1 + settings.scale_spread); };
            put({one(), one(), one()});
        }
        put_tangent();
    }
    return track;
}

AssetClip make_clip(Random& random, const Asset& asset, uint32_t index, const AssetSettings& settings) {
    AssetClip clip{.name = "clip " + std::to_string(index), .duration_s = index + 1.0};
    std::vector<std::vector<float>> axes;
    for (uint32_t a = 0; a < settings.axis_count; ++a)
        axes.push_back(make_axis(random, clip.duration_s, settings.key_count, a == 0));
    for (uint32_t node = 0; node < asset.nodes.size(); ++node) {
        const auto add = [&](TrackTarget target) {
            const auto& axis = node == 0 ? axes[0] : axes[random.below(settings.axis_count)];
            clip.tracks.push_back(make_track(random, node, target, asset.nodes[node].parent_from_node, axis, settings));
        };
        if (node == 0 || random.chance(0.8)) add(TrackTarget::kRotation);
        if (random.chance(0.3)) add(TrackTarget::kTranslation);
        if (settings.scale_spread > 0 && random.chance(0.3)) add(TrackTarget::kScale);
    }
    return clip;
}

AssetPrimitive make_primitive(Random& random, uint32_t vertex_count, uint32_t influence_count, uint32_t joint_count) {
    AssetPrimitive primitive{.influence_count = influence_count};
    for (uint32_t v = 0; v < vertex_count; ++v) {
        primitive.positions.push_back(random.vector(0.3).as<float>());
        for (uint32_t i = 0; i < influence_count; ++i) {
            primitive.influence_joints.push_back(static_cast<uint16_t>(random.below(joint_count)));
            primitive.influence_weights.push_back(
                i > 0 && random.chance(0.3) ? 0.0f : static_cast<float>(random.between(0.1, 1)));
        }
    }
    for (uint32_t v = 0; v + 2 < vertex_count; v += 3)
        primitive.indices.insert(primitive.indices.end(), {v, v + 1, v + 2});
    return primitive;
}

// Half of the vertices are moved by no target; each target moves half of the rest. Clips have no weights, constant
// weights, or varying ones.
void add_morphs(Asset& asset, const AssetSettings& settings) {
    Random random(settings.seed + 77);
    for (uint32_t m = 0; m < 2; ++m) {
        AssetMesh& mesh = asset.meshes[m];
        AssetMeshInstance& instance = asset.mesh_instances[m];
        AssetPrimitive& primitive = mesh.primitives[0];
        instance.node = m;
        for (uint32_t t = 0; t < settings.morph_count; ++t) {
            mesh.weights.push_back(random.chance(0.5) ? 0 : static_cast<float>(random.between(-0.5, 1)));
            if (m == 0) mesh.target_names.push_back("target " + std::to_string(t));
            AssetMorphTarget& target = primitive.targets.emplace_back();
            for (uint32_t v = 0; v < settings.vertex_count; ++v) {
                const bool moves = v % 2 == 0 && random.chance(0.5);
                target.positions.push_back(moves ? random.vector(0.1).as<float>() : Vec3<float>{});
                target.normals.push_back(moves ? random.vector(1).as<float>() : Vec3<float>{});
            }
            if (t == 1) target.normals.clear();
        }
        if (m == 1)
            for (uint32_t t = 0; t < settings.morph_count; ++t)
                instance.weights.push_back(static_cast<float>(random.between(-1, 1)));
        for (AssetClip& clip : asset.clips) {
            if (random.chance(0.2)) continue;
            AssetMorphTrack track{.node = m,
                                  .interpolation = settings.cubic && random.chance(0.5) ? Interpolation::kCubicSpline
                                                   : random.chance(0.3)                 ? Interpolation::kStep
                                                                                        : Interpolation::kLinear,
                                  .times_s = make_axis(random, clip.duration_s, settings.key_count, false),
                                  .values = {}};
            const uint32_t parts = track.interpolation == Interpolation::kCubicSpline ? 3 : 1,
                           constant = random.below(settings.morph_count);
            for (uint32_t key = 0; key < settings.key_count; ++key)
                for (uint32_t part = 0; part < parts; ++part)
                    for (uint32_t t = 0; t < settings.morph_count; ++t)
                        track.values.push_back(t == constant ? (parts == 3 && part != 1 ? 0.0f : 0.75f)
                                                             : static_cast<float>(random.between(-1, 1)));
            clip.morph_tracks.push_back(std::move(track));
        }
    }
}

}  // namespace

Vec3<double> Random::vector(double extent) {
    const double x = between(-extent, extent), y = between(-extent, extent), z = between(-extent, extent);
    return {x, y, z};
}

Vec3<double> Random::direction() {
    const double z = between(-1, 1), angle_rad = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle_rad), r * std::sin(angle_rad), z};
}

Trs<double> Random::trs(double extent, double scale_spread) {
    Trs<double> out;
    out.rotation = rotation();
    out.translation = vector(extent);
    out.scale = Vec3<double>{1, 1, 1} + vector(scale_spread);
    return out;
}

std::string_view name_of(RigShape shape) {
    switch (shape) {
        case RigShape::kChain: return "chain";
        case RigShape::kStar: return "star";
        case RigShape::kComb: return "comb";
        case RigShape::kBinary: return "binary";
        case RigShape::kRandom: return "random";
        case RigShape::kBushy: return "bushy";
    }
    return "?";
}

std::vector<uint32_t> make_parents(RigShape shape, uint32_t joint_count, uint64_t seed) {
    Random random(seed);
    std::vector<uint32_t> parents{kNone};
    for (uint32_t joint = 1; joint < joint_count; ++joint) {
        uint32_t parent = joint - 1;
        switch (shape) {
            case RigShape::kChain: break;
            case RigShape::kStar: parent = 0; break;
            case RigShape::kComb: parent = joint % 2 == 1 ? joint - 1 : joint - 2; break;
            case RigShape::kBinary: parent = (joint - 1) / 2; break;
            case RigShape::kRandom:
                parent = random.chance(0.01) ? kNone : joint - 1 - random.below(std::min(joint, 16u));
                break;
            case RigShape::kBushy: parent = random.below(joint); break;
        }
        parents.push_back(parent);
    }
    return parents;
}

Affine exact_transform(Random& random) {
    Affine m;
    for (int axis = 0; axis < 3; ++axis) {
        const size_t u = static_cast<size_t>(axis + 1) % 3, v = static_cast<size_t>(axis + 2) % 3;
        for (uint32_t turns = random.below(4); turns > 0; --turns) {  // a quarter turn about `axis`, from the left
            std::swap(m.row[u], m.row[v]);
            for (float& element : m.row[u]) element = 0 - element;
        }
    }
    for (auto& row : m.row) row[3] = static_cast<float>(random.below(9)) - 4;
    return m;
}

Asset make_asset(const AssetSettings& settings) {
    Random random(settings.seed);
    Asset asset{.name = settings.name};
    for (const uint32_t parent : make_parents(settings.shape, settings.joint_count, settings.seed))
        asset.nodes.push_back({.name = "joint " + std::to_string(asset.nodes.size()),
                               .parent = parent,
                               .parent_from_node = random.trs(0.15, settings.scale_spread)});
    AssetSkin skin{.name = "skin"};
    for (uint32_t node = 0; node < settings.joint_count; ++node) {
        skin.joints.push_back(node);
        skin.inverse_binds.push_back(to_affine(random.trs(0.2, settings.scale_spread)).as<float>());
    }
    asset.skins.push_back(skin);
    for (uint32_t clip = 0; clip < settings.clip_count; ++clip)
        asset.clips.push_back(make_clip(random, asset, clip, settings));
    for (const uint32_t influence_count : {4u, 8u}) {
        AssetMesh mesh{.name = "mesh"};
        mesh.primitives.push_back(make_primitive(random, settings.vertex_count, influence_count, settings.joint_count));
        asset.mesh_instances.push_back({.node = 0, .mesh = static_cast<uint32_t>(asset.meshes.size()), .skin = 0});
        asset.meshes.push_back(mesh);
    }
    if (settings.morph_count > 0) add_morphs(asset, settings);
    return asset;
}

Character compiled(const Asset& asset, const CompileSettings& settings) {
    Result<Character> character = compile_character(asset, settings);
    if (!character) {
        ADD_FAILURE() << character.error().text();
        return {};
    }
    return std::move(*character);
}

double worse_of(double a, double b) { return std::isnan(a) || std::isnan(b) ? double{kInfinity} : std::max(a, b); }

double matrix_error(const Affine& got, const AffineT<double>& wanted, double size) {
    double scale = 1, linear = 0, translation = 0;
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 4; ++column) {
            const double difference = std::abs(got.row[row][column] - wanted.row[row][column]);
            if (!std::isfinite(difference)) return std::numeric_limits<double>::infinity();
            if (column == 3) {
                translation = std::max(translation, difference);
            } else {
                scale = std::max(scale, std::abs(wanted.row[row][column]));
                linear = std::max(linear, difference);
            }
        }
    return std::max(linear / scale, translation / size);
}

}  // namespace throng::test
