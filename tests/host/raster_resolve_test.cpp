// Resolving samples in the native renderer: hand-made pictures against the definition of lighting in double precision.
#include "tests/host/raster_cases.h"

#include <cmath>

namespace throng::test {
namespace {

using raster::TexelKind;
using Shown = RasterPicture::Shown;

// A triangle around everything that the camera sees, at a random distance, with random normals, colours and texture
// coordinates.
RasterTriangle wide_triangle(const io::DrawScene& scene, Random& random, double texcoord_extent = 3) {
    const double turn = random.between(0, 6.2), way_around = random.chance(0.5) ? 1 : -1;
    const auto xyz = [](const io::vec4& v) { return Vec3<double>{v.x, v.y, v.z}; };
    RasterTriangle triangle;
    for (size_t k = 0; k < 3; ++k) {
        const double angle = turn + way_around * 2.094 * static_cast<double>(k);
        const Vec3<double> ray = xyz(scene.forward) + xyz(scene.right) * (3.2 * std::cos(angle)) +
                                 xyz(scene.down) * (3.2 * std::sin(angle));
        RasterCorner& corner = triangle[k];
        corner.place = xyz(scene.eye) + ray * random.between(2, 6);
        corner.normal = normalized(Vec3<double>{0, 0.3, 1} + random.vector(0.5));
        corner.texcoord = {random.between(-texcoord_extent, texcoord_extent),
                           random.between(-texcoord_extent, texcoord_extent)};
        for (uint8_t& channel : corner.color) channel = static_cast<uint8_t>(random.below(256));
    }
    return triangle;
}

// Makes each sample show one of these, or nothing.
void show_any(RasterPicture& picture, Random& random, const std::vector<Shown>& of) {
    for (uint32_t y = 0; y < picture.frame.height; ++y)
        for (uint32_t x = 0; x < picture.frame.width; ++x)
            for (uint32_t sample = 0; sample < picture.frame.sample_count; ++sample) {
                const uint32_t which = random.below(static_cast<uint32_t>(of.size()) + 1);
                if (which < of.size()) picture.show(x, y, sample, of[which]);
            }
}

// Checks a picture of a few triangles with one material.
void expect_material(const raster::Material& material, RasterPicture& picture, double texcoord_extent = 3) {
    Random random(11);
    std::vector<RasterTriangle> triangles;
    for (int i = 0; i < 5; ++i) triangles.push_back(wide_triangle(picture.scene, random, texcoord_extent));
    std::vector<Shown> of;
    for (const bool is_mirrored : {false, true}) {
        const uint32_t draw = picture.add_draw(material, triangles, is_mirrored);
        for (uint32_t i = 0; i < triangles.size(); ++i) of.push_back({draw, i});
    }
    picture.finish();
    show_any(picture, random, of);
    picture.expect_resolved();
}

TEST(RasterResolve, GroundAndSky) {
    for (const uint32_t samples : {1u, 4u})
        for (const uint32_t width : {61u, 9u}) {  // 9: a pixel is larger than half of a grid cell
            RasterPicture picture(width, width, samples, 1);
            picture.finish();
            picture.expect_resolved();
        }
    RasterPicture below_ground(19, 7, 4, 2);
    below_ground.scene.ground.y = 2;
    below_ground.finish();
    below_ground.expect_resolved();
}

TEST(RasterResolve, ShadowsAreLookedUpNearCasters) {
    RasterPicture picture(61, 61, 1, 4);
    picture.keep_heights(21, 34);
    picture.finish();
    picture.expect_resolved();
    // With a table that says no cell has anything, no height is read
    const std::vector<uint32_t> none(size_t{raster::cells_of_map(64)} * raster::cells_of_map(64));
    RasterPicture told(61, 61, 1, 4), unshadowed(61, 61, 1, 4);
    told.frame.casters = none.data();
    unshadowed.scene.shadow.z = 0;
    told.finish();
    unshadowed.finish();
    for (const NativeIsa isa : native_isas()) EXPECT_EQ(told.resolved(isa, 8), unshadowed.resolved(isa, 8));
}

TEST(RasterResolve, GroundWithoutShadows) {
    RasterPicture picture(31, 9, 1, 3);
    picture.scene.shadow.z = 0;
    picture.finish();
    picture.frame.map = nullptr;
    picture.expect_resolved();
}

TEST(RasterResolve, PlainMaterials) {
    for (const float metallic : {0.0f, 0.4f, 1.0f})
        for (const float roughness : {0.0f, 0.3f, 1.0f}) {
            RasterPicture picture(37, 13, 4, 4);
            raster::Material& material = picture.add_material();
            material.metallic = metallic;
            material.roughness = roughness;
            material.base_color[0] = 0.5f;
            material.emissive[1] = roughness < 0.5f ? 0.2f : 0;
            expect_material(material, picture);
        }
}

// A pixel with a covered sample but an uncovered centre: colours are extrapolated there, but not below 0.
TEST(RasterResolve, ColoursBesideATriangle) {
    RasterPicture picture(37, 37, 4, 4);
    raster::Material& material = picture.add_material();
    Random random(3);
    RasterTriangle triangle = wide_triangle(picture.scene, random);
    const Vec3<double> middle = (triangle[0].place + triangle[1].place + triangle[2].place) * (1.0 / 3);
    for (size_t k = 0; k < 3; ++k) {
        triangle[k].place = middle + (triangle[k].place - middle) * 0.3;
        for (size_t channel = 0; channel < 3; ++channel) triangle[k].color[channel] = channel == k ? 255 : 2;
    }
    const std::vector<Shown> of{{picture.add_draw(material, std::vector{triangle}, false), 0}};
    picture.finish();
    show_any(picture, random, of);
    picture.expect_resolved();
}

TEST(RasterResolve, TexturesNearAndFar) {
    // From many pixels per texel to many texels per pixel
    for (const double extent : {0.05, 1.0, 20.0, 400.0}) {
        RasterPicture picture(23, 17, 4, 5);
        raster::Material& material = picture.add_material();
        material.base_color_map = picture.add_texture(noise(37, 21, 3), TexelKind::kColor);
        expect_material(material, picture, extent);
    }
}

TEST(RasterResolve, TexturesOutsideAndUpClose) {
    using raster::Wrap;
    for (const bool is_nearest : {false, true})
        for (const auto& [u, v] :
             {std::pair(Wrap::kClamp, Wrap::kRepeat), {Wrap::kMirror, Wrap::kClamp}, {Wrap::kRepeat, Wrap::kMirror}})
            for (const double extent : {0.5, 5.0, 80.0}) {
                RasterPicture picture(37, 13, 4, 4);
                raster::Material& material = picture.add_material();
                material.base_color_map = picture.add_texture(noise(37, 21, 3), TexelKind::kColor);
                material.sampling = {is_nearest, u, v};
                expect_material(material, picture, extent);
            }
}

TEST(RasterResolve, Maps) {
    for (const double extent : {0.5, 5.0}) {
        RasterPicture picture(23, 17, 4, 6);
        raster::Material& material = picture.add_material();
        material.has_maps = true;
        material.metallic = 0.8f;
        material.emissive[0] = 0.5f;
        material.metallic_roughness_map = picture.add_texture(noise(16, 32, 1), TexelKind::kNumbers);
        material.normal_map = picture.add_texture(noise(8, 8, 2), TexelKind::kNumbers);
        material.normal_scale = 0.7f;
        material.occlusion_map = picture.add_texture(noise(5, 3, 3), TexelKind::kNumbers);
        material.occlusion_strength = 0.6f;
        material.emissive_map = picture.add_texture(noise(64, 64, 4), TexelKind::kColor);
        expect_material(material, picture, extent);
    }
}

// Corners behind the eye, as those of the floor below it.
TEST(RasterResolve, TrianglesThatCrossTheNearPlane) {
    RasterPicture picture(33, 21, 4, 7);
    raster::Material& material = picture.add_material();
    material.base_color_map = picture.add_texture(noise(16, 16, 9), TexelKind::kColor);
    RasterTriangle floor;
    const Vec3<double> places[3]{{-30, 0.2, -12}, {2, 0.1, 40}, {28, 0.3, -15}};
    for (size_t k = 0; k < 3; ++k)
        floor[k] = {.place = places[k],
                    .normal = {0, 1, 0},
                    .texcoord = {places[k].x / 3, places[k].z / 3},
                    .color = {200, static_cast<uint8_t>(100 * k), 255, 255}};
    const uint32_t draw = picture.add_draw(material, {&floor, 1});
    picture.finish();
    uint32_t shown = 0;
    for (uint32_t y = 0; y < picture.frame.height; ++y)
        for (uint32_t x = 0; x < picture.frame.width; ++x)
            for (uint32_t sample = 0; sample < 4; ++sample)
                if (picture.is_before(x, y, {draw, 0})) {
                    picture.show(x, y, sample, {draw, 0});
                    ++shown;
                }
    EXPECT_GT(shown, picture.frame.width * picture.frame.height);
    picture.expect_resolved();
}

// More materials than are handled separately, in a row of more pixels than are resolved together, with lines on top.
TEST(RasterResolve, ManyMaterialsAndLines) {
    RasterPicture picture(2100, 2, 4, 8);
    Random random(12);
    std::vector<Shown> of;
    for (int i = 0; i < 150; ++i) {
        raster::Material& material = picture.add_material();
        for (float& channel : material.base_color) channel = static_cast<float>(random.unit());
        const RasterTriangle triangle = wide_triangle(picture.scene, random);
        of.push_back({picture.add_draw(material, {&triangle, 1}), 0});
    }
    for (uint32_t line = 0; line < 3; ++line) {
        picture.add_line({static_cast<float>(random.unit()), static_cast<float>(random.unit()), 0.1f});
        for (const uint32_t triangle : {2 * line, 2 * line + 1}) of.push_back({RasterPicture::kLines, triangle});
    }
    picture.finish();
    show_any(picture, random, of);
    picture.expect_resolved();
}

// Triangles without area may get any colour, but must not read texels out of bounds.
TEST(RasterResolve, TrianglesWithoutArea) {
    RasterPicture picture(8, 1, 1, 9);
    raster::Material& material = picture.add_material();
    material.base_color_map = picture.add_texture(noise(4, 4, 9), TexelKind::kColor);
    const RasterCorner corner{.place = {0, 1, 0}, .normal = {0, 1, 0}, .texcoord = {1e30, -1e30}};
    RasterCorner far = corner;
    far.place = {1e6, 1, 1e6};
    const RasterTriangle point{corner, corner, corner}, line{corner, corner, far};
    const uint32_t draw = picture.add_draw(material, std::array{point, line});
    picture.finish();
    for (uint32_t x = 0; x < 8; ++x) picture.show(x, 0, 0, {draw, x % 2});
    for (const NativeIsa isa : native_isas()) {
        const std::vector<uint8_t> rgba = picture.resolved(isa, 1);
        for (size_t i = 3; i < rgba.size(); i += 4) EXPECT_EQ(rgba[i], 255) << name_of(isa);
    }
}

}  // namespace
}  // namespace throng::test
