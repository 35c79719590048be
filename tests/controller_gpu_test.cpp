// The controller kernel on the device against the reference.
#include "control/control.h"
#include "tests/controller_follow.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kControllerGpuInSubsets({Subset::kGpuAssisted}, {"ControllerOnTheGpu.DirectLayersFollowPlayCommands"});
const InSubset kControllerGpuNatively({Subset::kNative}, {"ControllerOnTheGpu.*"});

// The kernel's buffers for instances of one controller.
class Kernels {
public:
    Kernels(const Controller& controller, const Character& character, uint32_t count)
        : made_(make_controller_tables(controller, character)),
          count_(count),
          joint_count_(character.rig.joint_count()),
          tables_(made_.words),
          timelines_(timeline_words(character)),
          times_(character.times_s),
          root_rows_(std::vector<io::vec4>{{0, 0, 1, 0}}),
          layers_(as_words(repeated(made_.initial_layers, count))),
          parameters_(repeated(made_.initial_parameters, count)),
          active_clips_(poison<io::ActiveClip>(count * size_t{made_.active_clip_limit})),
          active_clip_times_(poison<float>(count * size_t{made_.active_clip_limit})),
          events_(poison<uint32_t>(sizeof(io::EventHead) / 4 + kEventCapacity * sizeof(io::EventRecord) / 4)),
          roots_(std::vector<io::RootState>(count)),
          root_remainders_(std::vector<io::vec2>(count)),
          placements_(std::vector<Affine>(count)),
          inertias_(std::vector<io::InstanceInertia>(count)),
          commands_(std::vector<io::ControlCommand>(count * size_t{kCommandsEach})),
          controller_bindings_(controller_.bind(BufferTable{{io::kControllerBuffer, tables_},
                                                            {io::kTimelineBuffer, timelines_},
                                                            {io::kTimesBuffer, times_},
                                                            {io::kBirthsBuffer, times_},
                                                            {io::kRootRowsBuffer, root_rows_},
                                                            {io::kLayersBuffer, layers_},
                                                            {io::kParametersBuffer, parameters_},
                                                            {io::kActiveClipsBuffer, active_clips_},
                                                            {io::kEventsBuffer, events_},
                                                            {io::kRootsBuffer, roots_},
                                                            {io::kRootRemaindersBuffer, root_remainders_},
                                                            {io::kPlacementsBuffer, placements_},
                                                            {io::kInertiasBuffer, inertias_},
                                                            {io::kLayersBeforeBuffer, layers_},
                                                            {io::kParametersBeforeBuffer, parameters_},
                                                            {io::kActiveClipTimesBuffer, active_clip_times_}})),
          command_bindings_(command_.bind(BufferTable{{io::kCommandsBuffer, commands_},
                                                      {io::kLayersBuffer, layers_},
                                                      {io::kParametersBuffer, parameters_},
                                                      {io::kInertiasBuffer, inertias_},
                                                      {io::kInitialLayersBuffer, layers_},
                                                      {io::kInitialParametersBuffer, parameters_}})) {}

    void update(std::span<const io::ControlCommand> commands, float time_step_s) {
        run_on_gpu([&](VkCommandBuffer buffer) {
            const Gpu& gpu = *test_gpu();
            const auto command_count = static_cast<uint32_t>(commands.size());
            record_update(gpu, buffer, commands_, 0, commands);
            BufferRange head = events_;
            head.size_bytes = sizeof(io::EventHead);
            record_fill(gpu, buffer, head, 0);
            memory_barrier(gpu, buffer, kTransferWrite, kShaderRead | kShaderWrite);
            if (command_count > 0)
                command_.dispatch_invocations(
                    buffer, command_bindings_,
                    io::CommandPush{command_count, made_.layout.layer_count, made_.layout.parameter_count, 0},
                    command_count);
            memory_barrier(gpu, buffer, kShaderWrite, kShaderRead | kShaderWrite);
            controller_.dispatch_invocations(buffer, controller_bindings_,
                                             io::ControllerPush{count_, 1000, joint_count_, made_.active_clip_limit,
                                                                kEventCapacity, time_step_s, io::kPushTellsTimes},
                                             count_);
        });
    }
    std::vector<io::LayerState> layers() const { return layer_states_of(layers_.read()); }
    std::vector<float> parameters() const { return parameters_.read(); }
    std::vector<io::ActiveClip> active_clips() const { return active_clips_.read(); }
    std::vector<float> active_clip_times() const { return active_clip_times_.read(); }
    EventBlock events() const { return event_block_of(events_.read()); }
    const ControllerTables& made() const { return made_; }

private:
    ControllerTables made_;
    uint32_t count_, joint_count_;
    Kernel controller_ = controller_kernel(test_gpu()), command_ = command_kernel(test_gpu());
    Guarded<uint32_t> tables_, timelines_;
    Guarded<float> times_;
    Guarded<io::vec4> root_rows_;
    Guarded<uint32_t> layers_;
    Guarded<float> parameters_;
    Guarded<io::ActiveClip> active_clips_;
    Guarded<float> active_clip_times_;
    Guarded<uint32_t> events_;
    Guarded<io::RootState> roots_;
    Guarded<io::vec2> root_remainders_;
    Guarded<Affine> placements_;
    Guarded<io::InstanceInertia> inertias_;
    Guarded<io::ControlCommand> commands_;
    Bindings controller_bindings_, command_bindings_;
};

TEST(ControllerOnTheGpu, AgreesWithTheReferenceAsAWalker) { follow_example<Kernels>("walker"); }
TEST(ControllerOnTheGpu, AgreesWithTheReferenceAsAFlyer) { follow_example<Kernels>("flyer"); }
TEST(ControllerOnTheGpu, AgreesWithTheReferenceAsADragon) { follow_example<Kernels>("dragon"); }
TEST(ControllerOnTheGpu, DirectLayersFollowPlayCommands) { follow_direct_layers<Kernels>(); }

}  // namespace
}  // namespace throng::test
