// Joints that move by rules: creatures walk in place in a wind, each with a tail and tendrils that swing and a head
// that follows a small creature flying around them. The artist's clips have nothing but walking and flying.
//   procedural creature.glb picture.png
// (./run throng generate makes such a creature)
#include <throng/throng.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace throng;

namespace {

Affine standing_at(float x, float y, float z, float scale = 1) {
    return {{{{scale, 0, 0, x}, {0, scale, 0, y}, {0, 0, scale, z}}}};
}

// The first joint whose name begins with `limb`, or the last one if `last` is set.
std::string joint_of(const Character& character, const std::string& limb, bool last = false) {
    std::string found;
    for (const std::string& name : character.rig.names)
        if (name.starts_with(limb) && (last || found.empty())) found = name;
    if (found.empty()) {
        std::fprintf(stderr, "procedural: %s: has no joint '%s…'\n", character.name.c_str(), limb.c_str());
        std::exit(1);
    }
    return found;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "usage: procedural creature.glb picture.png\n");
        return 2;
    }
    const Character creature = load_character(argv[1]).expect();
    const Device device = Device::create().expect();
    const ProceduralRules rules{
        .targets = {"prey"},
        .rules = {SpringRule{.joint = joint_of(creature, "tail"),
                             .frequency_hz = 1,
                             .damping = 0.3f,
                             .gravity = {0, -4, 0},
                             .drag = 0.4f},
                  LookAtRule{.joint = joint_of(creature, "trunk"), .target = "prey", .limit_rad = 0.4f},
                  LookAtRule{.joint = joint_of(creature, "trunk", true), .target = "prey", .limit_rad = 1.2f}}};

    constexpr uint32_t kSide = 7, kCount = kSide * kSide;
    Crowd crowd = Crowd::create(device,
                                {.groups = {{.character = &creature, .instance_count = kCount, .procedural = &rules},
                                            {.character = &creature, .instance_count = 1}}})
                      .expect();
    const ClipIndex walk = creature.find_clip("walk"), fly = creature.find_clip("fly");
    std::vector<Affine> places;
    std::vector<Playback> playbacks;
    for (uint32_t i = 0; i < kCount; ++i) {
        places.push_back(standing_at(5.0f * static_cast<float>(i % kSide), 0, 6.0f * static_cast<float>(i / kSide)));
        playbacks.push_back({.first = {.clip = walk, .time_s = 0.31 * i}});
    }
    playbacks.push_back({.first = {.clip = fly}});
    crowd.set_placement(crowd.instances(0).expect(), places).expect();
    crowd.set_playback(crowd.instances(), playbacks).expect();
    crowd.set_wind({.velocity = {6, 0, 0}, .gust = 0.6f, .wavelength = 12}).expect();

    // Four seconds, in which the small one flies half a circle.
    for (uint32_t frame = 0; frame < 240; ++frame) {
        const float angle_rad = 0.013f * static_cast<float>(frame), x = 15 - 18 * std::cos(angle_rad),
                    z = 18 + 22 * std::sin(angle_rad);
        crowd.set_placement(InstanceHandle{kCount}, standing_at(x, 6, z, 0.8f)).expect();
        crowd.set_target(crowd.instances(0).expect(), 0, {{x, 7, z}, 1}).expect();
        crowd.update(1.0f / 60).expect();
    }
    const StageTimes times = crowd.stage_times().expect();
    std::printf("%u characters, %u joints: %.2f ms of %.2f ms for their rules\n", kCount,
                kCount * creature.rig.joint_count(), times.of("procedural"), times.total());

    Renderer renderer = Renderer::create(device, {.width = 1280, .height = 720}).expect();
    const RenderResult result = renderer.render(crowd, fit_camera(main_bounds(crowd), 1280.0f / 720)).expect();
    write_png(argv[2], result.picture).expect();
    return 0;
}
