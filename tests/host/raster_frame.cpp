#include "tests/host/raster_frame.h"

#include "tests/host/native_cases.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace throng::test {

using raster::kBlock;

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
    const size_t triangle_count = corners.size() / 3, room = (vertices.size() + kBlock - 1) / kBlock * kBlock;
    Mesh& mesh = meshes_.emplace_back();
    for (uint32_t k = 0; k < 3; ++k) {
        mesh.corners[k].assign((triangle_count + kBlock - 1) / kBlock * kBlock, 0);
        for (size_t t = 0; t < triangle_count; ++t) mesh.corners[k][t] = corners[3 * t + k];
    }
    mesh.kept = native::aligned_bytes(room * 8 * sizeof(float));
    auto* const kept = reinterpret_cast<float*>(mesh.kept.get());
    for (size_t i = 0; i < vertices.size(); ++i) {
        const Vec3<float>& v = vertices[i];
        const float floats[8]{v.x, v.y, v.z, 1, 0, 1, 0, 0};
        std::ranges::copy(floats, kept + i * 8);
    }
    mesh.texcoords.resize(2 * vertices.size());
    for (size_t i = 0; i < vertices.size(); ++i)
        mesh.colors.push_back(material.is_masked && i % 3 == 0 ? 0x00FFFFFFu : 0xFFFFFFFFu);
    mesh.vertices = native::aligned_bytes(room * 4 * sizeof(float));
    mesh.section = {.material = &material,
                    .vertex_count = static_cast<uint32_t>(vertices.size()),
                    .triangle_count = static_cast<uint32_t>(triangle_count),
                    .corners = {mesh.corners[0].data(), mesh.corners[1].data(), mesh.corners[2].data()},
                    .texcoords = mesh.texcoords.data(),
                    .colors = mesh.colors.data()};
    draws_.push_back({.section = &mesh.section,
                      .vertices = reinterpret_cast<float*>(mesh.vertices.get()),
                      .first_id = static_cast<uint32_t>(draw_of_ids_.size()) * raster::kIdBlock,
                      .is_mirrored = is_mirrored});
    first_triangles_.push_back(triangle_count_);
    triangle_count_ += static_cast<int>(triangle_count);
    const size_t blocks = (triangle_count + raster::kIdBlock - 1) / raster::kIdBlock;
    draw_of_ids_.insert(draw_of_ids_.end(), blocks, static_cast<uint32_t>(draws_.size() - 1));
    frame_.most_vertices = std::max(frame_.most_vertices, mesh.section.vertex_count);
}

void RasterFrame::add_line(const raster::Line& line, bool is_depth_tested) {
    lines_.push_back(line);
    if (is_depth_tested) ++frame_.depth_tested_count;
}

void RasterFrame::draw(NativeIsa isa, uint32_t tile_side, bool farthest_first) {
    const raster::Kernel& kernel = raster::kernel_of(isa);
    frame_.draws = draws_.data();
    frame_.draw_count = static_cast<uint32_t>(draws_.size());
    frame_.draw_of_ids = draw_of_ids_.data();
    frame_.lines = lines_.data();
    frame_.line_count = static_cast<uint32_t>(lines_.size());
    frame_.first_line_id = static_cast<uint32_t>(draw_of_ids_.size()) * raster::kIdBlock;
    GuardedBytes map(map_.size() * sizeof(float)), samples(samples_.size() * sizeof(uint64_t));
    frame_.map = reinterpret_cast<float*>(map.data());
    frame_.samples = reinterpret_cast<uint64_t*>(samples.data());
    for (size_t i = 0; i < draws_.size(); ++i)
        kernel.keep(frame_, reinterpret_cast<const float*>(meshes_[i].kept.get()), draws_[i]);
    nearest_first_.resize(draws_.size());
    std::iota(nearest_first_.begin(), nearest_first_.end(), 0u);
    std::ranges::stable_sort(nearest_first_, [&](uint32_t a, uint32_t b) {
        return farthest_first ? draws_[a].nearest < draws_[b].nearest : draws_[a].nearest > draws_[b].nearest;
    });
    frame_.nearest_first = nearest_first_.data();
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
    const uint32_t draw = draw_of_ids_[id / raster::kIdBlock];
    return first_triangles_[draw] + static_cast<int>(id - draws_[draw].first_id);
}

float RasterFrame::depth_of(uint64_t sample) { return std::bit_cast<float>(static_cast<uint32_t>(sample >> 32)); }

}  // namespace throng::test
