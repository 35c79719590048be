#include "crowd/controller_stage.h"

#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "control/control.h"
#include "crowd/placement_stage.h"
#include "crowd/state_archive.h"
#include "crowd/state_checks.h"
#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr size_t kRound = 16384;  // commands of a batch that are applied by one dispatch

// The staged update animates all instances, including those that have never existed: they begin in the rest pose.
void add_resting_clips(BatchPlan& plan) {
    std::vector<io::ActiveClip> of_instance(plan.group().controller->active_clip_limit);
    of_instance[0] = {.first_track = rest_track_of(plan.group()),
                      .weight = 1,
                      .layer_weight = 1,
                      .flags = io::kActiveClipBeginsLayer | io::kActiveClipEndsLayer | io::kActiveClipEnds};
    plan.add(io::kActiveClipsBuffer, of_instance.size() * sizeof(io::ActiveClip),
             [of_instance](Uploads& uploads, const std::string& what, uint64_t n) {
                 Buffer table = make_table<io::ActiveClip>(uploads.gpu(), what, n * of_instance.size());
                 uploads.add(table, std::as_bytes(std::span(of_instance)), n);
                 return table;
             });
}

}  // namespace

// Adds the buffers. Those that hold state are filled with what instances begin with.
void ControllerStage::plan(BatchPlan& plan) {
    const Group& group = plan.group();
    if (!group.controller) return;
    const GroupController& controller = *group.controller;
    plan.add_filled_table(io::kLayersBuffer, controller.initial_layers);
    plan.add_filled_table(io::kParametersBuffer, controller.initial_parameters);
    if (group.varies)
        add_resting_clips(plan);
    else
        plan.add_table<io::ActiveClip>(io::kActiveClipsBuffer, controller.active_clip_limit);
    if (group.morph_count > 0)
        plan.add_storage(io::kActiveClipTimesBuffer, controller.active_clip_limit * sizeof(float));
    if (controller.is_inertial) {
        plan.add_filled(io::kInertiasBuffer, std::vector<io::InstanceInertia>(1));
        plan.add_zeros(io::kInertiaStatesBuffer, group.joint_count * sizeof(io::InertiaState));
    }
    if (controller.model_layer_count > 0)
        plan.add_storage(io::kRotationsBuffer,
                         uint64_t{group.joint_count} * controller.model_layer_count * sizeof(io::ModelRotations));
    if (!group.has_root_motion()) return;
    plan.add_filled(io::kRootsBuffer, std::vector{standing_at(Affine{})});
    if (controller.applies_root_motion) plan.add_zeros(io::kRootRemaindersBuffer, sizeof(io::vec2));
}

ControllerStage::ControllerStage(const StageContext& context)
    : Stage(context), served_of_batch_(batches_.size(), kNone), feedback_(context.feedback) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (!group.controller) continue;
        if (served_.empty()) {
            command_kernel_ = command_kernel(gpu_);
            controller_kernel_ = controller_kernel(gpu_);
        }
        served_of_batch_[i] = static_cast<uint32_t>(served_.size());
        ServedBatch& served = served_.emplace_back(
            ServedBatch{.batch = i, .pending = {}, .recorded = {}, .uploaded = {}, .commands = {}, .controller = {}});
        served.controller = controller_kernel_.bind(
            batch.table(group, batch[io::kLayersBuffer]).set({{io::kEventsBuffer, feedback_->events()}}));
        if (group.varies) make_uploads(served);  // each birth is a command
    }
}

void ControllerStage::add(uint32_t batch, const io::ControlCommand& command) {
    ServedBatch& served = served_[served_of_batch_[batch]];
    if (!served.uploaded) make_uploads(served);  // here, because it may fail, and an update must not fail midway
    // If a number is reused between updates, only the commands of the last instance with it count. Superseded ones are
    // dropped whenever the list has doubled, so that each command is visited only a few times
    constexpr size_t kWorthIt = 1024;
    if (command.kind == io::kCommandBegin && served.pending.size() >= std::max(kWorthIt, 2 * served.kept_count))
        drop_superseded(served);
    served.pending.push_back(command);
}

// Drops pending commands of instances whose numbers have been given to new ones since: a new instance starts afresh,
// whatever came before.
void ControllerStage::drop_superseded(ServedBatch& served) const {
    std::vector<bool> begins_later(batches_[served.batch].instance_count);
    std::vector<io::ControlCommand>& pending = served.pending;
    size_t first_kept = pending.size();
    for (size_t i = pending.size(); i-- > 0;) {
        const io::ControlCommand command = pending[i];
        if (begins_later[command.instance]) continue;
        begins_later[command.instance] = command.kind == io::kCommandBegin;
        pending[--first_kept] = command;
    }
    pending.erase(pending.begin(), pending.begin() + static_cast<ptrdiff_t>(first_kept));
    served.kept_count = pending.size();
}

