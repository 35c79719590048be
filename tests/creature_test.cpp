// The creature generator's guarantees: exact tree, face budget, sound mesh, seamless clips.
#include "../tools/creatures/creature.h"
#include "../tools/creatures/glb_writer.h"

#include <throng/character.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>

namespace throng {
namespace {

constexpr CreatureKind kCreatureKinds[] = {CreatureKind::kDragon, CreatureKind::kWillow, CreatureKind::kWalker,
                                           CreatureKind::kCentipede};
constexpr const char* kNames[] = {"dragon", "willow", "walker", "centipede"};

constexpr uint32_t kCreatureJointCounts[] = {1, 2, 3, 5, 17, 64, 100, 300, 1000};
constexpr uint32_t kLevelCounts[] = {1, 2, 3, 4, 5, 7, 8, 15, 16, 17, 30, 60, 64, 99, 120, 200, 300, 999};

// Every allowed pair of the two lists, and the pure chain of each joint count.
std::vector<CreatureSettings> grid(CreatureKind kind) {
    std::vector<CreatureSettings> out;
    for (const uint32_t joints : kCreatureJointCounts) {
        std::set<uint32_t> levels{joints};
        for (const uint32_t count : kLevelCounts)
            // Large creatures take long, so only some of them
            if (count <= joints && (count > 1 || joints == 1) && (joints < 1000 || count % 4 == 0))
                levels.insert(count);
        for (const uint32_t count : levels) out.push_back({joints, count, 1500, joints + count, kind});
    }
    return out;
}

std::string text_of(const CreatureSettings& s) {
    return std::string(kNames[size_t(s.kind)]) + ", " + std::to_string(s.joint_count) + " joints, " +
           std::to_string(s.level_count) + " levels, " + std::to_string(s.face_count) + " faces, seed " +
           std::to_string(s.seed);
}

Asset creature(const CreatureSettings& settings) {
    Result<Asset> made = make_creature(settings);
    if (!made) throw std::runtime_error(made.error().text());
    return *std::move(made);
}

using Matrices = std::vector<AffineT<double>>;  // [joint] model_from_joint

// The pose at one key of a clip; at rest without one.
Matrices pose(const Asset& asset, const AssetClip* clip = nullptr, size_t key = 0) {
    std::vector<Trs<double>> local;
    for (const AssetNode& node : asset.nodes) local.push_back(node.parent_from_node);
    for (size_t i = 0; clip && i < clip->tracks.size(); ++i) {
        const AssetTrack& track = clip->tracks[i];
        const float* v = &track.values[key * (track.target == TrackTarget::kRotation ? 4 : 3)];
        if (track.target == TrackTarget::kRotation)
            local[track.node].rotation = Quaternion<float>{v[0], v[1], v[2], v[3]}.as<double>();
        else
            local[track.node].translation = Vec3<float>{v[0], v[1], v[2]}.as<double>();
    }
    Matrices out;
    for (size_t i = 0; i < local.size(); ++i) {
        const uint32_t parent = asset.nodes[i].parent;
        out.push_back(parent == kNone ? to_affine(local[i]) : out[parent] * to_affine(local[i]));
    }
    return out;
}

struct Box {
    Vec3<double> least{1e30, 1e30, 1e30}, most{-1e30, -1e30, -1e30};
    void add(const Vec3<double>& p) {
        least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
        most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
    }
    Vec3<double> size() const { return most - least; }
};

Box box_of_joints(const Asset& asset, const Matrices& model_from_joint) {
    Box box;
    for (const uint32_t joint : asset.skins[0].joints) box.add(transform_point(model_from_joint[joint], {0, 0, 0}));
    return box;
}
Box box_of_skin(const Asset& asset, const Matrices& model_from_joint) {
    Box box;
    for (const AssetPrimitive& p : asset.meshes[0].primitives)
        for (size_t v = 0; v < p.positions.size(); ++v) {
            Vec3<double> position;
            for (size_t i = 4 * v; i < 4 * v + 4; ++i) {
                const uint32_t joint = p.influence_joints[i];
                const auto skin = model_from_joint[asset.skins[0].joints[joint]] *
                                  asset.skins[0].inverse_binds[joint].as<double>();
                position = position +
                           transform_point(skin, p.positions[v].as<double>()) * double(p.influence_weights[i]);
            }
            box.add(position);
        }
    return box;
}

size_t face_count(const Asset& asset) {
    size_t index_count = 0;
    for (const AssetPrimitive& primitive : asset.meshes[0].primitives) index_count += primitive.indices.size();
    return index_count / 3;
}

void expect_tree(const Asset& asset, const CreatureSettings& settings) {
    ASSERT_EQ(asset.skins.size(), 1u);
    ASSERT_EQ(asset.skins[0].joints.size(), settings.joint_count);
    ASSERT_EQ(asset.skins[0].inverse_binds.size(), settings.joint_count);
    ASSERT_EQ(asset.nodes.size(), settings.joint_count + 1);
    std::vector<uint32_t> level(settings.joint_count, 1);
    for (uint32_t i = 0; i < settings.joint_count; ++i) {
        ASSERT_EQ(asset.skins[0].joints[i], i);
        const uint32_t parent = asset.nodes[i].parent;
        if (i == 0) {
            ASSERT_EQ(parent, kNone);
        } else {
            ASSERT_LT(parent, i);
            level[i] = level[parent] + 1;
        }
    }
    EXPECT_EQ(*std::max_element(level.begin(), level.end()), settings.level_count);
    ASSERT_EQ(asset.mesh_instances.size(), 1u);
    EXPECT_EQ(asset.mesh_instances[0].node, settings.joint_count);
    EXPECT_EQ(asset.nodes[settings.joint_count].parent, kNone);
}

void expect_inverse_binds_undo_rest(const Asset& asset) {
    const Matrices rest = pose(asset);
    for (uint32_t joint = 0; joint < asset.skins[0].joints.size(); ++joint) {
        const auto identity = rest[joint] * asset.skins[0].inverse_binds[joint].as<double>();
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 4; ++c) ASSERT_NEAR(identity.row[r][c], r == c ? 1 : 0, 1e-6) << "joint " << joint;
    }
}

void expect_sound_primitive(const Asset& asset, const AssetPrimitive& p) {
    ASSERT_LT(p.material, asset.materials.size());
    const size_t vertices = p.positions.size();
    ASSERT_EQ(p.normals.size(), vertices);
    ASSERT_EQ(p.colors.size(), vertices);
    ASSERT_EQ(p.influence_joints.size(), 4 * vertices);
    ASSERT_EQ(p.influence_weights.size(), 4 * vertices);
    for (const uint32_t index : p.indices) ASSERT_LT(index, vertices);
    for (size_t v = 0; v < vertices; ++v) {
        const auto& q = p.positions[v];
        ASSERT_TRUE(std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z));
        ASSERT_NEAR(length(p.normals[v].as<double>()), 1, 1e-6) << "vertex " << v;
        double sum = 0;
        for (size_t i = 4 * v; i < 4 * v + 4; ++i) {
            ASSERT_GE(p.influence_weights[i], 0);
            ASSERT_LT(p.influence_joints[i], asset.skins[0].joints.size());
            sum += double(p.influence_weights[i]);
        }
        ASSERT_NEAR(sum, 1, 1e-6) << "vertex " << v;
        for (const float channel : p.colors[v]) ASSERT_TRUE(channel >= 0 && channel <= 1);
    }
}

