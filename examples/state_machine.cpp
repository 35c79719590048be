// Characters under controllers, which carry things: they stand, walk, run and strike, as the GPU decides by two
// parameters. Each has a lantern at its highest joint. The events of three of them are printed as they come back.
//   state_machine creature.glb guard.json picture.png
// (./run throng generate makes such a creature, with the clips idle, walk and fly; examples/controllers has the
// controller)
#include <throng/throng.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

using namespace throng;

namespace {

Affine standing_at(float x, float y, float z, float scale = 1) {
    return {{{{scale, 0, 0, x}, {0, scale, 0, y}, {0, 0, scale, z}}}};
}

// The highest joint of the rest pose: where a lantern hangs best.
uint32_t highest_joint(const Character& character) {
    const ReferencePose rest = reference_pose(character, {}).expect();
    const auto height = [](const auto& model_from_joint) { return model_from_joint.row[1][3]; };
    const auto highest = std::max_element(rest.model_from_joint.begin(), rest.model_from_joint.end(),
                                          [&](const auto& a, const auto& b) { return height(a) < height(b); });
    return static_cast<uint32_t>(highest - rest.model_from_joint.begin());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: state_machine creature.glb controller.json picture.png\n");
        return 2;
    }
    const Character guard = load_character(argv[1]).expect();
    const Controller controller = load_controller(argv[2]).expect();
    const Device device = Device::create().expect();

    // 100 guards with a controller, and what they carry: small creatures that hang at the guards' sockets.
    constexpr uint32_t kSide = 10, kCount = kSide * kSide;
    Crowd crowd = Crowd::create(device, {.groups = {{.character = &guard,
                                                     .instance_count = kCount,
                                                     .controller = &controller,
                                                     .sockets = {highest_joint(guard)}},
                                                    {.character = &guard, .instance_count = kCount}},
                                         .watch_capacity = kCount})
                      .expect();
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i)
        places.push_back(standing_at(3.0f * static_cast<float>(i % kSide), 0, 6.0f * static_cast<float>(i / kSide)));
    crowd.set_placement(crowd.instances(0).expect(), places).expect();
    crowd.watch(crowd.instances(0).expect()).expect();

    const ParameterIndex speed = controller.find_parameter("speed"), attack = controller.find_parameter("attack");
    if (speed == kNone || attack == kNone) {
        std::fprintf(stderr, "state_machine: %s: needs the parameters 'speed' and 'attack'\n", argv[2]);
        return 1;
    }

    // Four seconds. Each guard gets a pace of its own; now and then one strikes. Only what changes is sent.
    constexpr uint32_t kFrames = 240;
    uint32_t steps = 0, strikes = 0;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        if (frame < kCount) crowd.set_parameter(InstanceHandle{frame}, speed, static_cast<float>(frame % 5)).expect();
        if (frame % 10 == 0) crowd.set_parameter(InstanceHandle{(frame * 7) % kCount}, attack, 1.0f).expect();
        crowd.update(1.0f / 60).expect();

        for (const Feedback& feedback : crowd.feedback().expect()) {
            for (const CharacterEvent& event : feedback.events) {
                const std::string& name = controller.events[event.event].name;
                ++(name == "strike" ? strikes : steps);
                if (event.instance.instance < 3)
                    std::printf("%.3f s: guard %u: %s\n",
                                (static_cast<double>(feedback.update) - 1) / 60 + static_cast<double>(event.time_s),
                                event.instance.instance, name.c_str());
            }
            // Here the CPU moves the lanterns; your own renderer can read OutputBlock::socket and need not wait for
            // anything.
            for (const WatchedInstance& watched : feedback.watched)
                crowd
                    .set_placement(InstanceHandle{kCount + watched.instance.instance},
                                   watched.sockets[0] * standing_at(0, 0, 0, 0.15f))
                    .expect();
        }
    }
    std::printf("%u steps and %u strikes of %u guards in %u updates\n", steps, strikes, kCount, kFrames);

    Renderer renderer = Renderer::create(device, {.width = 1280, .height = 720}).expect();
    const RenderResult result = renderer.render(crowd, fit_camera(main_bounds(crowd), 1280.0f / 720)).expect();
    write_png(argv[3], result.picture).expect();
    return steps > 0 && strikes > 0 ? 0 : 1;
}
