// Small hand-made pictures for the native renderer's kernels, with the expected colours in double precision. Which
// triangle each sample shows is set, not rasterised.
#pragma once

#include "draw/light_reference.h"
#include "raster/kernels.h"
#include "raster/texture.h"
#include "tests/host/native_cases.h"
#include "tests/host/raster_draws.h"
#include "tests/test_rig.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <span>
#include <vector>

namespace throng::test {

inline constexpr float kNearPlane = 0.1f;

struct RasterCorner {
    Vec3<double> place, normal;  // world space
    std::array<double, 2> texcoord{};
    std::array<uint8_t, 4> color{255, 255, 255, 255};
};
using RasterTriangle = std::array<RasterCorner, 3>;

// Seen by a camera at (0.3, 1.5, 4) that looks along -z and slightly down. The sun's shadow map has random heights.
class RasterPicture {
public:
    RasterPicture(uint32_t width, uint32_t height, uint32_t sample_count, uint64_t seed);

    io::DrawScene scene{};
    raster::Frame frame;  // complete except for what finish() sets

    raster::Material& add_material() { return materials_.emplace_back(); }
    const raster::Texture* add_texture(const Picture& picture, raster::TexelKind kind);
    // Returns the draw's number.
    uint32_t add_draw(const raster::Material& material, std::span<const RasterTriangle> triangles,
                      bool is_mirrored = false);
    void add_line(const Vec3<float>& color);
    // Clears the map except for these columns and rows, and tells the kernels which cells hold something.
    void keep_heights(uint32_t first, uint32_t end);
    // To be called after everything has been added: sets the pointers.
    void finish();

    // `of_draw` is kLines for a line.
    static constexpr uint32_t kLines = 0xFFFFFFFE, kNothing = 0xFFFFFFFF;
    struct Shown {
        uint32_t of_draw = kNothing, triangle = 0;
    };
    void show(uint32_t x, uint32_t y, uint32_t sample, const Shown& shown);

    // Whether the ray through a pixel's centre meets the plane of a triangle in front of the eye.
    bool is_before(uint32_t x, uint32_t y, const Shown& shown) const;
    // The expected linear colour, averaged over the samples.
    Vec3<double> expected(uint32_t x, uint32_t y) const;
    // The picture that this kernel resolves, `rows_each` rows at a time, with guards around it.
    std::vector<uint8_t> resolved(NativeIsa isa, uint32_t rows_each) const;
    // Everything that has been added, rasterised by this kernel; show() does not affect these.
    std::vector<uint64_t> drawn_picture(NativeIsa isa) const;
    std::vector<float> drawn_map(NativeIsa isa) const;
    // All pixels must match the expected ones within 0.7 of 255, which allows for rounding.
    void expect_resolved();

    // A triangle's interpolated values at a position in the picture, in pixels.
    struct At {
        Vec3<double> place, normal, color;
        double alpha = 1;
        std::array<double, 2> texcoord{};
        bool is_front = true;
        bool is_before_eye = true;
    };
    At at(const RasterTriangle& triangle, bool is_mirrored, double x, double y) const;
    // The same from the sun's view, at a position in texels.
    At at_map(const RasterTriangle& triangle, double x, double y) const;
    double map_height(int column, int row) const {
        return map_[static_cast<size_t>(row) * frame.map_size + static_cast<size_t>(column)];
    }

private:
    struct DrawData {
        const raster::Material* material;
        std::vector<RasterTriangle> triangles;  // with float precision
        bool is_mirrored;
    };
    Vec3<double> ray(double x, double y) const;
    At weighted(const RasterTriangle& triangle, const std::array<double, 3>& weights) const;
    Vec3<double> shaded(const Shown& shown, uint32_t x, uint32_t y) const;

    std::deque<raster::Material> materials_;
    std::deque<raster::OwnedTexture> textures_;
    std::vector<DrawData> drawn_;
    RasterDraws draws_;
    std::vector<raster::Line> lines_;
    std::vector<float> map_;
    std::vector<uint32_t> casters_;
    std::vector<uint64_t> samples_;
    std::vector<Shown> shown_;
    std::vector<uint32_t> srgb_;
};

// Texels of random colours.
Picture noise(uint32_t width, uint32_t height, uint64_t seed);
// The texture's filtered value, as samplers read it. The steps are the differences to the next pixels.
std::array<double, 4> sampled_reference(const raster::Texture& texture, const raster::Sampling& sampling,
                                        const std::array<double, 2>& texcoord, const std::array<double, 2>& step_x,
                                        const std::array<double, 2>& step_y);

}  // namespace throng::test
