// Skinned vertices against the reference: 4 and 8 influences, several sections and instances, both blend modes.
#include "skin/skin.h"
#include "morph/morph_io.h"
#include "skin/skin_reference.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/test_rig.h"
#include "tests/upload_now.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>

namespace throng {
namespace {

const test::InSubset kSkinInSubsets({test::Subset::kGpuAssisted}, {"Skin.*"});
const test::InSubset kSkinNatively({test::Subset::kNative}, {"Skin.*"});

using namespace test;

void normalize_weights(std::span<Influences> of_vertex) {
    float sum = 0;
    for (Influences& four : of_vertex) sum += std::accumulate(four.weights.begin(), four.weights.end(), 0.0f);
    if (sum == 0) of_vertex[0].weights[0] = sum = 1;
    for (Influences& four : of_vertex)
        for (float& weight : four.weights) weight /= sum;
}

// Sections in any order and of any size. No section uses the pools' first elements.
// `sums_to_one`: weights sum to 1, as dual quaternions need.
Character make_mesh(Random& random, uint32_t palette_count, const std::vector<std::pair<uint32_t, uint32_t>>& sections,
                    bool sums_to_one = false) {
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
        section.morph_count = character.sections.size() % 2 == 0 ? 0 : 1 + random.below(4);
        character.morphs.resize(character.morphs.size() + section.morph_count);
        character.sections.push_back(section);
        for (uint32_t v = 0; v < vertex_count; ++v) {
            character.vertices.push_back(
                {.position = random.vector(1).as<float>(), .normal_octahedral = random.below(0xFFFFFFFFu)});
            if (section.morph_count > 0 && random.chance(0.7)) {
                character.vertices.back().first_delta = static_cast<uint32_t>(character.morph_deltas.size() + 1);
                for (uint32_t m = 0; m < section.morph_count; ++m)
                    character.morph_deltas.push_back({.position = random.vector(0.2).as<float>()});
            }
            const size_t first = character.influences.size();
            for (uint32_t set = 0; set < influence_sets; ++set) {
                Influences influences;
                for (size_t i = 0; i < 4; ++i) {
                    influences.weights[i] = random.chance(0.4) ? 0.0f
                                                               : static_cast<float>(random.unit()) /
                                                                     static_cast<float>(influence_sets);
                    influences.entries[i] = static_cast<uint16_t>(random.below(palette_count));
                }
                character.influences.push_back(influences);
            }
            if (sums_to_one) normalize_weights(std::span(character.influences).subspan(first));
        }
    }
    return character;
}

// Decodes an octahedral normal, with the kernel's rounding.
Vec3<double> unpacked(uint32_t octahedral) {
    const auto fraction = [](uint32_t bits) { return std::max(static_cast<int16_t>(bits & 0xFFFF) / 32767.0, -1.0); };
    const double x = fraction(octahedral), y = fraction(octahedral >> 16), z = 1 - std::abs(x) - std::abs(y);
    if (z >= 0) return normalized(Vec3<double>{x, y, z});
    return normalized(Vec3<double>{(1 - std::abs(y)) * (x < 0 ? -1 : 1), (1 - std::abs(x)) * (y < 0 ? -1 : 1), z});
}

// Transforms by the inverse transpose: cross products of the columns over the determinant.
Vec3<double> transformed_normal(const AffineT<double>& m, const Vec3<double>& n) {
    const auto column = [&](size_t k) { return Vec3<double>{m.row[0][k], m.row[1][k], m.row[2][k]}; };
    const Vec3<double> sum = cross(column(1), column(2)) * n.x + cross(column(2), column(0)) * n.y +
                             cross(column(0), column(1)) * n.z;
    return normalized(determinant(m) < 0 ? sum * -1.0 : sum);
}

struct SkinCase {
    uint32_t instance = 0, instance_count = 1;
    SkinFormat format = SkinFormat::kAffine;
    SkinBlend blend = SkinBlend::kLinear;
};

struct Skinned {
    std::vector<SkinnedVertex> got;
    std::vector<Vec3<double>> wanted;
    std::vector<Vec3<double>> wanted_normals;
};

std::vector<uint32_t> stored(SkinFormat format, const AffineT<double>& matrix, const Trs<double>& parts) {
    std::vector<float> floats;
    if (format == SkinFormat::kSimilarity) {
        const auto& [q, t, s] = parts.as<float>();
        floats = {q.x, q.y, q.z, q.w, t.x, t.y, t.z, s.x};
    } else {
        for (const auto& row : matrix.row)
            for (const double x : row) floats.push_back(static_cast<float>(x));
    }
    std::vector<uint32_t> words(floats.size());
    std::memcpy(words.data(), floats.data(), floats.size() * sizeof(float));
    return words;
}

// One of several instances, all sections.
Skinned run_skin(const Character& character, const SkinCase& of, Random& random) {
    const auto palette_count = static_cast<uint32_t>(character.palette.size());
    std::vector<uint32_t> matrices;
    std::vector<AffineT<double>> of_instance;
    for (uint32_t i = 0; i < of.instance_count; ++i)
        for (uint32_t entry = 0; entry < palette_count; ++entry) {
            Trs<double> parts = random.trs(2, 0.5);
            if (of.blend != SkinBlend::kLinear) parts.scale = {parts.scale.x, parts.scale.x, parts.scale.x};
            const std::vector<uint32_t> words = stored(of.format, to_affine(parts), parts);
            matrices.insert(matrices.end(), words.begin(), words.end());
            if (i == of.instance) of_instance.push_back(to_affine(parts.as<float>().as<double>()));
        }
    // Morphs of all sections; anywhere from none up to the limit.
    constexpr uint32_t kShown = 8;
    std::vector<io::ActiveMorph> shown(of.instance_count * size_t{kShown});
    std::vector<WeightedMorph> of_instance_shown;
    for (uint32_t i = 0; i < of.instance_count; ++i)
        for (uint32_t k = 0, count = character.morphs.empty() ? 0 : random.below(kShown + 1); k < count; ++k) {
            const uint32_t morph = random.below(static_cast<uint32_t>(character.morphs.size()));
            const auto weight = static_cast<float>(random.between(-1, 1));
            shown[i * kShown + k] = {morph, weight};
            if (i == of.instance) of_instance_shown.push_back({morph, double{weight}});
        }
    Buffers tables;
    upload_now([&](Uploads& uploads) { upload_skin_tables(uploads, character, std::array{0u}, tables); });
    const Guarded<MorphDelta> deltas(character.morph_deltas);
    const Guarded<io::ActiveMorph> active(shown);
    const Guarded<Vertex> vertices(character.vertices);
    const Guarded<Influences> influences(character.influences);
    const Guarded<uint32_t> skin_matrices(matrices);
    const Guarded<SkinnedVertex> skinned(poison<SkinnedVertex>(character.vertices.size()));
    const Kernel kernel = skin_kernel(test_gpu(), of.format, of.blend, SkinScope::kFinest);
    run_workgroups(kernel,
                   BufferTable{{io::kVerticesBuffer, vertices},
                               {io::kInfluencesBuffer, influences},
                               {io::kSkinBuffer, skin_matrices},
                               {io::kSkinnedBuffer, skinned},
                               {io::kMorphDeltasBuffer, deltas},
                               {io::kActiveMorphsBuffer, active},
                               {io::kSkinSectionsBuffer, tables[io::kSkinSectionsBuffer]},
                               {io::kListedVerticesBuffer, tables[io::kListedVerticesBuffer]},
                               {io::kListBuffer, vertices},
                               {io::kVerdictsBuffer, vertices},
                               {io::kSkinRowsBuffer, vertices}},
                   io::SkinPush{.section_count = static_cast<uint32_t>(character.sections.size()),
                                .vertex_count = static_cast<uint32_t>(character.vertices.size()),
                                .palette_count = palette_count,
                                .first_instance = of.instance,
                                .influence_offset = 0,
                                .only_animated = 0,
                                .has_skin_pool = 0,
                                .active_morph_limit = kShown},
                   1);
    Skinned out{skinned.read(), skin_reference(character, of_instance, of_instance_shown, of.blend), {}};
    for (const MeshSection& section : character.sections) {
        for (uint32_t v = 0; v < section.vertex_count; ++v) {
            BlendedTransform blended(of.blend);
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& four =
                    character.influences[section.first_influences + v * section.influence_sets + set];
                for (size_t i = 0; i < 4; ++i)
                    if (four.weights[i] != 0) blended.add(double{four.weights[i]}, of_instance[four.entries[i]]);
            }
            const AffineT<double> transform = blended.result();
            // A matrix that flattens has no normals
            const bool known = section.morph_count == 0 && std::abs(determinant(transform)) > 0.01;
            out.wanted_normals.push_back(
                known ? transformed_normal(transform,
                                           unpacked(character.vertices[section.first_vertex + v].normal_octahedral))
                      : Vec3<double>{});
        }
    }
    return out;
}

