// The definition of lighting in double precision: properties that hold for any surface.
#include "draw/light_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace throng {
namespace {

// The reflected fraction of the sun's light for a surface facing up, with unit vectors to the sun and the eye.
double reflected_part(double metallic, double roughness, const Vec3<double>& to_sun, const Vec3<double>& to_eye) {
    const auto vec4 = [](const Vec3<double>& v) {
        return io::vec4{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), 1};
    };
    const io::DrawScene scene{.eye = vec4(to_eye), .to_sun = vec4(to_sun), .sun_light = {1, 1, 1, 1}};
    const LitSurface surface{
        .normal = {0, 1, 0}, .albedo = {1, 1, 1}, .metallic = metallic, .roughness = roughness, .occlusion = 0};
    return reflected_light_reference(scene, surface, 1).x / to_sun.y;
}

Vec3<double> direction(double height, double turn_rad) {
    const double across = std::sqrt(1 - height * height);
    return {across * std::cos(turn_rad), height, across * std::sin(turn_rad)};
}

// At grazing angles a non-metal may reflect up to a fifth too much: the diffuse part does not account for all that the
// facets reflect.
TEST(Light, IsReciprocalAndMetalsConserveEnergy) {
    for (const double metallic : {0.0, 0.5, 1.0})
        for (const double roughness : {0.3, 0.6, 1.0})
            for (const double height : {0.2, 0.5, 0.9}) {
                const Vec3<double> to_sun = direction(height, 0);
                double all = 0;  // over the hemisphere above the surface
                constexpr int kSteps = 128;
                for (int i = 0; i < kSteps; ++i)
                    for (int k = 0; k < kSteps; ++k) {
                        const Vec3<double> to_eye = direction((i + 0.5) / kSteps,
                                                              2 * std::numbers::pi * (k + 0.5) / kSteps);
                        const double part = reflected_part(metallic, roughness, to_sun, to_eye);
                        ASSERT_NEAR(part, reflected_part(metallic, roughness, to_eye, to_sun), 1e-5 * (1 + part));
                        all += 2 * part * to_eye.y / (kSteps * kSteps);
                    }
                EXPECT_LE(all, metallic > 0 ? 1 : 1.2) << metallic << ", " << roughness << ", " << height;
                EXPECT_GE(all, roughness > 0.3 ? 0.3 : 0.75) << metallic << ", " << roughness << ", " << height;
            }
}

// A guarantee of the Khronos PBR Neutral tone mapper.
TEST(Light, ToneMappingKeepsColoursThatAreNotBright) {
    const io::DrawScene scene{.eye = {0, 0, 0, 1}};
    const auto pictured = [&](double red, double green, double blue) {
        return pictured_reference(scene, {}, {red, green, blue});
    };
    const Vec3<double> same = pictured(0.5, 0.3, 0.2);
    EXPECT_NEAR(same.x, 0.46, 1e-12);
    EXPECT_NEAR(same.y, 0.26, 1e-12);
    EXPECT_NEAR(same.z, 0.16, 1e-12);
    const Vec3<double> dark = pictured(-0.3, -0.3, -0.1);
    EXPECT_EQ(length(dark), 0) << "of rounding, or of colours that were extrapolated";
    double last = 0;
    for (double red = 0; red < 100; red = 1.1 * red + 0.01) {
        const double seen = pictured(red, red / 2, red / 4).x;
        EXPECT_TRUE(seen >= last && seen < 1) << red;
        last = seen;
    }
    EXPECT_GT(last, 0.99);
    EXPECT_GT(pictured(1000, 1, 1).y, 0.9) << "what is far too bright loses its colour";
}

}  // namespace
}  // namespace throng
