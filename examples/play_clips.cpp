// Clips played from code, by their names: each character fades from one to the other at a time of its own, and reports
// when its foot comes down and where one of its joints is.
//   play_clips character.glb CLIP OTHER_CLIP JOINT
#include <throng/throng.h>

#include <cstdio>

using namespace throng;

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: play_clips character.glb CLIP OTHER_CLIP JOINT\n");
        return 2;
    }
    const Character character = load_character(argv[1]).expect();
    // An unknown name ends the program, with a line that says which names there are.
    const ClipIndex clips[]{character.clip_named(argv[2]).expect(), character.clip_named(argv[3]).expect()};
    const uint32_t joint = character.rig.joint_named(argv[4]).expect();

    // A layer that plays what play() says, with fades. An event is a moment of a clip.
    Controller controller = direct_layers(1);
    controller.events = {{.name = "step", .clip = argv[2], .time_s = character.clips[clips[0]].duration_s / 2.0}};

    // Instances come and go, and there is room for eight. The feedback reports where the joint is in the world.
    const Device device = Device::create().expect();
    CrowdGroup group{.character = &character, .controller = &controller, .sockets = {joint}, .capacity = 8};
    Crowd crowd = Crowd::create(device, {.groups = {group}}).expect();
    InstanceHandle walkers[5];
    for (uint32_t i = 0; i < 5; ++i) {
        const Vec3<float> place{static_cast<float>(i) * character.size, 0, 0};
        walkers[i] = crowd.spawn(0, to_affine(Trs<float>{.translation = place})).expect();
        crowd.play(walkers[i], 0, {.clip = {.clip = clips[0], .time_s = 0.1 * i}}).expect();
    }
    crowd.watch(walkers).expect();

    uint32_t step_count = 0;
    for (int frame = 0; frame < 180; ++frame) {
        const auto turn = static_cast<size_t>(frame / 36);  // one after the other
        if (frame % 36 == 18) crowd.play(walkers[turn], 0, {.clip = {.clip = clips[1]}, .fade_s = 0.3f}).expect();
        crowd.update(1.0f / 60).expect();
        for (const Feedback& feedback : crowd.feedback().expect()) {  // of the updates that have finished since
            step_count += static_cast<uint32_t>(feedback.events.size());
            if (frame % 60 < 59) continue;
            for (const WatchedInstance& walker : feedback.watched) {
                const Affine& world_from_joint = walker.sockets[0];
                const PlayedMotion& leading = walker.layers[0][0];
                std::printf(
                    "%.1f s, %u: %s, %.0f %% in; %s at %.2f %.2f %.2f\n", (frame + 1) / 60.0, walker.instance.instance,
                    character.clips[leading.motion].name.c_str(), 100 * static_cast<double>(leading.fade), argv[4],
                    static_cast<double>(world_from_joint.row[0][3]), static_cast<double>(world_from_joint.row[1][3]),
                    static_cast<double>(world_from_joint.row[2][3]));
            }
        }
    }
    crowd.despawn(walkers[0]).expect();
    std::printf("%u steps; %u characters are left\n", step_count, crowd.alive_count(0).expect());
    return step_count > 0 ? 0 : 1;
}