double distance(const Vec3<float>& got, const Vec3<double>& wanted) {
    const double d = length(got.as<double>() - wanted);
    return std::isnan(d) ? 1e9 : d;
}

// Largest errors of positions, and of normals in radians.
struct Errors {
    double position = 0, normal = 0;
    size_t positions = 0, normals = 0;

    void add(const Skinned& skinned) {
        ASSERT_EQ(skinned.got.size(), skinned.wanted.size());
        for (size_t v = 0; v < skinned.got.size(); ++v) {
            position = std::max(position, distance(skinned.got[v].position, skinned.wanted[v]));
            ++positions;
            if (length(skinned.wanted_normals[v]) == 0) continue;
            normal = std::max(normal, length(unpacked(skinned.got[v].normal_octahedral) - skinned.wanted_normals[v]));
            ++normals;
        }
    }
};

TEST(Skin, FollowsTheReference) {
    Errors errors;
    for (const uint32_t palette_count : {1u, 40u, 65'536u}) {
        Random random(palette_count);
        const Character character = make_mesh(random, palette_count,
                                              {{1, 1}, {63, 2}, {64, 1}, {65, 2}, {200, 1}, {7, 3}});
        for (const uint32_t instance : {0u, 1u, 2u}) errors.add(run_skin(character, {instance, 3}, random));
    }
    EXPECT_LE(errors.position, 3e-6);
    EXPECT_LE(errors.normal, 1e-4);
    EXPECT_GT(errors.normals, 1000u);
    std::printf(
        "  %zu vertices in 6 sections, 4 to 12 influences: largest error %.1e of about 3; of %zu normals %.1e rad\n",
        errors.positions, errors.position, errors.normals, errors.normal);
}

TEST(Skin, DualQuaternionsFollowTheReference) {
    for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kSimilarity}) {
        Errors errors;
        Random random(9);
        const Character character = make_mesh(random, 40, {{1, 1}, {130, 2}, {65, 1}, {7, 3}}, true);
        for (const uint32_t instance : {0u, 2u})
            errors.add(run_skin(character, {instance, 3, format, SkinBlend::kDualQuaternion}, random));
        EXPECT_LE(errors.position, 3e-5);
        EXPECT_LE(errors.normal, 1e-4);
        EXPECT_GT(errors.normals, 50u);
        std::printf("  %zu vertices: largest error %.1e; of %zu normals %.1e rad\n", errors.positions, errors.position,
                    errors.normals, errors.normal);
    }
}

