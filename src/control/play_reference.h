// The definition of a layer's stack of plays: steps 3, 5, 6 and 7 of docs/controller.md.
#pragma once

#include "control/controller_io.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// Step 3, but for the phase: `play` leads.
void push_play(io::LayerState& layer, io::LayerPlay play);

// Step 5: fades go on, and what they cover is dropped; then how much of each play is seen.
void advance_fades(io::LayerState& layer, float time_step_s);
std::array<float, io::kStackSize> weights_of_plays(const io::LayerState& layer);

// Step 6: what an update did to a play's time.
struct PhaseStep {
    uint32_t before = 0, after = 0;
    int32_t crossed = 0;       // ends of the clip, forwards counted positive; 0 of what does not loop
    bool reached_end = false;  // of what does not loop
    float cycles = 0;          // x
};
PhaseStep step_phase(io::LayerPlay& play, bool loop, float rate, float time_step_s);

// Step 7: the events that a clip passed, in the order in which they happened.
struct PassedEvent {
    uint32_t event;  // index into Controller::events
    double time_s;   // 0..|time step|
};
std::vector<PassedEvent> passed_events(std::span<const io::ControlEvent> events, const PhaseStep& step,
                                       float time_step_s);

}  // namespace throng
