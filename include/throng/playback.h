// What instances play: clips, and layers without states.
#pragma once

#include <throng/character.h>
#include <throng/controller.h>
#include <throng/index.h>

namespace throng {

// One clip as a character plays it. In groups without a controller the time is a float to which each update adds its
// step, so that after an hour at 60 updates a second it is off by some hundredths of a second (0.045 s for a clip of
// 60 s). Controllers count in 2^-32 of a cycle, and do not drift.
struct ClipPlayback {
    ClipIndex clip = kNone;  // index of Character::clips; kNone is the rest pose
    double time_s = 0;
    float speed = 1;   // seconds of clip per second; may be negative
    bool loop = true;  // else the time stays within [0, duration]
};

// What one instance plays: `first` with `weight`, `second` with 1 - weight. With weight 1 the second clip costs
// nothing. Weights do not change by themselves: for fades see LayerPlayback.
struct Playback {
    ClipPlayback first{}, second{};
    float weight = 1;
};

// A clip for a layer without states. It fades in over what the layer plays already, within `fade_s` seconds. kInertial:
// only this clip plays from now on, and the difference from what was shown decays (docs/controller.md, step 10); only
// on layers with ControllerLayer::inertial_plays.
struct LayerPlayback {
    ClipPlayback clip{};
    float fade_s = 0;
    FadeKind fade = FadeKind::kCross;
};

// How a layer without states is blended over those below it. The weight is reached in `fade_s` seconds, the rest
// changes at once.
struct LayerBlend {
    float weight = 1;
    float fade_s = 0;
    LayerMode mode = LayerMode::kOverride;
    MaskIndex mask = kNone;  // index of Controller::masks; kNone: all joints
};

}  // namespace throng
