#include <throng/stage_times.h>

#include <algorithm>

namespace throng {
namespace {

constexpr auto kStageNames = std::to_array<const char*>({"commands", "control", "steer", "terrain", "cull", "sample",
                                                         "blend", "procedural", "scan", "bind", "fused", "update_rate",
                                                         "attach", "skin"});
static_assert(kStageNames.size() <= kStageLimit);

}  // namespace

std::span<const char* const> stage_names() { return kStageNames; }

size_t index_of_stage(std::string_view name) {
    return static_cast<size_t>(std::ranges::find(kStageNames, name) - kStageNames.begin());
}

double StageTimes::of(std::string_view name) const {
    const size_t stage = index_of_stage(name);
    return stage < kStageNames.size() ? ms[stage] : 0;
}

}  // namespace throng
