// Gives characters with controllers something to do, as a game would, by setting parameters now and then. The same for
// the same seed and steps.
#pragma once

#include "tools/creatures/creature_math.h"

#include <throng/crowd.h>

#include <span>
#include <utility>
#include <vector>

namespace throng::tools {

// The values that a parameter can be set to. For numbers: the range that the controller's blend spaces and conditions
// cover, or 0 to 1 if they do not use it.
struct ParameterRange {
    ParameterType type = ParameterType::kFloat;
    float least = 0, most = 1;
};
ParameterRange parameter_range(const Controller& controller, uint32_t parameter);

class Director {
public:
    // Directs the groups of a crowd; those without a controller are left alone.
    Director(std::span<const CrowdGroup> groups, uint64_t seed);

    // Call before an update by `step_s`. In each second about a third of the characters get a new value for one of
    // their parameters. The cost depends on how many those are, not on how long the step is.
    void direct(Crowd& crowd, double step_s);

private:
    struct Cast {
        uint32_t first_instance, instance_count;
        // Numbers and ranges of the parameters, without the one that steering sets
        std::vector<std::pair<uint32_t, ParameterRange>> parameters;
        double owed = 0;  // characters that are due for a new value, below 1 after direct()
    };
    std::vector<Cast> casts_;
    creature::Random random_;
};

}  // namespace throng::tools
