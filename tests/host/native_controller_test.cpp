// The controller kernels as devices without Vulkan run them, against the reference.
#include "control/commands.kernel.h"
#include "control/controller.kernel.h"
#include "tests/controller_follow.h"
#include "tests/controller_instance.h"
#include "tests/host/native_runner.h"
#include "tests/random_controllers.h"

namespace throng::test {
namespace {

class NativeKernels {
public:
    NativeKernels(const Controller& controller, const Character& character, uint32_t count)
        : made_(make_controller_tables(controller, character)),
          count_(count),
          joint_count_(character.rig.joint_count()),
          timelines_(timeline_words(character)),
          times_s_(character.times_s),
          layers_(as_words(repeated(made_.initial_layers, count))),
          parameters_(repeated(made_.initial_parameters, count)),
          active_clips_(unwritten<io::ActiveClip>(count * size_t{made_.active_clip_limit})),
          active_clip_times_(unwritten<float>(active_clips_.size())),
          events_(sizeof(io::EventHead) / 4 + kEventCapacity * sizeof(io::EventRecord) / 4) {
        controller_.bind(io::kControllerBuffer, made_.words).bind(io::kTimelineBuffer, timelines_);
        controller_.bind(io::kTimesBuffer, times_s_).bind(io::kRootRowsBuffer, root_rows_);
        controller_.bind(io::kLayersBuffer, layers_).bind(io::kParametersBuffer, parameters_);
        controller_.bind(io::kActiveClipsBuffer, active_clips_).bind(io::kActiveClipTimesBuffer, active_clip_times_);
        controller_.bind(io::kEventsBuffer, events_);
        commands_.bind(io::kLayersBuffer, layers_).bind(io::kParametersBuffer, parameters_);
    }

    void update(std::span<const io::ControlCommand> commands, float time_step_s) {
        std::vector<io::ControlCommand> told(commands.begin(), commands.end());
        const auto told_count = static_cast<uint32_t>(told.size());
        commands_.bind(io::kCommandsBuffer, told);
        commands_.invocations(io::CommandPush{told_count, made_.layout.layer_count, made_.layout.parameter_count},
                              told_count);
        events_[0] = 0;
        controller_.invocations(io::ControllerPush{count_, 1000, joint_count_, made_.active_clip_limit, kEventCapacity,
                                                   time_step_s, io::kPushTellsTimes},
                                count_);
    }
    std::vector<io::LayerState> layers() const { return layer_states_of(layers_); }
    const std::vector<float>& parameters() const { return parameters_; }
    const std::vector<io::ActiveClip>& active_clips() const { return active_clips_; }
    const std::vector<float>& active_clip_times() const { return active_clip_times_; }
    EventBlock events() const { return event_block_of(events_); }
    const ControllerTables& made() const { return made_; }

private:
    ControllerTables made_;
    uint32_t count_, joint_count_;
    std::vector<uint32_t> timelines_;
    std::vector<float> times_s_;
    std::vector<io::vec4> root_rows_{{0, 0, 1, 0}};
    std::vector<uint32_t> layers_;
    std::vector<float> parameters_;
    std::vector<io::ActiveClip> active_clips_;
    std::vector<float> active_clip_times_;
    std::vector<uint32_t> events_;
    NativeRun controller_{kernels::controller.native}, commands_{kernels::commands.native};
};

TEST(NativeController, AgreesWithTheReferenceOfAnyController) {
    Random random(8);
    Followed all;
    for (int round = 0; round < 40 && !HasFailure(); ++round) {
        Exact exact = random_controller(random);
        add_random_transitions(random, exact.controller);
        const Followed followed = follow<NativeKernels>(
            exact.controller, character_of(exact.durations_s), 100, 60,
            [&](Random& of_commands) { return random_commands(of_commands, exact.controller, 100); });
        all.event_count += followed.event_count;
        all.transition_count += followed.transition_count;
    }
    EXPECT_GT(all.event_count, 10'000u);
    EXPECT_GT(all.transition_count, 10'000u);
}

TEST(NativeController, AgreesWithTheReferenceAsADragon) { follow_example<NativeKernels>("dragon", 100, 1000); }
TEST(NativeController, DirectLayersFollowPlayCommands) { follow_direct_layers<NativeKernels>(); }

}  // namespace
}  // namespace throng::test
