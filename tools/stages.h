// The stages of an update in their order, for everything that is printed about them.
#pragma once

#include <throng/crowd.h>

#include <array>
#include <utility>

namespace throng::tools {

inline constexpr std::array<std::pair<const char*, double StageTimes::*>, 11> kStages{
    {{"control", &StageTimes::control},
     {"steer", &StageTimes::steer},
     {"cull", &StageTimes::cull},
     {"sample", &StageTimes::sample},
     {"blend", &StageTimes::blend},
     {"procedural", &StageTimes::procedural},
     {"scan", &StageTimes::scan},
     {"bind", &StageTimes::bind},
     {"fused", &StageTimes::fused},
     {"pace", &StageTimes::pace},
     {"skin", &StageTimes::skin}}};

}  // namespace throng::tools