void ControllerStage::make_uploads(ServedBatch& served) {
    const Batch& batch = batches_[served.batch];
    served.uploaded = Buffer(gpu_, group_of(batch).name + ": commands", kRound * sizeof(io::ControlCommand),
                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    served.commands = command_kernel_.bind(
        batch.table(group_of(batch), batch[io::kLayersBuffer]).set({{io::kCommandsBuffer, served.uploaded}}));
}

// Dispatches up to kRound commands of each batch, from index `first` on. Returns false if there are none.
bool ControllerStage::record_round(VkCommandBuffer commands, size_t first) {
    const auto count_of = [&](const ServedBatch& served) {
        return std::min(kRound, served.recorded.size() - std::min(first, served.recorded.size()));
    };
    bool any = false;
    for (ServedBatch& served : served_) {
        const size_t count = count_of(served);
        if (count > 0)
            record_update(*gpu_, commands, served.uploaded, 0,
                          std::span<const io::ControlCommand>(served.recorded).subspan(first, count));
        any = any || count > 0;
    }
    if (!any) return false;
    memory_barrier(*gpu_, commands, kTransferWrite, kShaderRead | kShaderWrite);
    for (const ServedBatch& served : served_) {
        const auto count = static_cast<uint32_t>(count_of(served));
        const GroupController& controller = *group_of(batches_[served.batch]).controller;
        if (count > 0)
            command_kernel_.dispatch_invocations(
                commands, served.commands,
                io::CommandPush{count, controller.layer_count, controller.parameter_count, controller.is_inertial},
                count);
    }
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite | kTransferWrite);
    return true;
}

void ControllerStage::begin(const Update& update) {
    if (served_.empty()) return;
    for (ServedBatch& served : served_) {
        served.recorded.swap(served.pending);
        served.pending.clear();
        served.kept_count = 0;
        std::ranges::stable_sort(served.recorded, {}, &io::ControlCommand::instance);
    }
    for (size_t first = 0; record_round(update.commands, first); first += kRound) {}
    memory_barrier(*gpu_, update.commands, kTransferWrite, kShaderRead | kShaderWrite);
}

void ControllerStage::record(const Update& update) {
    if (served_.empty()) return;
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        const Group& group = group_of(batch);
        const uint32_t inertia_flags = group.controller->is_inertial ? io::kPushIsInertial : 0;
        const uint32_t morph_flags = batch[io::kActiveClipTimesBuffer] ? io::kPushTellsTimes : 0;
        const uint32_t root_flags = batch[io::kRootsBuffer]
                                        ? io::kPushHasRootMotion |
                                              (group.controller->applies_root_motion ? io::kPushMovesPlacements : 0)
                                        : 0;
        controller_kernel_.dispatch_invocations(
            update.commands, served.controller,
            io::ControllerPush{.instance_count = batch.used_count,
                               .first_instance = batch.first_instance,
                               .joint_count = group.joint_count,
                               .active_clip_limit = group.controller->active_clip_limit,
                               .event_capacity = feedback_->event_capacity(),
                               .time_step_s = update.time_step_s,
                               .flags = root_flags | inertia_flags | morph_flags,
                               .birth = batch.birth},
            batch.used_count);
    }
    separate_kernels(update.commands);
    update.end_stage("control");
}

void ControllerStage::discard() {
    for (ServedBatch& served : served_) {
        served.pending.insert(served.pending.begin(), served.recorded.begin(), served.recorded.end());
        served.recorded.clear();
    }
}

uint64_t ControllerStage::size_bytes() const {
    uint64_t sum = 0;
    for (const ServedBatch& served : served_) sum += served.uploaded.size_bytes();
    return sum;
}

void ControllerStage::exchange_group(StateArchive& archive, uint32_t group) {
    for (ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        if (batch.group != group) continue;
        // Otherwise the saved bytes would depend on when add() last dropped superseded commands
        if (!archive.reads() && group_of(batch).varies) drop_superseded(served);
        archive.list(served.pending, UINT32_MAX);
        if (!archive.reads()) continue;
        served.kept_count = 0;
        check_commands(served.pending, batch.instance_count, group_of(batch));
        served.recorded.clear();
        if (!served.pending.empty() && !served.uploaded) make_uploads(served);
    }
}

}  // namespace throng
