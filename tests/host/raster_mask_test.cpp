// Alpha masks on triangles in pictures and shadow maps of the native renderer.
#include "tests/host/raster_cases.h"

#include <cmath>

namespace throng::test {
namespace {

constexpr float kCutoff = 0.4f;
constexpr double kNear = 2e-3;  // alphas this near to the cutoff may be rounded to either side

// A square in front of the camera, with a texture of random alphas. Its triangles' attributes are linear in the
// position.
struct Square {
    Square(uint32_t sample_count, bool is_masked) : picture(96, 64, sample_count, 1) {
        material.is_masked = is_masked;
        material.is_double_sided = true;
        material.alpha_cutoff = kCutoff;
        material.base_color[3] = 0.9f;
        material.base_color_map = picture.add_texture(noise(16, 24, 5), raster::TexelKind::kColor);
        const auto corner = [](double x, double y) {
            return RasterCorner{.place = {x, 1 + y, 0.4 * x - 1.2 * y},
                                .normal = {0, 0, 1},
                                .texcoord = {1.7 * x, 1.3 * y},
                                .color = {255, 255, 255, static_cast<uint8_t>(x > 0 ? 195 : 255)}};
        };
        const RasterCorner a = corner(-1.5, -1.5), b = corner(1.5, -1.5), c = corner(1.5, 1.5), d = corner(-1.5, 1.5);
        triangles = {{{a, b, c}, {a, c, d}}};
        picture.add_draw(material, triangles);
        picture.finish();
    }
    // The alpha where `place_at` finds the pixel or texel and its neighbours.
    template <class PlaceAt>
    double alpha(const PlaceAt& place_at, uint32_t x, uint32_t y) const {
        constexpr double kStep = 1e-3;
        const RasterPicture::At at = place_at(x + 0.5, y + 0.5), right = place_at(x + 0.5 + kStep, y + 0.5),
                                below = place_at(x + 0.5, y + 0.5 + kStep);
        std::array<double, 2> step_x{}, step_y{};
        for (size_t i = 0; i < 2; ++i) {
            step_x[i] = (right.texcoord[i] - at.texcoord[i]) / kStep;
            step_y[i] = (below.texcoord[i] - at.texcoord[i]) / kStep;
        }
        return at.alpha * material.base_color[3] *
               sampled_reference(*material.base_color_map, material.sampling, at.texcoord, step_x, step_y)[3];
    }

    RasterPicture picture;
    raster::Material& material = picture.add_material();
    std::array<RasterTriangle, 2> triangles;
};

TEST(RasterMask, PicturesShowSamplesThatPassTheMask) {
    for (const uint32_t samples : {1u, 4u}) {
        const Square masked(samples, true), whole(samples, false);
        const auto place_at = [&](double x, double y) { return masked.picture.at(masked.triangles[0], false, x, y); };
        for (const NativeIsa isa : native_isas()) {
            const std::vector<uint64_t> some = masked.picture.drawn_picture(isa),
                                        all = whole.picture.drawn_picture(isa);
            uint32_t left = 0, left_out = 0;
            for (uint32_t y = 0; y < masked.picture.frame.height; ++y)
                for (uint32_t x = 0; x < masked.picture.frame.width; ++x) {
                    const double over = masked.alpha(place_at, x, y) - double{kCutoff};
                    if (std::abs(over) < kNear) continue;
                    for (uint32_t i = 0; i < samples; ++i) {
                        const size_t sample = (size_t{y} * masked.picture.frame.width + x) * samples + i;
                        ASSERT_EQ(some[sample], over > 0 ? all[sample] : 0) << name_of(isa) << " " << x << ", " << y;
                        left += some[sample] != 0;
                        left_out += some[sample] != all[sample];
                    }
                }
            EXPECT_GT(left, 500 * samples);
            EXPECT_GT(left_out, 500 * samples);
        }
    }
}

TEST(RasterMask, ShadowsShowTexelsThatPassTheMask) {
    const Square masked(1, true), whole(1, false);
    const auto place_at = [&](double x, double y) { return masked.picture.at_map(masked.triangles[0], x, y); };
    const uint32_t size = masked.picture.frame.map_size;
    for (const NativeIsa isa : native_isas()) {
        const std::vector<float> some = masked.picture.drawn_map(isa), all = whole.picture.drawn_map(isa);
        uint32_t left = 0, left_out = 0;
        for (uint32_t y = 0; y < size; ++y)
            for (uint32_t x = 0; x < size; ++x) {
                const double over = masked.alpha(place_at, x, y) - double{kCutoff};
                if (std::abs(over) < kNear) continue;
                const size_t texel = size_t{y} * size + x;
                ASSERT_EQ(some[texel], over > 0 ? all[texel] : 0) << name_of(isa) << " " << x << ", " << y;
                left += some[texel] > 0;
                left_out += some[texel] != all[texel];
            }
        EXPECT_GT(left, 20);
        EXPECT_GT(left_out, 20);
    }
}

// Wherever the map begins, its grid's texels are covered alike, so shadows do not shimmer while the map moves.
TEST(RasterMask, BlendedShadowsFollowTheGridOfTheMap) {
    constexpr uint32_t kMoved[2]{5, 3};
    const auto map_of = [&](NativeIsa isa, bool is_moved) {
        Square square(1, true);
        square.material.is_blended = true;
        raster::Frame& frame = square.picture.frame;
        for (size_t k = 0; k < 2; ++k) {
            constexpr uint32_t kFirst = 65534;  // of 65536
            frame.scene.map_grid[k] = static_cast<float>(kFirst);
            if (!is_moved) continue;
            frame.scene.map_grid[k] = static_cast<float>((kFirst + kMoved[k]) % 65536);
            frame.scene.map_from_world[k][3] -= static_cast<float>(kMoved[k]) / static_cast<float>(frame.map_size);
        }
        return square.picture.drawn_map(isa);
    };
    const uint32_t size = Square(1, true).picture.frame.map_size;
    for (const NativeIsa isa : native_isas()) {
        const std::vector<float> before = map_of(isa, false), after = map_of(isa, true);
        uint32_t covered = 0, bare = 0;
        for (uint32_t y = kMoved[1]; y < size; ++y)
            for (uint32_t x = kMoved[0]; x < size; ++x) {
                const bool is_covered = before[size_t{y} * size + x] > 0;
                ASSERT_EQ(after[size_t{y - kMoved[1]} * size + x - kMoved[0]] > 0, is_covered) << x << ", " << y;
                (is_covered ? covered : bare) += 1;
            }
        EXPECT_GT(covered, 20u) << name_of(isa);
        EXPECT_GT(bare, 20u);
    }
}

}  // namespace
}  // namespace throng::test
