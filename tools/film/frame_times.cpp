#include "tools/film/frame_times.h"

#include "tools/cli/statistics.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <vector>

namespace throng::tools {

FrameTimes median_of(std::span<const FrameTimes> frames) {
    FrameTimes median;
    const auto of = [&](const auto& time_of) {
        std::vector<double> times;
        for (const FrameTimes& frame : frames) times.push_back(time_of(frame));
        return spread_of(std::move(times)).median;
    };
    for (size_t s = 0; s < stage_names().size(); ++s)
        median.stages.ms[s] = of([s](const FrameTimes& frame) { return frame.stages.ms[s]; });
    median.draw_ms = of([](const FrameTimes& frame) { return frame.draw_ms; });
    return median;
}

nlohmann::json to_json(const FrameTimes& times) {
    nlohmann::json stages{{"skin+draw", times.draw_ms}};
    for (size_t s = 0; s < stage_names().size(); ++s) stages[stage_names()[s]] = times.stages.ms[s];
    return stages;
}

void print_times(const FrameTimes& times) {
    std::printf(" ");
    for (size_t s = 0; s < stage_names().size(); ++s)
        if (times.stages.ms[s] > 0) std::printf(" %s %.2f ms,", stage_names()[s], times.stages.ms[s]);
    std::printf(" skin+draw %.2f ms\n", times.draw_ms);
}

void print_drawn(std::span<const uint32_t> drawn) {
    std::printf("  drawn by level of detail:");
    for (const uint32_t count : drawn) std::printf(" %u", count);
    std::printf("\n");
}

}  // namespace throng::tools
