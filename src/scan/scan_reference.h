// The definition of the scan stage, which all methods implement.
#pragma once

#include <throng/character.h>

#include <span>

namespace throng {

// model_from_joint = model_from_parent * parent_from_joint; parents[j] < j, or kNone.
std::vector<AffineT<double>> scan_reference(std::span<const uint32_t> parents,
                                            std::span<const AffineT<double>> parent_from_joint);

}  // namespace throng
