// The rules that every controller must keep, whether it was read from JSON or made in code.
#pragma once

#include <throng/controller.h>

namespace throng {

inline constexpr size_t kLayerLimit = 16;
inline constexpr size_t kStateLimit = 1'024;       // of a layer
inline constexpr size_t kTransitionLimit = 4'096;  // of a layer
// In all layers of a controller; a transition from any state counts once for each state of its layer
inline constexpr size_t kAllTransitionsLimit = 1'048'576;
inline constexpr size_t kBlendPointLimit = 64;  // of a state
inline constexpr size_t kParameterLimit = 256;
inline constexpr size_t kEventLimit = 4'096;
inline constexpr size_t kMaskLimit = 256;
inline constexpr size_t kMaskItemLimit = 4'096;  // of a mask
inline constexpr float kExitLimit = 1e6f;        // cycles
inline constexpr float kMinFade_s = 1e-4f;       // 1 / fade must not overflow; a shorter one would be invisible
inline constexpr float kMaxFade_s = 1e3f;
inline constexpr float kBlendPlaceLimit = 1e6f;    // of blend points
inline constexpr float kMinBlendDistance = 1e-6f;  // between them; 1 / distance must not overflow

// Throws kInvalidArgument or kLimit. The place of an error is a path in the JSON, such as
// layers[0].states.walk.clips[1].at.
void check_rules(const Controller& controller);

}  // namespace throng
