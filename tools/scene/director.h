// Gives characters with controllers something to do, as a game would: now and then one is told something new. The same
// for the same seed and steps.
#pragma once

#include "tools/creatures/creature_math.h"

#include <throng/crowd.h>

#include <span>
#include <utility>
#include <vector>

namespace throng::tools {

// What a parameter may be told: of numbers what the controller's blend spaces and conditions ask about, else 0 to 1.
struct ParameterRange {
    ParameterType type = ParameterType::kFloat;
    float least = 0, most = 1;
};
ParameterRange parameter_range(const Controller& controller, uint32_t parameter);

class Director {
public:
    // Directs the groups of a crowd; those without a controller are left alone.
    Director(std::span<const CrowdGroup> groups, uint64_t seed);

    // Before an update by `step_s`: in each second about a third of the characters are told one of their parameters.
    // Costs time by how many that are, not by how long the step is.
    void direct(Crowd& crowd, double step_s);

private:
    struct Cast {
        uint32_t first_instance, instance_count;
        // Their numbers, without that which steering tells
        std::vector<std::pair<uint32_t, ParameterRange>> parameters;
        double owed = 0;  // of a character that is not told yet
    };
    std::vector<Cast> casts_;
    creature::Random random_;
};

}  // namespace throng::tools
