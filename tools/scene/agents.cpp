#include "tools/scene/agents.h"

#include "tools/creatures/creature_math.h"
#include "tools/scene/scatter.h"

#include <algorithm>
#include <numeric>

namespace throng::tools {
namespace {

// The smallest positive value of the parameter at a point of any blend space; 0 if there is none.
float slowest_place(const Controller& controller, const std::string& parameter) {
    float least = 0;
    for (const ControllerLayer& layer : controller.layers)
        for (const ControllerState& state : layer.states)
            for (const BlendPoint& point : state.points)
                for (const auto& [name, place] :
                     {std::pair(state.x_parameter, point.x), std::pair(state.y_parameter, point.y)})
                    if (name == parameter && place > 0 && (least == 0 || place < least)) least = place;
    return least;
}

}  // namespace

Steering steering_of(const Character& character, const Controller* controller, double scale) {
    // The radius is a fraction of the footprint, since arms are nearer to the body than in rest poses; the speed is a
    // walk's
    constexpr double kRadius = 0.35, kHeights_per_s = 0.8;
    const float height = character.bounds_max.y - character.bounds_min.y;
    Steering steering{.radius = static_cast<float>(std::max(kRadius * footprint(character) * scale, 1e-3)),
                      .speed = static_cast<float>(std::max(kHeights_per_s * double{height} * scale, 1e-3))};
    if (!controller) return steering;
    steering.speed_parameter = controller->find_parameter("speed");
    if (steering.speed_parameter == kNone) return steering;
    if (const float slowest = slowest_place(*controller, "speed"); slowest > 0)
        steering.speed = slowest * static_cast<float>(scale);
    return steering;
}

std::vector<Vec3<float>> each_others_places(std::span<const CrowdGroup> groups, std::span<const Affine> placement,
                                            uint64_t seed) {
    creature::Random random(seed);
    std::vector<uint32_t> order(placement.size());
    std::iota(order.begin(), order.end(), 0u);
    size_t first = 0;
    for (const CrowdGroup& group : groups) {
        // One cycle through all (S. Sattolo, An algorithm to generate a random cyclic permutation, 1986), so that all
        // move.
        for (size_t i = group.instance_count; i > 1; --i)
            std::swap(order[first + i - 1],
                      order[first + static_cast<size_t>(random.unit() * static_cast<double>(i - 1))]);
        first += group.instance_count;
    }
    std::vector<Vec3<float>> places;
    for (const uint32_t other : order)
        places.push_back({placement[other].row[0][3], placement[other].row[1][3], placement[other].row[2][3]});
    return places;
}

}  // namespace throng::tools
