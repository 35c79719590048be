// The definition of the procedural stage.
#pragma once

#include "procedural/procedural_plan.h"
#include "procedural/wind_clock.h"

#include <span>

namespace throng {

// The joints of one instance, moved in the order of the rules.
class ProceduralReference {
public:
    struct Target {
        Vec3<double> place;  // world
        double weight = 0;   // clamped to 0..1
    };

    // Refers to both. Throws what plan_procedural() does.
    ProceduralReference(const ProceduralRules& rules, const Character& character);

    std::vector<Target> targets;  // as ProceduralRules::targets

    struct Moment {
        AffineT<double> world_from_model;
        WindClock::Moment wind;
        uint32_t instance = 0;  // of the crowd
        double time_step_s = 0;
    };
    // parent_from_joint[joint_count], as the blend stage left it.
    void update(std::span<Trs<double>> parent_from_joint, const Moment& moment);

private:
    struct Spring {
        Vec3<double> place, velocity;
        bool is_known = false;
    };
    struct Update;  // one call

    const ProceduralRules& rules_;
    const Character& character_;
    ProceduralPlan plan_;
    std::vector<Spring> springs_;
};

}  // namespace throng
