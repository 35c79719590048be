#include "crowd/instance_command_stage.h"

#include "base/failure.h"
#include "base/message_name.h"
#include "command/claim.kernel.h"
#include "command/obey.kernel.h"
#include "command/populate.kernel.h"

#include <throng/commands.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace throng {
namespace {

static_assert(sizeof(io::InstanceCommand) == sizeof(InstanceCommand) && sizeof(io::CommandHead) == sizeof(CommandHead));
static_assert(io::kNothing == static_cast<uint32_t>(CommandKind::kNothing) &&
              io::kSpawn == static_cast<uint32_t>(CommandKind::kSpawn) &&
              io::kDespawn == static_cast<uint32_t>(CommandKind::kDespawn) &&
              io::kPlace == static_cast<uint32_t>(CommandKind::kPlace) &&
              io::kPlayback == static_cast<uint32_t>(CommandKind::kPlayback) &&
              io::kPlay == static_cast<uint32_t>(CommandKind::kPlay) &&
              io::kBlendLayer == static_cast<uint32_t>(CommandKind::kBlendLayer) &&
              io::kSetParameter == static_cast<uint32_t>(CommandKind::kSetParameter) &&
              io::kSetLook == static_cast<uint32_t>(CommandKind::kSetLook));

constexpr uint32_t kMaxCommands = 1u << 20;  // as include/throng/crowd_settings.h says

uint64_t claim_count(const Group& group) {
    return io::kFirstOtherClaim +
           (group.controller ? 2 * group.controller->layer_count + group.controller->parameter_count : 1);
}

uint32_t flags_of(const Group& group, const Batch& batch) {
    return (group.shaders_populate ? io::kShadersPopulate : 0) | (group.controller ? io::kHasController : 0) |
           (group.controller && group.controller->is_inertial ? io::kMayBeInertial : 0) |
           (batch[io::kRootsBuffer] ? io::kHasRoots : 0) |
           (batch[io::kRootRemaindersBuffer] ? io::kMovesPlacements : 0) |
           (batch[io::kDestinationsBuffer] ? io::kHasDestinations : 0);
}

}  // namespace

void check_command_settings(const CrowdGroup& group) {
    if (!group.shader_commands) return;
    const std::string place = message_name(group.character->name) + ": shader_commands";
    const auto refuse = [&](const char* what) { throw Failure(ErrorCode::kInvalidArgument, place, what); };
    if (group.shader_commands->capacity == 0) refuse("their capacity must be above 0");
    if (group.shader_commands->capacity > kMaxCommands)
        throw Failure(ErrorCode::kLimit, place, "a capacity of ", group.shader_commands->capacity, "; at most ",
                      kMaxCommands);
    if (group.is_carried) refuse("not together with is_carried: carried instances move with their carriers");
    if (!group.shader_commands->populate) return;
    if (group.capacity == 0) refuse("to `populate` a group, they need room: CrowdGroup::capacity is 0");
    if (group.pose_capacity > 0)
        refuse("`populate` not together with pose_capacity: the CPU does not know which instances are alive");
}

bool InstanceCommandStage::is_needed(const CrowdSettings& settings) {
    return std::ranges::any_of(settings.groups,
                               [](const CrowdGroup& group) { return group.shader_commands.has_value(); });
}

void InstanceCommandStage::plan(BatchPlan& plan) {
    const Group& group = plan.group();
    if (group.command_capacity == 0) return;
    const uint64_t size_bytes = sizeof(CommandHead) + uint64_t{group.command_capacity} * sizeof(InstanceCommand);
    plan.add_of_batch(io::kInstanceCommandsBuffer, size_bytes,
                      [size_bytes](Uploads& uploads, const std::string& what, uint64_t) {
                          return fill(uploads, what, std::vector<uint32_t>(1), size_bytes / sizeof(uint32_t));
                      });
    plan.add_filled(io::kClaimsBuffer, std::vector<uint32_t>(claim_count(group)));
}

InstanceCommandStage::InstanceCommandStage(const StageContext& context)
    : Stage(context),
      claim_(kernels::claim.on(gpu_)),
      populate_(kernels::populate.on(gpu_)),
      obey_(kernels::obey.on(gpu_)) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        if (group_of(batch).command_capacity == 0) continue;
        const BufferTable table = batch.table(group_of(batch), batch[io::kClaimsBuffer]);
        served_.push_back({.batch = i,
                           .claim = claim_.bind(table),
                           .populate = group_of(batch).shaders_populate ? populate_.bind(table) : Bindings(),
                           .obey = obey_.bind(table)});
    }
}

// Resets the counts of lost and of ignored commands.
void InstanceCommandStage::begin(const Update& update) {
    constexpr std::array<uint32_t, 2> kNoneYet{};
    constexpr uint64_t kLost = offsetof(CommandHead, lost) / sizeof(uint32_t);
    for (const ServedBatch& served : served_) {
        record_update(*gpu_, update.commands, batches_[served.batch][io::kInstanceCommandsBuffer], kLost,
                      std::span<const uint32_t>(kNoneYet));
    }
}

void InstanceCommandStage::dispatch(const Update& update, const Kernel& kernel, Bindings ServedBatch::*bindings,
                                    bool of_all) const {
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        const Group& group = group_of(batch);
        if (!of_all && !group.shaders_populate) continue;
        const bool has_controller = group.controller.has_value();
        kernel.dispatch_invocations(
            update.commands, served.*bindings,
            io::InstanceCommandPush{.capacity = group.command_capacity,
                                    .instance_count = batch.instance_count,
                                    .clip_count = static_cast<uint32_t>(group.clip_durations_s.size()),
                                    .layer_count = has_controller ? group.controller->layer_count : 0,
                                    .parameter_count = has_controller ? group.controller->parameter_count : 0,
                                    .mask_count = has_controller ? group.controller->mask_count : 0,
                                    .outfit_count = group.outfit_count,
                                    .target_count = group.procedural ? group.procedural->target_count : 0,
                                    .birth = batch.birth,
                                    .flags = flags_of(group, batch)},
            group.command_capacity);
    }
    separate_kernels(update.commands);
}

void InstanceCommandStage::record(const Update& update) {
    dispatch(update, claim_, &ServedBatch::claim, true);
    dispatch(update, populate_, &ServedBatch::populate, false);
    dispatch(update, obey_, &ServedBatch::obey, true);
    memory_barrier(*gpu_, update.commands, kShaderRead | kShaderWrite, kTransferWrite);
    for (const ServedBatch& served : served_)
        record_fill(*gpu_, update.commands,
                    BufferRange(batches_[served.batch][io::kInstanceCommandsBuffer], 0, sizeof(uint32_t)), 0);
    memory_barrier(*gpu_, update.commands, kTransferWrite, kShaderRead | kShaderWrite);
    update.end_stage("commands");
}

}  // namespace throng
