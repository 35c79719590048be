#include "control/play_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace throng {
namespace {

constexpr float kMostCycles = 1e9f;  // of an update, and loops of a play: sums of two fit an int

}  // namespace

void push_play(io::LayerState& layer, io::LayerPlay play) {
    if (layer.play_count == 0) play.fade = 1;
    for (uint32_t k = io::kStackSize - 1; k > 0; --k) layer.plays[k] = layer.plays[k - 1];
    layer.plays[0] = play;
    layer.play_count = play.fade >= 1 ? 1 : std::min(layer.play_count + 1, io::kStackSize);
}

void advance_fades(io::LayerState& layer, float time_step_s) {
    for (uint32_t k = 0; k + 1 < layer.play_count; ++k) {
        io::LayerPlay& play = layer.plays[k];
        play.fade = std::min(play.fade + std::max(time_step_s, 0.0f) * play.fade_rate, 1.0f);
        if (play.fade >= 1) layer.play_count = k + 1;
    }
}

std::array<float, io::kStackSize> weights_of_plays(const io::LayerState& layer) {
    std::array<float, io::kStackSize> weights{};
    float remaining = 1;
    for (uint32_t k = 0; k < layer.play_count; ++k) {
        const float fade = layer.plays[k].fade;
        const float eased = k + 1 == layer.play_count ? 1 : (fade * fade) * (3 - 2 * fade);
        weights[k] = remaining * eased;
        remaining = remaining * (1 - eased);
    }
    return weights;
}

PhaseStep step_phase(io::LayerPlay& play, bool loop, float rate, float time_step_s) {
    float x = time_step_s * rate;
    x = std::isnan(x) ? 0 : std::clamp(x, -kMostCycles, kMostCycles);
    float whole = std::floor(x);
    float part = x - whole;
    if (part >= 1) {
        part = 0;
        whole = whole + 1;
    }
    PhaseStep step{.before = play.phase, .after = play.phase + static_cast<uint32_t>(part * 0x1p32f), .cycles = x};
    step.crossed = static_cast<int32_t>(whole) + (step.after < step.before ? 1 : 0);
    if (loop) {
        play.loops = static_cast<uint32_t>(
            std::clamp(static_cast<int32_t>(play.loops) + step.crossed, 0, static_cast<int32_t>(kMostCycles)));
    } else {
        if (step.crossed != 0) step.after = step.crossed > 0 ? io::kLastPhase : 0;
        step.crossed = 0;
        step.reached_end = step.after == io::kLastPhase && step.before != io::kLastPhase;
    }
    play.phase = step.after;
    return step;
}

std::vector<PassedEvent> passed_events(std::span<const io::ControlEvent> events, const PhaseStep& step,
                                       float time_step_s) {
    if (events.empty()) return {};
    constexpr int64_t kCycle = int64_t{1} << 32;
    const int64_t before = step.before, after = step.crossed * kCycle + step.after;
    const int64_t low = std::min(before, after), high = std::max(before, after) + (step.reached_end ? 1 : 0);
    std::vector<PassedEvent> passed;
    for (int64_t cycle = std::min(step.crossed, 0); cycle <= std::max(step.crossed, 0); ++cycle)
        for (const io::ControlEvent& event : events) {
            const int64_t place = cycle * kCycle + event.phase;
            if (place < low || place >= high) continue;
            const double distance = static_cast<double>(std::abs(place - before)) * 0x1p-32;
            passed.push_back(
                {event.event, std::abs(double{time_step_s}) * std::min(distance / std::abs(double{step.cycles}), 1.0)});
        }
    std::ranges::stable_sort(passed, {}, &PassedEvent::time_s);
    return passed;
}

}  // namespace throng