TEST(Skin, TheReferenceBlendsPositionsByWeight) {
    Character character;
    character.vertices = {{.position = {1, 2, 3}}};
    character.influences = {{.weights = {0.25f, 0.75f, 0, 0}, .entries = {1, 0, 9, 9}}};
    character.sections = {{.vertex_count = 1, .influence_sets = 1}};
    std::vector<AffineT<double>> skin(2);
    skin[0].row[0][3] = 4;   // moves by 4 along x
    skin[1].row[1][3] = -8;  // moves by -8 along y
    EXPECT_EQ(skin_reference(character, skin)[0], (Vec3<double>{1 + 3, 2 - 2, 3}));
}

AffineT<double> blended(SkinBlend blend, const AffineT<double>& a, const AffineT<double>& b, double weight_of_a) {
    BlendedTransform transform(blend);
    transform.add(weight_of_a, a);
    transform.add(1 - weight_of_a, b);
    return transform.result();
}

// Kavan's example: halfway along a forearm twisted by 170 degrees, linear blending keeps a twelfth of the girth, dual
// quaternions all of it.
TEST(Skin, DualQuaternionsKeepTheGirthOfATwistedLimb) {
    constexpr double kTwist = 170 * 3.14159265358979 / 180;
    const AffineT<double> twisted = to_affine(Trs<double>{axis_angle(Vec3<double>{1, 0, 0}, kTwist), {}, {1, 1, 1}});
    const Vec3<double> skin{0.7, 0.6, 0.8};
    const auto girth = [&](SkinBlend blend) {
        const Vec3<double> p = transform_point(blended(blend, {}, twisted, 0.5), skin);
        EXPECT_NEAR(p.x, 0.7, 1e-12) << "along the limb";
        return std::hypot(p.y, p.z);
    };
    EXPECT_NEAR(girth(SkinBlend::kLinear), std::cos(kTwist / 2), 1e-12);
    EXPECT_NEAR(girth(SkinBlend::kDualQuaternion), 1, 1e-12);
}

// A bend about an elbow far from the origin stays a bend about the elbow. A single transform is applied unchanged, for
// either sign of the quaternions.
TEST(Skin, DualQuaternionsDoNotDependOnTheOrigin) {
    Random random(4);
    for (int round = 0; round < 50; ++round) {
        Trs<double> parts = random.trs(5, 0.5);
        parts.scale = {parts.scale.x, parts.scale.x, parts.scale.x};
        const AffineT<double> one = to_affine(parts),
                              moved = to_affine(Trs<double>{random.rotation(), random.vector(20), {1, 1, 1}});
        const Vec3<double> p = random.vector(3);
        constexpr SkinBlend kBlend = SkinBlend::kDualQuaternion;
        EXPECT_LE(length(transform_point(blended(kBlend, one, one, 0.3), p) - transform_point(one, p)), 1e-12);
        parts.rotation = random.rotation();
        parts.scale = {1, 1, 1};
        const AffineT<double> rigid = to_affine(Trs<double>{random.rotation(), random.vector(2), {1, 1, 1}}),
                              other = to_affine(parts);
        EXPECT_LE(length(transform_point(blended(kBlend, moved * rigid, moved * other, 0.6), p) -
                         transform_point(moved * blended(kBlend, rigid, other, 0.6), p)),
                  1e-10)
            << "in another place likewise";
    }
}

}  // namespace
}  // namespace throng