void expect_sound_mesh(const Asset& asset) {
    ASSERT_EQ(asset.meshes.size(), 1u);
    ASSERT_FALSE(asset.meshes[0].primitives.empty());
    for (const AssetPrimitive& primitive : asset.meshes[0].primitives) expect_sound_primitive(asset, primitive);
}

std::vector<std::string> clips_of(CreatureKind kind) {
    switch (kind) {
        case CreatureKind::kDragon: return {"idle", "walk", "fly", "glide", "roar"};
        case CreatureKind::kWillow: return {"calm", "gust"};
        case CreatureKind::kWalker: return {"idle", "walk", "run", "wave"};
        case CreatureKind::kCentipede: return {"idle", "walk", "curl"};
    }
    return {};
}

void expect_seamless_clips_that_turn_every_joint(const Asset& asset, CreatureKind kind) {
    std::vector<std::string> names;
    for (const AssetClip& clip : asset.clips) names.push_back(clip.name);
    ASSERT_EQ(names, clips_of(kind));
    for (const AssetClip& clip : asset.clips) {
        SCOPED_TRACE(clip.name);
        std::set<uint32_t> turned;
        size_t translations = 0;
        for (const AssetTrack& track : clip.tracks) {
            const size_t components = track.target == TrackTarget::kRotation ? 4 : 3;
            const size_t keys = track.times_s.size();
            ASSERT_EQ(track.values.size(), keys * components);
            ASSERT_EQ(track.times_s.front(), 0);
            ASSERT_EQ(track.times_s.back(), float(clip.duration_s));
            ASSERT_TRUE(std::adjacent_find(track.times_s.begin(), track.times_s.end(), std::greater_equal<>()) ==
                        track.times_s.end());
            ASSERT_TRUE(std::equal(track.values.begin(), track.values.begin() + long(components),
                                   track.values.end() - long(components)));
            bool moves = false;
            for (size_t k = 0; k < keys; ++k) {
                const float* v = &track.values[k * components];
                moves = moves || !std::equal(v, v + components, track.values.begin());
                if (components != 4) continue;
                const auto q = Quaternion<float>{v[0], v[1], v[2], v[3]}.as<double>();
                ASSERT_NEAR(dot(q, q), 1, 1e-6);
            }
            // Values change as fast at the loop's end as at its beginning.
            for (size_t c = 0; c < components && keys > 20; ++c) {
                const float *first = &track.values[c], *last = &track.values[(keys - 1) * components + c];
                ASSERT_NEAR(first[components] - first[0], last[0] - *(last - components), 0.12)
                    << "node " << track.node;
            }
            ASSERT_TRUE(moves) << "node " << track.node;
            if (components == 4)
                turned.insert(track.node);
            else
                ++translations;
        }
        EXPECT_EQ(turned.size(), asset.skins[0].joints.size());
        EXPECT_EQ(translations, 1u);
    }
}

