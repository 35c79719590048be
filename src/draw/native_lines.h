// Lines over a crowd for the native renderer.
#pragma once

#include "draw/draw_io.h"
#include "raster/frame.h"

#include <throng/draw.h>

#include <span>
#include <vector>

namespace throng {

// Appends the edges of the box, except those that lie entirely beyond one side of the picture.
void add_box_lines(const io::DrawScene& scene, const Affine& world_from_model, const Bounds& box,
                   std::vector<raster::Line>& lines);
// `model_from_joint`: an instance's matrices, as many as `joints`.
void add_skeleton_lines(const io::DrawScene& scene, const Affine& world_from_model,
                        std::span<const io::JointLevel> joints, uint32_t level_count, const Affine* model_from_joint,
                        std::vector<raster::Line>& lines);

}  // namespace throng
