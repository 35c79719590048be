// The stages of an update, and the GPU time of each.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace throng {

// The stages of an update in their order, as they are timed. "fused" is sample, blend, scan and bind of the groups that
// are updated in one pass. "update_rate" moves the matrices of instances that are not animated in this update towards
// their next pose. "commands" is for CrowdGroup::command_capacity, "terrain" for CrowdSettings::terrain, "attach" for
// CrowdGroup::is_carried, and "skin" for CrowdSettings::skins_once. "blend" includes the weights of morphs.
inline constexpr std::array<const char*, 14> kStageNames{"commands", "control",     "steer",      "terrain", "cull",
                                                         "sample",   "blend",       "procedural", "scan",    "bind",
                                                         "fused",    "update_rate", "attach",     "skin"};

// The index of a stage's name in kStageNames, or kStageNames.size() if no stage has that name.
constexpr size_t index_of_stage(std::string_view name) {
    size_t i = 0;
    while (i < kStageNames.size() && name != kStageNames[i]) ++i;
    return i;
}

// GPU time of each stage in the last finished update, summed over its dispatches, milliseconds.
struct StageTimes {
    std::array<double, kStageNames.size()> ms{};  // 0 where the crowd does not have the stage

    // The time of the stage called `name`; 0 if there is none.
    constexpr double of(std::string_view name) const {
        const size_t i = index_of_stage(name);
        return i < ms.size() ? ms[i] : 0;
    }
    constexpr double total() const {
        double sum = 0;
        for (const double one : ms) sum += one;
        return sum;
    }
};

}  // namespace throng
