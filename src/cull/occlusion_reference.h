// Whether a box is hidden behind what has been drawn: the definition of reveal.comp, in double precision.
#pragma once

#include "cull/cull_reference.h"

#include <span>

namespace throng {

// The depth of the nearest point of the box and its shadow's path, minus the farthest depth of the picture in the
// rectangle that they cover. They are hidden if this is negative. Infinite if a part of the box is behind the eye.
// `depths`: [height][width], greater where nearer, like the clip-space depths of the view. The depth pyramid tests a
// larger rectangle, so it hides less.
double shown_by(const io::CullView& view, const AffineT<double>& world_from_model, const CullBox& box,
                std::span<const float> depths, uint32_t width, uint32_t height);

}  // namespace throng
