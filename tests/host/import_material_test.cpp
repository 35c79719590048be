// Importing materials, textures and images.
#include "tests/host/import_cases.h"

#include <cmath>
#include <numbers>
#include <tuple>

namespace throng::test {
namespace {

TEST(Import, Materials) {
    GlbBuilder b = tiny_character();
    const std::vector<std::byte> png{std::byte(1), std::byte(2), std::byte(3)};
    b.json["images"] = {{{"uri", "unused.png"}},
                        {{"bufferView", b.add_view(png)}, {"mimeType", "image/png"}, {"name", "skin"}}};
    b.json["textures"] = {{{"source", 1}}, {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
    b.json["materials"] = {
        {{"name", "cloth"},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 0.25, 0, 1}},
           {"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}}}}}},
        {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}},
        {{"alphaMode", "GLASS"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
        GltfJson::object()};
    const Asset asset = loaded(b);
    ASSERT_EQ(asset.materials.size(), 4u);
    EXPECT_EQ(asset.materials[0].name, "cloth");
    EXPECT_EQ(asset.materials[0].base_color, (std::array<float, 4>{0.5f, 0.25f, 0, 1}));
    EXPECT_EQ(asset.materials[0].alpha_mode, AlphaMode::kMask);
    EXPECT_EQ(asset.materials[0].alpha_cutoff, 0.25f);
    EXPECT_TRUE(asset.materials[0].double_sided);
    EXPECT_EQ(asset.materials[0].image, 0u);
    EXPECT_EQ(asset.materials[1].image, kNone);
    EXPECT_EQ(asset.materials[1].alpha_mode, AlphaMode::kBlend);
    EXPECT_EQ(asset.materials[2].image, 0u);  // imported only once
    EXPECT_EQ(asset.materials[2].alpha_mode, AlphaMode::kOpaque);
    EXPECT_EQ(asset.materials[3].image, kNone);
    ASSERT_EQ(asset.images.size(), 1u);
    EXPECT_EQ(asset.images[0].name, "skin");
    EXPECT_EQ(asset.images[0].encoded, png);
    EXPECT_TRUE(has_warning(asset, "textures[1]: is a KTX2 image (KHR_texture_basisu), which is not read"));
    EXPECT_TRUE(has_warning(asset, "materials[2].alphaMode: 'GLASS' is unknown"));

    EXPECT_EQ(asset.materials[0].metallic, 1);
    EXPECT_EQ(asset.materials[0].emissive, (std::array<float, 3>{}));

    b.json["textures"][0]["source"] = 2;
    expect_refused(b, "textures[0].source", "index 2, but images has 2 entries");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 2;
    expect_refused(b, "materials[0].pbrMetallicRoughness.baseColorTexture.index", "index 2");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1};
    expect_refused(b, "materials[0].pbrMetallicRoughness.baseColorFactor", "must have 4 numbers");
    b.json["materials"][0] = "red";
    expect_refused(b, "materials[0]", "must be an object");
}

TEST(Import, TexturesMayBeOfWebPAlone) {
    GlbBuilder b = tiny_character();
    const std::vector<std::byte> png(3, std::byte(1)), webp(5, std::byte(2));
    b.json["images"] = {{{"bufferView", b.add_view(png)}, {"mimeType", "image/png"}},
                        {{"bufferView", b.add_view(webp)}, {"mimeType", "image/webp"}}};
    const GltfJson of_webp{{"EXT_texture_webp", {{"source", 1}}}};
    b.json["textures"] = {{{"extensions", of_webp}}, {{"source", 0}, {"extensions", of_webp}}};
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) b.json[list] = {"EXT_texture_webp"};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}},
                           {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}}}}};
    const Asset asset = loaded(b);
    EXPECT_TRUE(asset.warnings.empty());
    ASSERT_EQ(asset.images.size(), 1u);
    ASSERT_EQ(asset.materials[0].image, 0u);
    EXPECT_EQ(asset.images[0].encoded, webp);
    EXPECT_EQ(asset.materials[1].image, asset.materials[0].image) << "what stands beside it is for others";
    b.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 2;
    expect_refused(b, "textures[0].extensions.EXT_texture_webp.source", "index 2, but images has 2 entries");
}