// Long chains must not coil up, unless the clip is for that. On every fifth key, the creature's extent differs from
// that at rest by at most half.
void expect_shape_kept_in_every_clip(const Asset& asset) {
    const double rest_joints = length(box_of_joints(asset, pose(asset)).size());
    const double rest_skin = length(box_of_skin(asset, pose(asset)).size());
    for (const AssetClip& clip : asset.clips)
        for (size_t key = 0; key < clip.tracks[0].times_s.size() && clip.name != "curl"; key += 5) {
            const Matrices posed = pose(asset, &clip, key);
            ASSERT_NEAR(length(box_of_joints(asset, posed).size()), rest_joints, 0.5 * rest_joints) << clip.name << key;
            ASSERT_NEAR(length(box_of_skin(asset, posed).size()), rest_skin, 0.5 * rest_skin) << clip.name << key;
        }
}

TEST(Creature, IsValidForEveryTree) {
    for (const CreatureKind kind : kCreatureKinds)
        for (const CreatureSettings& settings : grid(kind)) {
            SCOPED_TRACE(text_of(settings));
            const Asset asset = creature(settings);
            expect_tree(asset, settings);
            expect_inverse_binds_undo_rest(asset);
            expect_sound_mesh(asset);
            expect_seamless_clips_that_turn_every_joint(asset, kind);
            expect_shape_kept_in_every_clip(asset);
            if (HasFailure()) return;
        }
}

