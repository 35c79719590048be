// Looks: a part that an outfit hides is as if it were absent. A tint or another material gives the same picture as if
// the file had it.
#include "tests/ball.h"
#include "tests/crowd_cases.h"
#include "tests/draw_path.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <set>

namespace throng::test {
namespace {

const InSubset kLookInSubsets({Subset::kGpuAssisted}, {"*Looks.HiddenSectionsAreNotDrawn/ByShaders"}),
    kLookOnOtherDrivers({Subset::kOtherDriver}, {"-*Looks.*"}), kLookNatively({Subset::kNative}, {"*Looks.*"});

// A creature in two sections, named "creature": the second has every third triangle and its own material.
Asset in_two_sections() {
    Asset asset = make_creature({.joint_count = 30, .level_count = 10}).value();
    std::vector<AssetPrimitive>& primitives = asset.meshes[0].primitives;
    primitives.push_back(primitives[0]);
    asset.materials.push_back(asset.materials[primitives[0].material]);
    asset.materials[0].name = "first";
    asset.materials[1].name = "second";
    primitives[1].material = 1;
    const std::vector<uint32_t> all = primitives[0].indices;
    for (AssetPrimitive& primitive : primitives) primitive.indices.clear();
    for (size_t triangle = 0; triangle < all.size() / 3; ++triangle)
        for (size_t i = 0; i < 3; ++i) primitives[triangle % 3 == 0].indices.push_back(all[3 * triangle + i]);
    return asset;
}

Character without_lods(const Asset& asset) { return compile_character(asset, {.lods = false}).value(); }

constexpr uint32_t kLookCount = 6;

class Looks : public testing::TestWithParam<DrawPath> {
protected:
    void SetUp() override {
        if (const std::string reason = undrawable_reason(GetParam()); !reason.empty()) GTEST_SKIP() << reason;
    }
    Crowd crowd_of(const Character& character, std::vector<Outfit> outfits = {}, bool culls = true) const {
        CrowdSettings settings{.groups = {{.character = &character, .outfits = std::move(outfits)}}};
        settings.groups[0].instance_count = kLookCount;
        if (culls) settings.culling.emplace();
        Crowd crowd = create(settings);
        std::vector<Affine> places;
        for (uint32_t i = 0; i < kLookCount; ++i)
            places.push_back(to_affine(
                Trs<float>{.translation = Vec3<float>{static_cast<float>(i), 0, 0} * (0.7f * character.size)}));
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
        EXPECT_TRUE(crowd.set_playback(crowd.instances(), {.first = {.clip = 0, .time_s = 0.3}}));
        return crowd;
    }
    std::vector<uint8_t> picture_of(Crowd& crowd) {
        if (!renderer_)
            renderer_.emplace(
                Renderer::create(test_device(), {.width = 240, .height = 120, .path = GetParam()}).value());
        EXPECT_TRUE(crowd.update(0));
        const float size = without_lods(asset_).size;
        const Camera camera{.eye = Vec3<float>{2, 1, 3} * size, .target = Vec3<float>{1.5f, 0.3f, 0} * size};
        return renderer_->render(crowd, camera).value().picture.rgba;
    }

