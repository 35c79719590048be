// The procedural stage on the CPU, in double precision.
#pragma once

#include "gpu/glsl.h"
#include "procedural/procedural_tables.h"
#include "procedural/wind_clock.h"

#include <span>

namespace throng {

// Moves the joints of one instance.
class ProceduralReference {
public:
    struct Target {
        Vec3<double> place;  // world
        double weight = 0;   // clamped to 0..1
    };

    // Keeps a reference to the character. Throws what plan_procedural() throws.
    ProceduralReference(const ProceduralRules& rules, const Character& character);

    std::vector<Target> targets;  // in the order of ProceduralRules::targets

    struct Moment {
        AffineT<double> world_from_model;
        WindClock::Moment wind;
        uint32_t instance = 0;  // index in the crowd
        double time_step_s = 0;
    };
    // `parent_from_joint`: [joint_count], as the blend stage left it; moved in place.
    void update(std::span<Trs<double>> parent_from_joint, const Moment& moment);

    // Like io::SpringState
    struct SpringState {
        io::Vector4<double> place, velocity, origin;
    };

private:
    const Character& character_;
    ProceduralTables tables_;
    std::vector<SpringState> springs_;
};

}  // namespace throng
