#include "tests/host/raster_draws.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace throng::test {

using raster::kBlock;

void RasterDraws::add(const raster::Material& material, std::span<const RasterVertex> vertices,
                      std::span<const uint32_t> corners, bool is_mirrored) {
    const auto to_blocks = [](size_t count) { return (count + kBlock - 1) / kBlock * kBlock; };
    const size_t triangle_count = corners.size() / 3, room = to_blocks(vertices.size());
    Mesh& mesh = meshes_.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
        mesh.corners[k].resize(to_blocks(triangle_count));
        for (size_t t = 0; t < triangle_count; ++t) mesh.corners[k][t] = corners[3 * t + k];
    }
    mesh.world = native::aligned_bytes(room * 8 * sizeof(float));
    mesh.kept = native::aligned_bytes(room * 4 * sizeof(float));
    auto* world = reinterpret_cast<float*>(mesh.world.get());
    for (const auto& [place, normal, texcoord, color] : vertices) {
        for (const float n : {place.x, place.y, place.z, 1.0f, normal.x, normal.y, normal.z, 0.0f}) *world++ = n;
        mesh.texcoords.insert(mesh.texcoords.end(), texcoord.begin(), texcoord.end());
        mesh.colors.push_back(color);
    }
    mesh.section = {.vertex_count = static_cast<uint32_t>(vertices.size()),
                    .triangle_count = static_cast<uint32_t>(triangle_count),
                    .corners = {mesh.corners[0].data(), mesh.corners[1].data(), mesh.corners[2].data()},
                    .texcoords = mesh.texcoords.data(),
                    .colors = mesh.colors.data()};
    draws_.push_back({.section = &mesh.section,
                      .material = &material,
                      .vertices = reinterpret_cast<float*>(mesh.kept.get()),
                      .first_id = static_cast<uint32_t>(draw_of_ids_.size()) * raster::kIdBlock,
                      .is_mirrored = is_mirrored,
                      .size = 1 + 0.4f * static_cast<float>(draws_.size() % 5)});
    draw_of_ids_.insert(draw_of_ids_.end(), (triangle_count + raster::kIdBlock - 1) / raster::kIdBlock,
                        static_cast<uint32_t>(draws_.size() - 1));
}

void RasterDraws::set(raster::Frame& frame, const raster::Kernel& kernel, bool farthest_first) {
    for (const raster::Draw& draw : draws_)
        frame.max_vertices = std::max(frame.max_vertices, draw.section->vertex_count);
    for (size_t i = 0; i < draws_.size(); ++i)
        kernel.keep(frame, reinterpret_cast<const float*>(meshes_[i].world.get()), draws_[i]);
    nearest_first_.resize(draws_.size());
    std::iota(nearest_first_.begin(), nearest_first_.end(), 0u);
    std::ranges::stable_sort(nearest_first_, [&](uint32_t a, uint32_t b) {
        return farthest_first ? draws_[a].nearest < draws_[b].nearest : draws_[a].nearest > draws_[b].nearest;
    });
    frame.draws = draws_.data();
    frame.draw_count = static_cast<uint32_t>(draws_.size());
    frame.nearest_first = nearest_first_.data();
    frame.draw_of_ids = draw_of_ids_.data();
    frame.first_line_id = static_cast<uint32_t>(draw_of_ids_.size()) * raster::kIdBlock;
}

Vec3<double> RasterDraws::place(size_t draw, size_t vertex) const {
    const float* const v = kept(draw, vertex);
    return Vec3<float>{v[0], v[raster::kFour], v[2 * raster::kFour]}.as<double>();
}

Vec3<double> RasterDraws::normal(size_t draw, size_t vertex) const {
    return unpacked_normal(kept(draw, vertex)[3 * raster::kFour]);
}

Vec3<double> unpacked_normal(float packed) {
    const auto bits = std::bit_cast<uint32_t>(packed);
    const auto part = [](uint32_t half) { return std::max(static_cast<int16_t>(half) / 32767.0, -1.0); };
    const double x = part(bits & 0xFFFF), y = part(bits >> 16), z = 1 - std::abs(x) - std::abs(y);
    const auto folded = [](double a, double b) { return (1 - std::abs(b)) * (a >= 0 ? 1 : -1); };
    return normalized(z < 0 ? Vec3<double>{folded(x, y), folded(y, x), z} : Vec3<double>{x, y, z});
}

}  // namespace throng::test