TEST(Creature, HasExactlyTheLargestTrees) {
    std::vector<CreatureSettings> largest;  // dragons only: all kinds share the code, and each takes long
    for (const CreatureKind kind : kCreatureKinds) largest.push_back({4000, 60, 1500, 7, kind});
    for (const uint32_t levels : {2u, 60u, 65535u}) largest.push_back({65535, levels, 1500, 7});
    for (const CreatureSettings& settings : largest) {
        SCOPED_TRACE(text_of(settings));
        const Asset asset = creature(settings);
        expect_tree(asset, settings);
        size_t key_bytes = 0;
        for (const AssetClip& clip : asset.clips)
            for (const AssetTrack& track : clip.tracks)
                key_bytes += (track.times_s.size() + track.values.size()) * sizeof(float);
        EXPECT_LE(key_bytes, 65u << 20);
        if (settings.level_count == 60) {
            EXPECT_TRUE(write_glb(asset).ok());
        }
    }
}

TEST(Creature, MeshIsNearItsFaceBudget) {
    const auto faces_of = [](const CreatureSettings& settings) { return face_count(creature(settings)); };
    const auto expect_near = [&](const CreatureSettings& settings) {
        const double made = double(faces_of(settings)), wanted = settings.face_count;
        EXPECT_LE(made, wanted) << text_of(settings);
        EXPECT_GE(made, 0.95 * wanted) << text_of(settings);
    };
    for (const uint32_t faces : {300u, 1000u, 1500u, 3000u, 20000u, 200000u}) {
        for (const auto& [joints, levels] : {std::pair{1u, 1u},
                                             {17u, 17u},
                                             {20u, 8u},
                                             {64u, 15u},
                                             {300u, 15u},
                                             {300u, 120u},
                                             {300u, 2u},
                                             {4000u, 60u}})
            expect_near({joints, levels, faces, 3});
        for (const CreatureKind kind : kCreatureKinds)
            for (const auto& [joints, levels] : {std::pair{1u, 1u}, {20u, 8u}, {300u, 60u}})
                expect_near({joints, levels, faces, 3, kind});
    }
    for (const CreatureKind kind : kCreatureKinds)
        for (const uint32_t faces : {0u, 10u, 50u, 100u, 200u}) {
            const size_t made = faces_of({300, 30, faces, 3, kind});
            EXPECT_GE(made, std::min(faces / 2, 4u));
            EXPECT_LE(made, std::max(faces, 24u));
        }
}

TEST(Creature, HasSizesOfItsKind) {
    for (const CreatureKind kind : kCreatureKinds) {
        const CreatureSettings usual = creature_settings(kind);
        SCOPED_TRACE(text_of(usual));
        EXPECT_EQ(usual.kind, kind);
        EXPECT_GE(usual.face_count, 1000u);
        EXPECT_LE(usual.face_count, 3000u);
        const Asset asset = creature(usual);
        expect_tree(asset, usual);
        EXPECT_NEAR(double(face_count(asset)), usual.face_count, 10);
        const Result<Character> compiled = compile_character(asset);
        ASSERT_TRUE(compiled.ok());
        EXPECT_EQ(compiled->clips.size(), clips_of(kind).size());
    }
}

// Checks the lowest point of the skin at every key of the standing and walking clips of a default creature.
TEST(Creature, KeepsItsFeetOnTheGround) {
    for (const CreatureKind kind : kCreatureKinds) {
        const Asset asset = creature(creature_settings(kind));
        for (const AssetClip& clip : asset.clips) {
            if (clip.name == "fly" || clip.name == "glide") continue;
            const double jump = clip.name == "run" ? 0.2 : clip.name == "walk" ? 0.08 : 0.05;
            for (size_t key = 0; key < clip.tracks[0].times_s.size(); ++key) {
                const double lowest = box_of_skin(asset, pose(asset, &clip, key)).least.y;
                ASSERT_GT(lowest, -0.08) << kNames[size_t(kind)] << " " << clip.name << " " << key;
                ASSERT_LT(lowest, jump) << kNames[size_t(kind)] << " " << clip.name << " " << key;
            }
        }
    }
}

