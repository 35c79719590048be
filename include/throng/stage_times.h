// The stages of an update, and the time that each takes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace throng {

// The most stages that an update can have. Has room for those of later versions, so that the size of StageTimes stays
// the same.
inline constexpr size_t kStageLimit = 32;

// The names of the stages in the order of an update, as they are timed; a later version may have more, in between too.
// "fused" is sample, blend, scan and bind of the groups that are updated in one pass. "update_rate" moves the matrices
// of instances that are not animated in this update towards their next pose. "commands" is for
// CrowdGroup::shader_commands, "terrain" for CrowdGroup::terrain, "attach" for CrowdGroup::is_carried, and "skin"
// for CrowdSettings::skins_once. "blend" includes the weights of morphs.
std::span<const char* const> stage_names();

// The index of a stage's name in stage_names(), or their number if no stage has that name.
size_t index_of_stage(std::string_view name);

// Time of each stage in the last finished update, summed over its dispatches, milliseconds: GPU time or, for updates by
// this machine's processor (UpdatePath::kNative), wall-clock time.
struct StageTimes {
    std::array<double, kStageLimit> ms{};  // by stage_names(), then zeros; 0 where the crowd does not have the stage

    // The time of the stage called `name`; 0 if there is none.
    double of(std::string_view name) const;
    constexpr double total() const {
        double sum = 0;
        for (const double one : ms) sum += one;
        return sum;
    }
};

}  // namespace throng
