// A frame of the native renderer, with triangles whose screen positions are known to the subpixel.
#pragma once

#include "raster/kernels.h"
#include "tests/host/raster_draws.h"
#include "tests/test_rig.h"

#include <deque>
#include <vector>

namespace throng::test {

struct ScreenVertex {
    int32_t x, y;  // subpixels of the picture
    float w = 1;   // powers of two avoid rounding
};

class RasterFrame {
public:
    static constexpr float kNear = 0.5f;
    static constexpr uint32_t kSize = 64;  // pixels of the picture, and texels of the map, each way

    explicit RasterFrame(uint32_t sample_count);

    // `corners`: three per triangle. With a masked material, vertices 0, 3, 6, … have alpha 0.
    raster::Material& material() { return materials_.emplace_back(); }
    void add(const std::vector<ScreenVertex>& vertices, const std::vector<uint32_t>& corners,
             const raster::Material& material, bool is_mirrored = false);
    // Like add(), with vertices in world space: x, y, and the distance from the eye.
    void add_world(const std::vector<Vec3<float>>& vertices, const std::vector<uint32_t>& corners,
                   const raster::Material& material, bool is_mirrored = false);
    void add_line(const raster::Line& line, bool is_depth_tested);

    // Draws tile by tile into guarded memory. Afterwards samples() and map() are the frame's.
    void draw(NativeIsa isa, uint32_t tile_side = kSize, bool farthest_first = false);
    const std::vector<uint64_t>& samples() const { return samples_; }
    const std::vector<float>& map() const { return map_; }
    const raster::Frame& frame() const { return frame_; }
    raster::Frame& frame() { return frame_; }
    // The triangle that a sample shows, numbered across all draws and then lines, or -1.
    int triangle_at(size_t sample) const;
    static float depth_of(uint64_t sample);

private:
    std::deque<raster::Material> materials_;
    RasterDraws draws_;
    std::vector<raster::Line> lines_;
    std::vector<int> first_triangles_;
    int triangle_count_ = 0;
    std::vector<uint64_t> samples_;
    std::vector<float> map_;
    raster::Frame frame_;
};

}  // namespace throng::test
