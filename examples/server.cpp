// A game server without a GPU: 2,000 characters of several files, each under a controller, stepped 30 times a second of
// game time; shots are tested against hit boxes at six joints of each, and only these joints are computed.
//   server character.glb controller.json [character.glb controller.json ...]
#include "times.h"

#include <throng/throng.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <vector>

using namespace throng;

namespace {

constexpr uint32_t kCount = 2000, kHitBoxes = 6, kTicks = 300, kShots = 20;
constexpr float kTick_s = 1.0f / 30;

// The joints of the hit boxes: spread evenly over the rig, beginning with the root.
std::vector<uint32_t> hit_joints(const Character& character) {
    std::vector<uint32_t> joints;
    const uint32_t joint_count = character.rig.joint_count(), count = std::min(kHitBoxes, joint_count);
    for (uint32_t i = 0; i < count; ++i) joints.push_back(i * joint_count / count);
    return joints;
}

// Whether the line from `eye` along +z comes within `radius` of a hit box's middle.
bool hits(const Affine& world_from_joint, const Vec3<float>& eye, float radius) {
    const float x = world_from_joint.row[0][3] - eye.x, y = world_from_joint.row[1][3] - eye.y;
    return world_from_joint.row[2][3] > eye.z && x * x + y * y < radius * radius;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc % 2 == 0) {
        std::fprintf(stderr, "usage: server character.glb controller.json [character.glb controller.json ...]\n");
        return 2;
    }
    const auto kinds = static_cast<size_t>(argc / 2);
    std::vector<Character> characters;
    std::vector<Controller> controllers;
    for (size_t i = 0; i < kinds; ++i) {
        characters.push_back(load_character(argv[1 + 2 * i]).expect());
        controllers.push_back(load_controller(argv[2 + 2 * i]).expect());
    }
    const Device device = Device::create({.select = "native"}).expect();
    CrowdSettings settings;
    for (size_t i = 0; i < kinds; ++i)
        settings.groups.push_back({.character = &characters[i],
                                   .instance_count = static_cast<uint32_t>(kCount / kinds),
                                   .controller = &controllers[i],
                                   .sockets = hit_joints(characters[i]),
                                   .sockets_only = true});
    Crowd crowd = Crowd::create(device, settings).expect();

    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    for (uint32_t i = 0; i < crowd.instance_count(); ++i) {
        const Vec3<float> place{100 * unit(random), 0, 100 * unit(random)};
        crowd.set_placement(InstanceHandle{i}, to_affine(Trs<float>{.translation = place})).expect();
    }
    std::vector<double> ticks_ms;
    uint32_t hit_count = 0;
    for (uint32_t tick = 0; tick < kTicks; ++tick) {
        const Stopwatch stopwatch;
        const uint32_t player = tick * 7919 % crowd.instance_count();  // another player changes something in each tick
        crowd.set_parameter(InstanceHandle{player}, 0, 5 * unit(random)).expect();
        crowd.update(kTick_s).expect();
        for (uint32_t shot = 0; shot < kShots; ++shot) {
            const Vec3<float> eye{100 * unit(random), 2 * unit(random), 0};
            for (const OutputBlock& block : crowd.outputs())
                hit_count += static_cast<uint32_t>(
                    std::ranges::count_if(block.host.socket, [&](const Affine& box) { return hits(box, eye, 0.2f); }));
        }
        ticks_ms.push_back(stopwatch.elapsed().clock_ms);
    }
    std::ranges::sort(ticks_ms);
    std::printf("%u characters on %s: a tick takes %.2f ms (the slowest of %u: %.2f); %u hits\n",
                crowd.instance_count(), device.info().name.c_str(), ticks_ms[kTicks / 2], kTicks, ticks_ms.back(),
                hit_count);
}
