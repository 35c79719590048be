// The definition of the bind stage.
#pragma once

#include <throng/character.h>

#include <span>

namespace throng {

// model_from_bind = model_from_joint * joint_from_bind, for every palette entry.
std::vector<AffineT<double>> bind_reference(std::span<const PaletteEntry> palette,
                                            std::span<const AffineT<double>> model_from_joint);

}  // namespace throng