TEST(Creature, TheCentipedeCurlsUp) {
    const Asset asset = creature(creature_settings(CreatureKind::kCentipede));
    const AssetClip& curl = asset.clips[2];
    const double straight = length(box_of_skin(asset, pose(asset, &curl, 0)).size());
    const double curled = length(box_of_skin(asset, pose(asset, &curl, curl.tracks[0].times_s.size() / 2)).size());
    EXPECT_LT(curled, 0.6 * straight);
}

TEST(Creature, KindsAreFoundByName) {
    for (const CreatureKind kind : kCreatureKinds) EXPECT_EQ(*creature_kind(kNames[size_t(kind)]), kind);
    EXPECT_EQ(creature_kind("unicorn").error().message,
              "there is no 'unicorn'. There are: dragon, willow, walker, centipede");
}

TEST(Creature, StandsOnTheGroundAndFacesForward) {
    const Asset asset = creature({});
    const Box box = box_of_skin(asset, pose(asset));
    EXPECT_NEAR(box.least.y, 0, 0.05);
    EXPECT_NEAR(box.most.y, 2.3, 0.4);
    EXPECT_NEAR(box.size().z, 4, 0.5);
    EXPECT_NEAR(box.least.x, -box.most.x, 1e-4);
    const auto size_of = [](CreatureKind kind) {
        const Asset other = creature(creature_settings(kind));
        return box_of_skin(other, pose(other)).size();
    };
    EXPECT_NEAR(size_of(CreatureKind::kWillow).y, 2, 0.3);
    EXPECT_NEAR(size_of(CreatureKind::kWalker).y, 2, 0.1);
    EXPECT_NEAR(size_of(CreatureKind::kCentipede).y, 0.4, 0.15);
    EXPECT_NEAR(size_of(CreatureKind::kCentipede).z, 6, 0.5);
}

TEST(Creature, NormalsPointOutward) {
    // Down at the belly and up at the back: the body is the first piece of the mesh.
    const AssetPrimitive p = creature({}).meshes[0].primitives[0];
    const auto pointing = [&](bool top) {
        size_t best = 0;
        for (size_t v = 0; v < 200; ++v) {
            const bool at_hips = std::abs(p.positions[v].z + 0.2f) < 0.2f;
            const bool at_best = std::abs(p.positions[best].z + 0.2f) < 0.2f;
            if (at_hips && (!at_best || (p.positions[v].y > p.positions[best].y) == top)) best = v;
        }
        return p.normals[best].y;
    };
    EXPECT_GT(pointing(true), 0.8f);
    EXPECT_LT(pointing(false), -0.8f);
}

TEST(Creature, IsTheSameForTheSameSettingsOnly) {
    for (const CreatureKind kind : kCreatureKinds) {
        const CreatureSettings settings{300, 60, 1500, 5, kind};
        const auto bytes = write_glb(creature(settings));
        ASSERT_TRUE(bytes.ok());
        EXPECT_EQ(*bytes, *write_glb(creature(settings)));
        CreatureSettings other = settings;
        other.seed = 6;
        EXPECT_NE(*bytes, *write_glb(creature(other)));
    }
}

TEST(Creature, ErrorsNameTheWrongOption) {
    const auto place = [](const CreatureSettings& settings) {
        const Result<Asset> made = make_creature(settings);
        EXPECT_FALSE(made.ok());
        return made.ok() ? "" : made.error().place;
    };
    EXPECT_EQ(place({0, 1, 100, 1}), "joints");
    EXPECT_EQ(place({65536, 60, 100, 1}), "joints");
    EXPECT_EQ(place({10, 0, 100, 1}), "levels");
    EXPECT_EQ(place({10, 11, 100, 1}), "levels");
    EXPECT_EQ(place({10, 1, 100, 1}), "levels");
    EXPECT_EQ(place({10, 5, 10'000'001, 1}), "faces");
}

}  // namespace
}  // namespace throng
