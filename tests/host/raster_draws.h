// Draws for the native renderer's kernels, with the memory that they point to.
#pragma once

#include "native/aligned.h"
#include "raster/kernels.h"
#include "tests/test_rig.h"

#include <array>
#include <deque>
#include <span>
#include <vector>

namespace throng::test {

struct RasterVertex {
    Vec3<float> place, normal{0, 1, 0};  // world space
    std::array<float, 2> texcoord{};
    uint32_t color = 0xFFFFFFFF;  // red in the lowest byte
};

class RasterDraws {
public:
    // `corners`: three for each triangle.
    void add(const raster::Material& material, std::span<const RasterVertex> vertices,
             std::span<const uint32_t> corners, bool is_mirrored);
    // Makes the frame draw all of them: transforms their vertices with this kernel, and sorts the draws by distance.
    void set(raster::Frame& frame, const raster::Kernel& kernel, bool farthest_first = false);

    size_t count() const { return draws_.size(); }
    uint32_t first_id(size_t draw) const { return draws_[draw].first_id; }
    double size(size_t draw) const { return draws_[draw].size; }
    uint32_t draw_of(uint32_t id) const { return draw_of_ids_[id / raster::kIdBlock]; }
    // As stored by set().
    Vec3<double> place(size_t draw, size_t vertex) const;
    Vec3<double> normal(size_t draw, size_t vertex) const;

private:
    struct Mesh {
        std::vector<uint32_t> corners[3], colors;
        std::vector<float> texcoords;
        native::AlignedBytes world, kept;
        raster::Section section;
    };
    const float* kept(size_t draw, size_t vertex) const {
        return draws_[draw].vertices + vertex / raster::kFour * raster::kFourFloats + vertex % raster::kFour;
    }

    std::deque<Mesh> meshes_;
    std::vector<raster::Draw> draws_;
    std::vector<uint32_t> draw_of_ids_, nearest_first_;
};

// Decodes a normal as the kernels store it: octahedral, 16 bits per component.
Vec3<double> unpacked_normal(float packed);

}  // namespace throng::test
