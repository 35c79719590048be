// The definition of the blend stage.
#pragma once

#include <throng/transform.h>

namespace throng {

// weight * a + (1 - weight) * b: translation and scale linearly; rotation along the shorter arc, normalised.
Trs<double> blend_reference(const Trs<double>& a, const Trs<double>& b, double weight);

}  // namespace throng
