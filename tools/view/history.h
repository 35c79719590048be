// What the last frames took, for the graph.
#pragma once

#include <throng/crowd.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace throng::view {

// The times of an update's stages and, after the last stage that there may be, of drawing; milliseconds.
inline constexpr size_t kTimedCount = kStageLimit + 1;
using FrameTimes = std::array<float, kTimedCount>;

class History {
public:
    static constexpr size_t kFrames = 240;

    void add(const StageTimes& stages, double draw_ms) {
        FrameTimes& times = frames_[count_++ % kFrames];
        std::ranges::transform(stages.ms, times.begin(), [](double ms) { return static_cast<float>(ms); });
        times.back() = static_cast<float>(draw_ms);
    }

    size_t size() const { return std::min(count_, kFrames); }
    // 0 is the latest.
    const FrameTimes& ago(size_t frames) const { return frames_[(count_ - 1 - frames) % kFrames]; }
    // Over the latest frames, so that the numbers change slowly enough to be read.
    FrameTimes mean() const {
        const size_t count = std::min<size_t>(size(), 20);
        FrameTimes mean{};
        for (size_t frame = 0; frame < count; ++frame)
            for (size_t i = 0; i < kTimedCount; ++i) mean[i] += ago(frame)[i] / static_cast<float>(count);
        return mean;
    }

private:
    std::array<FrameTimes, kFrames> frames_{};
    size_t count_ = 0;
};

inline const char* timed_name(size_t timed) { return timed < stage_names().size() ? stage_names()[timed] : "draw"; }

// The number of stages that have a colour of their own in the graph; a test checks that all stages have.
size_t stage_color_count();

}  // namespace throng::view