TEST(Import, MaterialsHaveAllTexturesThatShareTheirCoordinates) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = GltfJson::array();
    b.json["textures"] = GltfJson::array();
    for (size_t i = 0; i < 5; ++i) {
        b.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}, {"name", std::to_string(i)}});
        b.json["textures"].push_back({{"source", i}});
    }
    b.json["materials"] = {{{"pbrMetallicRoughness",
                             {{"metallicFactor", 0.25},
                              {"roughnessFactor", 0.75},
                              {"baseColorTexture", {{"index", 0}, {"texCoord", 1}}},
                              {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 1}}}}},
                            {"normalTexture", {{"index", 2}, {"texCoord", 1}, {"scale", 0.5}}},
                            {"occlusionTexture", {{"index", 3}, {"texCoord", 1}, {"strength", 0.125}}},
                            {"emissiveTexture", {{"index", 4}, {"texCoord", 1}}},
                            {"emissiveFactor", {1, 0.5, 0}},
                            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
    const auto name_of = [](const Asset& asset, uint32_t image) {
        return image == kNone ? "none" : asset.images.at(image).name;
    };
    const Asset asset = loaded(b);
    const AssetMaterial& material = asset.materials[0];
    EXPECT_EQ(std::tuple(material.metallic, material.roughness, material.normal_scale, material.occlusion_strength),
              std::tuple(0.25f, 0.75f, 0.5f, 0.125f));
    EXPECT_EQ(material.emissive, (std::array<float, 3>{4, 2, 0}));
    EXPECT_EQ(name_of(asset, material.image), "0");
    EXPECT_EQ(name_of(asset, material.metallic_roughness_image), "1");
    EXPECT_EQ(name_of(asset, material.normal_image), "2");
    EXPECT_EQ(name_of(asset, material.occlusion_image), "3");
    EXPECT_EQ(name_of(asset, material.emissive_image), "4");

    b.json["materials"][0]["normalTexture"].erase("texCoord");
    const Asset other_set = loaded(b);
    EXPECT_EQ(other_set.materials[0].normal_image, kNone);
    EXPECT_EQ(name_of(other_set, other_set.materials[0].emissive_image), "4");
    EXPECT_TRUE(has_warning(other_set, "materials[0].normalTexture: uses other texture coordinates"));
    b.json["textures"][0].erase("source");
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 0;
    const Asset left_out = loaded(b);
    EXPECT_EQ(name_of(left_out, left_out.materials[0].metallic_roughness_image), "1")
        << "a texture without an image decides nothing";
    b.json["materials"][0]["normalTexture"]["index"] = 5;
    b.json["materials"][0]["normalTexture"]["texCoord"] = 1;
    expect_refused(b, "materials[0].normalTexture.index", "index 5");
}

// KHR_texture_transform: scale, then rotate, then translate.
TEST(Import, TextureCoordinatesAreThoseThatTheTextureIsLookedUpBy) {
    GlbBuilder b = tiny_character();
    attributes(b)["TEXCOORD_1"] = b.add<float>({0.25f, 0.5f, 1, 0, 0, 1}, "VEC2", kFloat);
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    const auto texcoords = [&](const GltfJson& transform) {
        const GltfJson texture{{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}, {"normalTexture", texture}}};
        b.json["meshes"][0]["primitives"][0]["material"] = 0;
        const Asset asset = loaded(b);
        EXPECT_TRUE(asset.warnings.empty()) << asset.warnings[0];
        EXPECT_EQ(asset.materials[0].normal_image, 0u);
        return asset.meshes[0].primitives[0].texcoords;
    };
    using Texcoords = std::vector<std::array<float, 2>>;
    EXPECT_EQ(texcoords({{"texCoord", 1}}), (Texcoords{{0.25f, 0.5f}, {1, 0}, {0, 1}}));
    EXPECT_EQ(texcoords({{"texCoord", 1}, {"offset", {0.5, 2}}, {"scale", {4, 2}}}),
              (Texcoords{{1.5f, 3}, {4.5f, 2}, {0.5f, 4}}));
    const Texcoords turned = texcoords(
        {{"texCoord", 1}, {"rotation", std::numbers::pi / 2}, {"offset", {10, 0}}, {"scale", {2, 1}}});
    const Texcoords expected{{10.5f, -0.5f}, {10, -2}, {11, 0}};
    for (size_t i = 0; i < expected.size(); ++i)
        for (size_t k = 0; k < 2; ++k) EXPECT_NEAR(turned[i][k], expected[i][k], 1e-6) << i;
    for (const auto& [u, v] : texcoords({{"texCoord", 1}, {"offset", {3e38, -3e38}}, {"scale", {3e38, 3e38}}}))
        EXPECT_TRUE(std::isfinite(u) && std::isfinite(v));
    b.json["materials"][0]["normalTexture"].erase("extensions");
    EXPECT_TRUE(has_warning(loaded(b), "materials[0].normalTexture: uses other texture coordinates"));
}

