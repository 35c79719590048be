// Groups of all kinds in one crowd.
#pragma once

#include "tests/lively_crowd.h"

#include <algorithm>
#include <array>
#include <string>

namespace throng::test {

inline constexpr uint32_t kGroupCapacity = 24;  // of each group

inline std::string group_name(uint32_t group) {
    return std::array{"clips", "walker", "dragon", "springs", "agents"}.at(group);
}

inline uint32_t parameter_of(const Controller& controller, const char* name) {
    const auto found = std::ranges::find(controller.parameters, name, &ControllerParameter::name);
    return static_cast<uint32_t>(found - controller.parameters.begin());
}

// Groups of all kinds: two clips with poses from outside; root motion; inertial transitions and sockets; springs in the
// wind (if there is any); agents.
struct Kinds {
    Character character = creature(30, 10), walking = walking_creature();
    Controller walker = example("walker"), dragon = example("dragon");
    ProceduralRules rules{
        .targets = {"there"},
        .rules = {WindRule{.joint = character.rig.names[1]}, SpringRule{.joint = character.rig.names[1], .drag = 0.5f},
                  LookAtRule{.joint = character.rig.names.back(), .target = "there"}}};

    CrowdSettings settings(UpdatePath path) {
        CrowdSettings settings{.path = path, .culling = Culling{}, .watch_capacity = 5 * kGroupCapacity};
        if (path != UpdatePath::kAuto) settings.scan = "serial";  // otherwise crowds of other sizes use other methods
        settings.groups = {{.character = &character, .pose_capacity = kGroupCapacity},
                           {.character = &walking, .controller = &walker},
                           {.character = &character, .controller = &dragon, .sockets = {3, 7}},
                           {.character = &character, .procedural = &rules},
                           {.character = &character, .steering = Steering{.radius = 0.5f, .speed = 3}}};
        return settings;
    }
};

// Places far apart, so that agents do not meet.
inline Affine plot(uint32_t number) {
    return to_affine(
        Trs<float>{.translation = {static_cast<float>(number % 32) * 1000, 0, static_cast<float>(number / 32) * 1000}});
}

}  // namespace throng::test
