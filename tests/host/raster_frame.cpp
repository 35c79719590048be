#include "tests/host/raster_frame.h"

#include "tests/host/native_cases.h"

#include <algorithm>
#include <bit>

namespace throng::test {

RasterFrame::RasterFrame(uint32_t sample_count) {
    frame_.width = frame_.height = frame_.map_size = kSize;
    frame_.sample_count = sample_count;
    raster::Scene& scene = frame_.scene;
    scene.clip_from_world[0][0] = scene.clip_from_world[1][1] = scene.clip_from_world[3][2] = 1;
    scene.clip_from_world[2][3] = kNear;
    // The map shows the world's 0..1 from above.
    scene.map_from_world[0][0] = scene.map_from_world[1][1] = scene.map_from_world[2][2] = 1;
    samples_.resize(size_t{kSize} * kSize * sample_count);
    map_.resize(size_t{kSize} * kSize);
}

void RasterFrame::add(const std::vector<ScreenVertex>& vertices, const std::vector<uint32_t>& corners,
                      const raster::Material& material, bool is_mirrored) {
    std::vector<Vec3<float>> world;
    const auto place = [](int32_t subpixel) { return static_cast<float>(subpixel) / (kSize * 128) - 1; };
    for (const ScreenVertex& v : vertices) world.push_back({place(v.x) * v.w, place(v.y) * v.w, v.w});
    add_world(world, corners, material, is_mirrored);
}

void RasterFrame::add_world(const std::vector<Vec3<float>>& vertices, const std::vector<uint32_t>& corners,
                            const raster::Material& material, bool is_mirrored) {
    std::vector<RasterVertex> all;
    for (const Vec3<float>& place : vertices) {
        const bool is_clear = material.is_masked && all.size() % 3 == 0;
        all.push_back({.place = place, .color = is_clear ? 0x00FFFFFFu : 0xFFFFFFFFu});
    }
    draws_.add(material, all, corners, is_mirrored);
    first_triangles_.push_back(triangle_count_);
    triangle_count_ += static_cast<int>(corners.size() / 3);
}

void RasterFrame::add_line(const raster::Line& line, bool is_depth_tested) {
    lines_.push_back(line);
    if (is_depth_tested) ++frame_.depth_tested_count;
}

void RasterFrame::draw(NativeIsa isa, uint32_t tile_side, bool farthest_first) {
    const raster::Kernel& kernel = raster::kernel_of(isa);
    draws_.set(frame_, kernel, farthest_first);
    frame_.lines = lines_.data();
    frame_.line_count = static_cast<uint32_t>(lines_.size());
    GuardedBytes map(map_.size() * sizeof(float)), samples(samples_.size() * sizeof(uint64_t));
    frame_.map = reinterpret_cast<float*>(map.data());
    frame_.samples = reinterpret_cast<uint64_t*>(samples.data());
    const native::AlignedBytes scratch = native::aligned_bytes(kernel.scratch_bytes(frame_));
    for (uint32_t y = 0; y < kSize; y += tile_side)
        for (uint32_t x = 0; x < kSize; x += tile_side) {
            const raster::Tile tile{x, y, std::min(x + tile_side, kSize), std::min(y + tile_side, kSize)};
            kernel.draw_map(frame_, tile, false, scratch.get());
            kernel.draw_picture(frame_, tile, false, scratch.get());
        }
    std::ranges::copy_n(frame_.map, static_cast<std::ptrdiff_t>(map_.size()), map_.begin());
    std::ranges::copy_n(frame_.samples, static_cast<std::ptrdiff_t>(samples_.size()), samples_.begin());
}

int RasterFrame::triangle_at(size_t sample) const {
    if (samples_[sample] == 0) return -1;
    const auto id = static_cast<uint32_t>(~samples_[sample]);
    if (id >= frame_.first_line_id) return triangle_count_ + static_cast<int>(id - frame_.first_line_id);
    const uint32_t draw = draws_.draw_of(id);
    return first_triangles_[draw] + static_cast<int>(id - draws_.first_id(draw));
}

float RasterFrame::depth_of(uint64_t sample) { return std::bit_cast<float>(static_cast<uint32_t>(sample >> 32)); }

}  // namespace throng::test
