// Skinned positions against the reference: 4 and 8 influences, several sections, several instances.
#include "skin/skin.h"
#include "morph/morph_io.h"
#include "skin/skin_reference.h"
#include "tests/kernel_runner.h"
#include "tests/test_rig.h"

#include <cmath>
#include <cstdio>

namespace throng {
namespace {

using namespace test;

// Sections in any order and of any size, the pools' first elements used by none of them.
Character make_mesh(Random& random, uint32_t palette_count, const std::vector<std::pair<uint32_t, uint32_t>>& sections) {
    Character character;
    character.palette.resize(palette_count);
    character.influences.resize(5);
    character.morph_deltas.resize(3);
    for (const auto& [vertex_count, influence_sets] : sections) {
        MeshSection section;
        section.first_vertex = static_cast<uint32_t>(character.vertices.size());
        section.vertex_count = vertex_count;
        section.first_influences = static_cast<uint32_t>(character.influences.size());
        section.influence_sets = influence_sets;
        section.first_morph = static_cast<uint32_t>(character.morphs.size());
        section.morph_count = random.below(5);
        character.morphs.resize(character.morphs.size() + section.morph_count);
        character.sections.push_back(section);
        for (uint32_t v = 0; v < vertex_count; ++v) {
            character.vertices.push_back({.position = random.vector(1).as<float>()});
            if (section.morph_count > 0 && random.chance(0.7)) {
                character.vertices.back().first_delta = static_cast<uint32_t>(character.morph_deltas.size() + 1);
                for (uint32_t m = 0; m < section.morph_count; ++m) character.morph_deltas.push_back({.position = random.vector(0.2).as<float>()});
            }
            for (uint32_t set = 0; set < influence_sets; ++set) {
                Influences influences;
                for (size_t i = 0; i < 4; ++i) {
                    influences.weights[i] = random.chance(0.4) ? 0.0f : static_cast<float>(random.unit()) / static_cast<float>(influence_sets);
                    influences.entries[i] = static_cast<uint16_t>(random.below(palette_count));
                }
                character.influences.push_back(influences);
            }
        }
    }
    return character;
}

struct Skinned {
    std::vector<io::vec4> got;
    std::vector<Vec3<double>> wanted;
};

// One instance of several, every section but `left_out`.
Skinned run_skin(const Character& character, uint32_t instance, uint32_t instance_count, uint32_t left_out, Random& random) {
    const auto palette_count = static_cast<uint32_t>(character.palette.size());
    std::vector<Affine> matrices;
    std::vector<AffineT<double>> of_instance;
    for (uint32_t i = 0; i < instance_count; ++i)
        for (uint32_t entry = 0; entry < palette_count; ++entry) {
            matrices.push_back(to_affine(random.trs(2, 0.5)).as<float>());
            if (i == instance) of_instance.push_back(matrices.back().as<double>());
        }
    // Of morphs of all sections, fewer than all, none.
    std::vector<io::ActiveMorph> shown(instance_count * size_t{io::kActiveMorphs});
    std::vector<WeightedMorph> of_instance_shown;
    for (uint32_t i = 0; i < instance_count; ++i)
        for (uint32_t k = 0, count = character.morphs.empty() ? 0 : random.below(io::kActiveMorphs + 1); k < count; ++k) {
            const uint32_t morph = random.below(static_cast<uint32_t>(character.morphs.size()));
            const auto weight = static_cast<float>(random.between(-1, 1));
            shown[i * io::kActiveMorphs + k] = {morph, weight};
            if (i == instance) of_instance_shown.push_back({morph, double{weight}});
        }
    const Guarded<MorphDelta> deltas(character.morph_deltas);
    const Guarded<io::ActiveMorph> active(shown);
    const Guarded<Vertex> vertices(character.vertices);
    const Guarded<Influences> influences(character.influences);
    const Guarded<Affine> skin_matrices(matrices);
    const Guarded<io::vec4> positions(poison<io::vec4>(character.vertices.size()));
    const Kernel kernel = skin_kernel(test_gpu(), SkinFormat::kAffine);
    for (uint32_t s = 0; s < character.sections.size(); ++s) {
        const MeshSection& section = character.sections[s];
        if (s == left_out) continue;
        run_invocations(kernel, SkinBuffers{vertices, influences, skin_matrices, positions, deltas, active},
                        io::SkinPush{.first_vertex = section.first_vertex, .vertex_count = section.vertex_count, .first_influences = section.first_influences, .influence_sets = section.influence_sets, .first_palette_entry = instance * palette_count, .first_morph = section.first_morph, .morph_count = section.morph_count, .first_active = instance * io::kActiveMorphs},
                        section.vertex_count);
    }
    return {positions.read(), skin_reference(character, of_instance, of_instance_shown)};
}

double distance(const io::vec4& got, const Vec3<double>& wanted) {
    const double d = length(Vec3<double>{got.x, got.y, got.z} - wanted);
    return std::isnan(d) ? 1e9 : d;
}

TEST(Skin, FollowsTheReference) {
    double worst = 0;
    size_t compared = 0;
    for (const uint32_t palette_count : {1u, 40u, 65'536u}) {
        Random random(palette_count);
        const Character character = make_mesh(random, palette_count, {{1, 1}, {63, 2}, {64, 1}, {65, 2}, {200, 1}, {7, 3}});
        for (const uint32_t instance : {0u, 1u, 2u}) {
            const Skinned skinned = run_skin(character, instance, 3, kNone, random);
            ASSERT_EQ(skinned.got.size(), skinned.wanted.size());
            for (size_t v = 0; v < skinned.got.size(); ++v) {
                worst = std::max(worst, distance(skinned.got[v], skinned.wanted[v]));
                EXPECT_EQ(skinned.got[v].w, 1);
            }
            compared += skinned.got.size();
        }
    }
    EXPECT_LE(worst, 3e-6);
    std::printf("  %zu vertices in 6 sections, 4 to 12 influences: largest error %.1e of about 3\n", compared, worst);
}

TEST(Skin, ASectionWritesOnlyItsVertices) {
    Random random(8);
    const Character character = make_mesh(random, 10, {{50, 1}, {50, 2}, {50, 1}});
    const Skinned skinned = run_skin(character, 0, 1, 1, random);
    for (size_t v = 0; v < skinned.got.size(); ++v) {
        if (v >= 50 && v < 100) {
            EXPECT_TRUE(std::isnan(skinned.got[v].x)) << "vertex " << v << " belongs to the section that was left out";
        } else {
            EXPECT_LE(distance(skinned.got[v], skinned.wanted[v]), 3e-6) << "vertex " << v;
        }
    }
}

TEST(Skin, TheReferenceWeighsPositions) {
    Character character;
    character.vertices = {{.position = {1, 2, 3}}};
    character.influences = {{.weights = {0.25f, 0.75f, 0, 0}, .entries = {1, 0, 9, 9}}};
    character.sections = {{.vertex_count = 1, .influence_sets = 1}};
    std::vector<AffineT<double>> skin(2);
    skin[0].row[0][3] = 4;   // moves by 4 along x
    skin[1].row[1][3] = -8;  // by -8 along y
    EXPECT_EQ(skin_reference(character, skin)[0], (Vec3<double>{1 + 3, 2 - 2, 3}));
}

}  // namespace
}  // namespace throng