TEST(Import, AMaterialHasTheSamplerOfItsFirstTexture) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["samplers"] = {GltfJson::object(),
                          {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}},
                          {{"magFilter", 9729}, {"wrapS", 10497}}};
    b.json["textures"] = {{{"source", 0}},
                          {{"source", 0}, {"sampler", 0}},
                          {{"source", 0}, {"sampler", 1}},
                          {{"source", 0}, {"sampler", 2}}};
    const auto sampler_of = [&](size_t texture) {
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
                                {"normalTexture", {{"index", 2}}}}};
        const AssetMaterial material = loaded(b).materials[0];
        return std::tuple(material.filter, material.wrap_u, material.wrap_v);
    };
    const std::tuple usual(TextureFilter::kLinear, TextureWrap::kRepeat, TextureWrap::kRepeat);
    EXPECT_EQ(sampler_of(0), usual);
    EXPECT_EQ(sampler_of(1), usual);
    EXPECT_EQ(sampler_of(2), std::tuple(TextureFilter::kNearest, TextureWrap::kClamp, TextureWrap::kMirror));
    EXPECT_EQ(sampler_of(3), usual);
    b.json["textures"][3]["sampler"] = 3;
    EXPECT_EQ(sampler_of(3), usual);
    EXPECT_TRUE(has_warning(loaded(b), "textures[3].sampler: index 3"));
    b.json["textures"][3]["sampler"] = 1;
    b.json["samplers"][1]["wrapT"] = "up";
    EXPECT_EQ(sampler_of(3), usual);
    EXPECT_TRUE(has_warning(loaded(b), "samplers[1].wrapT: "));
}

TEST(Import, ColoursOfSpecularGlossinessAreReadWhereThereAreNoOthers) {
    GlbBuilder b = tiny_character();
    const size_t view = b.add_view(std::vector<std::byte>(3));
    b.json["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    b.json["materials"] = {{{"extensions",
                             {{"KHR_materials_pbrSpecularGlossiness",
                               {{"diffuseFactor", {0.5, 0.25, 0.125, 1}},
                                {"diffuseTexture", {{"index", 0}}},
                                {"glossinessFactor", 0.25}}}}}}};
    const AssetMaterial material = loaded(b).materials[0];
    EXPECT_EQ(material.base_color, (std::array<float, 4>{0.5f, 0.25f, 0.125f, 1}));
    EXPECT_EQ(std::tuple(material.image, material.metallic, material.roughness), std::tuple(0u, 0.0f, 0.75f));
    b.json["materials"][0]["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 0, 0, 1}}};
    EXPECT_EQ(loaded(b).materials[0].base_color, (std::array<float, 4>{1, 0, 0, 1}));
}

// A missing texture does not make the character invalid.
TEST(Import, MissingImages) {
    for (const char* uri :
         {"missing.png", "../up.png", "/etc/passwd", "http://localhost/a.png", "data:image/png;base64", "C:\\a.png"}) {
        GlbBuilder b = tiny_character();
        b.json["images"] = {{{"uri", uri}}};
        b.json["textures"] = {{{"source", 0}}};
        b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        const Asset asset = loaded(b);
        ASSERT_EQ(asset.images.size(), 1u) << uri;
        EXPECT_TRUE(asset.images[0].encoded.empty()) << uri;
        EXPECT_TRUE(has_warning(asset, "images[0].uri: ")) << uri;
        EXPECT_EQ(asset.warnings.size(), 1u) << uri;
    }
    GlbBuilder b = tiny_character();
    b.json["images"] = {{{"bufferView", 99}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    expect_refused(b, "images[0].bufferView", "index 99");
}

}  // namespace
}  // namespace throng::test
