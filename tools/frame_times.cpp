#include "tools/frame_times.h"

#include "bench/statistics.h"
#include "tools/stages.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <vector>

namespace throng::tools {

FrameTimes median_of(std::span<const FrameTimes> frames) {
    FrameTimes median;
    const auto of = [&](const auto& time_of) {
        std::vector<double> times;
        for (const FrameTimes& frame : frames) times.push_back(time_of(frame));
        return bench::spread_of(std::move(times)).median;
    };
    for (const auto& [name, member] : kStages)
        median.stages.*member = of([member = member](const FrameTimes& frame) { return frame.stages.*member; });
    median.draw_ms = of([](const FrameTimes& frame) { return frame.draw_ms; });
    return median;
}

nlohmann::json to_json(const FrameTimes& times) {
    nlohmann::json stages{{"skin+draw", times.draw_ms}};
    for (const auto& [name, member] : kStages) stages[name] = times.stages.*member;
    return stages;
}

void print_times(const FrameTimes& times) {
    std::printf(" ");
    for (const auto& [name, member] : kStages) std::printf(" %s %.2f ms,", name, times.stages.*member);
    std::printf(" skin+draw %.2f ms\n", times.draw_ms);
}

void print_drawn(std::span<const uint32_t> drawn) {
    std::printf("  drawn by level of detail:");
    for (const uint32_t count : drawn) std::printf(" %u", count);
    std::printf("\n");
}

}  // namespace throng::tools