    Asset asset_ = in_two_sections();
    std::optional<Renderer> renderer_;
};

// The largest difference between two bytes.
int difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    int most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

TEST_P(Looks, HiddenSectionsAreNotDrawn) {
    Asset first_alone = asset_;
    first_alone.meshes[0].primitives[1].indices.clear();
    const Character both = without_lods(asset_), first = without_lods(first_alone);
    for (const bool culls : {false, true}) {
        Crowd all = crowd_of(both, {}, culls), wanted = crowd_of(first, {}, culls),
              crowd = crowd_of(both, {{}, {{{.section = 1, .is_shown = false}}}}, culls);
        const std::vector<uint8_t> of_all = picture_of(all), of_first = picture_of(wanted);
        EXPECT_GT(difference(of_all, of_first), 30);
        EXPECT_EQ(picture_of(crowd), of_all) << "the first outfit shows everything";
        ASSERT_TRUE(crowd.set_look(crowd.instances(), {.outfit = 1}));
        EXPECT_EQ(picture_of(crowd), of_first);
        ASSERT_TRUE(crowd.set_look(crowd.instances(), InstanceLook{}));
        EXPECT_EQ(picture_of(crowd), of_all) << "and it comes back";
    }
}

TEST_P(Looks, ColorsMultiplyTheMaterials) {
    const std::array<float, 3> color{0.2f, 0.9f, 0.4f}, tint{0.5f, 0.25f, 1};
    Asset colored = asset_;
    for (size_t i = 0; i < 3; ++i) {
        colored.materials[0].base_color[i] *= tint[i];
        colored.materials[1].base_color[i] *= color[i] * (0.25f + 0.75f * tint[i]);
    }
    const Character character = without_lods(asset_), wanted_character = without_lods(colored);
    Crowd plain = crowd_of(character), wanted = crowd_of(wanted_character),
          crowd = crowd_of(character, {{}, {{{.section = 1, .color = color, .tint = 0.75f}}}});
    ASSERT_TRUE(crowd.set_look(crowd.instances(), {.tint = tint, .outfit = 1}));
    const std::vector<uint8_t> picture = picture_of(crowd);
    EXPECT_GT(difference(picture, picture_of(plain)), 30);
    EXPECT_LE(difference(picture, picture_of(wanted)), 1);
}

// Materials of every way of drawing, with and without a texture.
TEST_P(Looks, ReplacedMaterialsEqualThoseOfAFile) {
    Asset dressed = asset_;
    const auto add = [&](const AssetMaterial& material) { dressed.materials.push_back(material); };
    dressed.images.push_back({.name = "stripes", .encoded = png_bytes({2, 1, {255, 40, 40, 255, 40, 40, 255, 255}})});
    for (AssetPrimitive& primitive : dressed.meshes[0].primitives)
        for (const Vec3<float>& position : primitive.positions)
            primitive.texcoords.push_back({3 * position.x, 3 * position.y});
    add({.name = "striped", .base_color = {0.9f, 0.8f, 0.7f, 1}, .image = 0});
    add({.name = "in part", .base_color = {0.2f, 0.2f, 0.9f, 0.5f}, .alpha_mode = AlphaMode::kBlend});
    add({.name = "glowing", .base_color = {0.1f, 0.1f, 0.1f, 1}, .emissive = {0.9f, 0.5f, 0.1f}});
    const Character character = without_lods(dressed);
    const auto material_count = static_cast<uint32_t>(dressed.materials.size());
    std::vector<Outfit> outfits(1);
    for (uint32_t material = 0; material < material_count; ++material)
        outfits.push_back({{{.section = 1, .material = material}}});
    for (const bool culls : {false, true}) {
        Crowd crowd = crowd_of(character, outfits, culls);
        const std::vector<uint8_t> own = picture_of(crowd);
        std::set<std::vector<uint8_t>> pictures;
        for (uint32_t material = 1; material < material_count; ++material) {
            Asset asset = dressed;
            asset.meshes[0].primitives[1].material = material;
            const Character of_file = without_lods(asset);
            Crowd wanted = crowd_of(of_file, {}, culls);
            ASSERT_TRUE(crowd.set_look(crowd.instances(), {.outfit = 1 + material}));
            const std::vector<uint8_t> picture = picture_of(crowd);
            EXPECT_EQ(picture, picture_of(wanted)) << material;
            EXPECT_TRUE(pictures.insert(picture).second) << material;
        }
        // With a different material on each instance, the picture differs from all of those
        for (uint32_t i = 0; i < kLookCount; ++i)
            ASSERT_TRUE(crowd.set_look(InstanceHandle{i}, {.outfit = 1 + i % material_count}));
        EXPECT_TRUE(pictures.insert(picture_of(crowd)).second);
        ASSERT_TRUE(crowd.set_look(crowd.instances(), InstanceLook{}));
        EXPECT_EQ(picture_of(crowd), own);
    }
}

// Setting one instance's look does not change another's.
TEST_P(Looks, EachInstanceHasItsOwnLook) {
    const Character character = without_lods(asset_);
    std::set<std::vector<uint8_t>> pictures;
    Crowd crowd = crowd_of(character, {{}, {{{.section = 0, .is_shown = false}}}});
    pictures.insert(picture_of(crowd));
    for (uint32_t i = 0; i < 4; ++i) {
        ASSERT_TRUE(crowd.set_look(InstanceHandle{i}, {.tint = {1, 0, 0}, .outfit = i % 2}));
        EXPECT_TRUE(pictures.insert(picture_of(crowd)).second) << i;
    }
    std::vector<InstanceLook> looks(kLookCount);
    ASSERT_TRUE(crowd.set_look(crowd.instances(), looks));
    EXPECT_FALSE(pictures.insert(picture_of(crowd)).second) << "as at first";
    for (uint32_t i = 0; i < kLookCount; ++i) looks[i] = {.tint = {0.1f, 0.2f, static_cast<float>(i)}, .outfit = i % 2};
    ASSERT_TRUE(crowd.set_look(crowd.instances(), looks));
    ASSERT_TRUE(crowd.update(0));
    const auto written = output<InstanceLook>(crowd.outputs()[0], &OutputBlock::look, kLookCount);
    EXPECT_TRUE(same_bits(written, looks));
}

TEST_P(Looks, SpawnedInstancesHaveTheDefaultAndSavedOnesTheirLook) {
    const Character character = without_lods(asset_);
    CrowdSettings settings{.groups = {{.character = &character, .capacity = 4, .outfits = {{}, {}}}}};
    Crowd crowd = create(settings);
    const std::vector<InstanceHandle> two = crowd.spawn(0, std::vector<Affine>(2)).value();
    const std::array<InstanceLook, 2> looks{InstanceLook{{1, 0, 0}, 1}, InstanceLook{{0, 1, 0}, 0}};
    ASSERT_TRUE(crowd.set_look(two, looks));
    const auto written = [](Crowd& of) {
        EXPECT_TRUE(of.update(0));
        return output<InstanceLook>(of.outputs()[0], &OutputBlock::look, 2);
    };
    EXPECT_TRUE(same_bits(written(crowd), std::vector(looks.begin(), looks.end())));
    Crowd other = create(settings);
    ASSERT_TRUE(other.restore_state(crowd.save_state().value()));
    EXPECT_TRUE(same_bits(written(other), std::vector(looks.begin(), looks.end())));
    ASSERT_TRUE(crowd.despawn({two.data(), 1}));
    ASSERT_TRUE(crowd.spawn(0, std::array{Affine{}}));
    EXPECT_TRUE(same_bits(written(crowd), std::vector{InstanceLook{}, looks[1]}));
}

TEST_P(Looks, RefusesUnknownOutfitsAndInvalidTints) {
    const Character character = without_lods(asset_);
    Crowd plain = crowd_of(character), crowd = crowd_of(character, {{}});
    EXPECT_EQ(refusal(plain.set_look(InstanceHandle{0}, InstanceLook{})), "look: no group has CrowdGroup::outfits");
    EXPECT_EQ(refusal(crowd.set_look(InstanceHandle{2}, {.outfit = 1})),
              "look of instance 2: outfit 1 is out of range: the group has 1 (CrowdGroup::outfits)");
    EXPECT_EQ(refusal(crowd.set_look(InstanceHandle{2}, {.tint = {0, -1, 0}})),
              "look of instance 2: the tint must be within 0..1000");
    EXPECT_EQ(refusal(crowd.set_look(InstanceHandle{2}, {.tint = {0, std::nanf(""), 0}})),
              "look of instance 2: the tint must be within 0..1000");
    EXPECT_FALSE(crowd.set_look(InstanceHandle{kLookCount}, InstanceLook{}));
    const auto refused = [&](const SectionLook& look) {
        const std::vector<Outfit> outfits{{}, {{look}}};
        return refusal(Crowd::create(test_device(),
                                     {.groups = {{.character = &character, .instance_count = 1, .outfits = outfits}}}));
    };
    EXPECT_EQ(refused({.section = 2}), character.name + ": outfit 1: section 2 is out of range: the mesh has 2");
    const std::string range = character.name +
                              ": outfit 1: section 1: color must be within 0..1000, and tint within 0..1";
    EXPECT_EQ(refused({.section = 1, .color = {1, 1, 1001}}), range);
    EXPECT_EQ(refused({.section = 1, .tint = -0.1f}), range);
    EXPECT_EQ(refused({.section = 1, .material = 2}),
              character.name + ": outfit 1: section 1: material 2 is out of range: the character has 2");
    EXPECT_EQ(character.find_sections_of_material("second"), std::vector<uint32_t>{1});
    EXPECT_EQ(character.find_material("second"), character.sections[1].material);
    EXPECT_EQ(character.find_material("third"), kNone);
    EXPECT_EQ(character.find_sections(character.section_names[0]), (std::vector<uint32_t>{0, 1}));
    EXPECT_TRUE(character.find_sections("nobody").empty());
}

INSTANTIATE_TEST_SUITE_P(Both, Looks, kBothDrawPaths, name_of_path);

}  // namespace
}  // namespace throng::test
