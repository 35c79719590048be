#include "draw/native_lines.h"

#include "gpu/native_text.h"

#include <algorithm>
#include <array>
#include <bit>

namespace throng {
namespace io {
namespace {

struct LineText {
    const DrawScene& scene;

#include "draw/line.glsl"

    void add(const WorldLine& line, std::vector<raster::Line>& lines) {
        std::array<vec4, 4> corners;
        for (uint corner = 0; corner < 4; ++corner) corners[corner] = line_corner(line, corner);
        if (is_outside(corners)) return;
        raster::Line& added = lines.emplace_back();
        for (uint corner = 0; corner < 4; ++corner) {
            const vec4& at = corners[corner];
            std::ranges::copy(std::array{at.x, at.y, at.z, at.w}, added.corners[corner]);
        }
        std::ranges::copy(std::array{line.color.x, line.color.y, line.color.z}, added.color);
    }

    // Whether all corners lie beyond the same side of the picture.
    static bool is_outside(const std::array<vec4, 4>& corners) {
        const auto all = [&](const auto& is_beyond) { return std::ranges::all_of(corners, is_beyond); };
        return all([](const vec4& at) { return at.x > at.w; }) || all([](const vec4& at) { return at.x < -at.w; }) ||
               all([](const vec4& at) { return at.y > at.w; }) || all([](const vec4& at) { return at.y < -at.w; });
    }
};

}  // namespace
}  // namespace io

void add_box_lines(const io::DrawScene& scene, const Affine& world_from_model, const Bounds& box,
                   std::vector<raster::Line>& lines) {
    constexpr uint32_t kEdges = 12;
    const Vec3<float> centre = (box.min + box.max) * 0.5f, half = (box.max - box.min) * 0.5f;
    io::LineText text{scene};
    const auto place = std::bit_cast<io::Affine>(world_from_model);
    for (uint32_t edge = 0; edge < kEdges; ++edge)
        text.add(text.box_edge(place, io::copied<io::vec3>(&centre), io::copied<io::vec3>(&half), edge), lines);
}

void add_skeleton_lines(const io::DrawScene& scene, const Affine& world_from_model,
                        std::span<const io::JointLevel> joints, uint32_t level_count, const Affine* model_from_joint,
                        std::vector<raster::Line>& lines) {
    io::LineText text{scene};
    const auto place = std::bit_cast<io::Affine>(world_from_model);
    for (uint32_t joint = 0; joint < joints.size(); ++joint) {
        const uint32_t parent = joints[joint].parent;
        if (parent >= joint) continue;  // a root
        text.add(text.bone_line(place, std::bit_cast<io::Affine>(model_from_joint[joint]),
                                std::bit_cast<io::Affine>(model_from_joint[parent]), joints[joint].level, level_count),
                 lines);
    }
}

}  // namespace throng
