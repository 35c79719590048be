// The crowds whose kernels `throng bench isa` compiles: each variant that a crowd can ask for is in one of them.
#pragma once

#include <throng/crowd.h>

#include <functional>
#include <string>

namespace throng::bench {

struct IsaConfiguration {
    std::string name;
    uint32_t characters = 0;  // that times are predicted for; 0: none are
    const Character* character = nullptr;
    CrowdSettings settings;
};

// Each calls `visit` for some, whose character and settings live as long as the call.
using VisitIsa = std::function<void(const IsaConfiguration&)>;
// Crowds of several sizes that play two clips or one, in one pass, as a device chooses to do it.
void visit_default_forms(const VisitIsa& visit);
void visit_other_forms(const VisitIsa& visit);

}  // namespace throng::bench
