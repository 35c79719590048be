// The crowds whose kernels `throng bench isa` compiles: each variant that a crowd can ask for is in one of them.
#pragma once

#include <throng/crowd.h>

#include <functional>
#include <string>

namespace throng::bench {

struct IsaConfiguration {
    std::string name;
    uint32_t characters = 0;  // that times are predicted for; 0: no predictions
    const Character* character = nullptr;
    CrowdSettings settings;
};

// Each calls `visit` for some configurations, whose character and settings live only during the call.
using VisitIsa = std::function<void(const IsaConfiguration&)>;
// Crowds of several sizes that play one or two clips in one pass, on the path that a device chooses.
void visit_default_forms(const VisitIsa& visit);
void visit_other_forms(const VisitIsa& visit);

}  // namespace throng::bench
