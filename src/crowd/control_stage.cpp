#include "crowd/control_stage.h"

#include "base/failure.h"
#include "control/control.h"
#include "control/control_reference.h"
#include "control/playback.h"
#include "crowd/change_stage.h"
#include "crowd/state_archive.h"
#include "crowd/state_checks.h"

#include <algorithm>

namespace throng {
namespace {

io::InstancePlayback rest_of(const Group& group) {
    const auto rest = static_cast<uint32_t>(group.clip_durations_s.size());
    const io::ClipPlay play{.clip = rest, .loop = 0, .time_s = 0, .speed = 0};
    return {play, play, 1};
}

bool blends(const io::InstancePlayback& playback) { return playback.weight > 0 && playback.weight < 1; }

}  // namespace

void ControlStage::plan(BatchPlan& plan) {
    plan.add_host(sizeof(playbacks_[0]));
    if (plan.group().controller) return;
    plan.add_filled(io::kPlaybacksBuffer, std::vector{rest_of(plan.group())});
    if (!plan.group().varies) return plan.add_storage(io::kCursorsBuffer, sizeof(io::InstanceCursor));
    // The staged update animates all instances, including those that have never existed: they begin in the rest pose
    const io::ClipCursor rest{.first_track = rest_track_of(plan.group()), .earlier = 0, .later = 0, .fraction = 0};
    plan.add_filled(io::kCursorsBuffer, std::vector<io::InstanceCursor>{{rest, rest, 1}});
}

ControlStage::ControlStage(const StageContext& context) : Stage(context), served_of_batch_(batches_.size(), kNone) {
    playbacks_.resize(context.instance_count);
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        std::ranges::fill(std::span(playbacks_).subspan(batch.first_instance, batch.instance_count), rest_of(group));
        if (group.controller) continue;
        if (!kernel_) kernel_ = control_kernel(gpu_);
        served_of_batch_[i] = static_cast<uint32_t>(served_.size());
        served_.push_back({.batch = i,
                           .blending_count = 0,
                           .bindings = kernel_->bind(batch.table(group, batch[io::kCursorsBuffer]))});
    }
    dirty_.add(0, context.instance_count);
}

io::InstancePlayback ControlStage::checked(uint32_t instance, const Playback& playback) const {
    const ErrorPlace place("playback", instance);
    const Group& group = groups_[batches_[batch_index_of(batches_, instance)].group];
    if (group.controller)
        throw Failure(ErrorCode::kInvalidArgument, place, "its group has a controller: use play() or set_parameter()");
    const auto& durations_s = group.clip_durations_s;
    const auto clip_count = static_cast<uint32_t>(durations_s.size());
    check_playback(playback, clip_count, place);
    // Wrapped in double precision here, so that a large time does not cost precision on the GPU.
    const auto play = [&](const ClipPlayback& from) {
        if (from.clip == kNone) return io::ClipPlay{.clip = clip_count, .loop = 0, .time_s = 0, .speed = 0};
        const double time_s = local_time_reference(from.time_s, durations_s[from.clip], from.loop);
        return io::ClipPlay{
            .clip = from.clip, .loop = from.loop ? 1u : 0u, .time_s = static_cast<float>(time_s), .speed = from.speed};
    };
    return {play(playback.first), play(playback.second), playback.weight};
}

void ControlStage::set(const Instances& instances, const Each<Playback>& playback) {
    std::vector<io::InstancePlayback> all;
    all.reserve(instances.size());
    for (uint32_t i = 0; i < instances.size(); ++i) all.push_back(checked(instances.number(i), playback[i]));
    for (uint32_t i = 0; i < all.size(); ++i) put(instances.number(i), all[i]);
}

void ControlStage::put(uint32_t instance, const io::InstancePlayback& playback) {
    io::InstancePlayback& known = playbacks_[instance];
    if (const bool before = blends(known), after = blends(playback); before != after)
        served_[served_of_batch_[batch_index_of(batches_, instance)]].blending_count += after ? 1u : ~0u;
    known = playback;
    dirty_.add(instance, 1);
}

void ControlStage::despawn(std::span<const InstanceHandle> gone) {
    for (const auto& [instance, generation] : gone)
        if (served_of_batch_[batch_index_of(batches_, instance)] != kNone) put(instance, checked(instance, Playback()));
}

void ControlStage::begin(const Update& update) {
    for (const ServedBatch& served : served_) {
        Batch& batch = batches_[served.batch];
        batch.blends = served.blending_count > 0 || group_of(batch).command_capacity > 0;  // shaders may blend as well
    }
    const std::span<const DirtyRanges::Range> ranges = dirty_.take();
    for_each_part(batches_, ranges, [&](const Batch& batch, uint32_t first, uint32_t count) {
        if (batch[io::kPlaybacksBuffer])
            update.changes->write(update, ranges.size(), batch, io::kPlaybacksBuffer, first - batch.first_instance,
                                  std::span<const io::InstancePlayback>(playbacks_).subspan(first, count));
    });
}

void ControlStage::record(const Update& update) {
    if (served_.empty()) return;
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        kernel_->dispatch_invocations(
            update.commands, served.bindings,
            io::ControlPush{batch.used_count, group_of(batch).joint_count, update.time_step_s, batch.birth},
            batch.used_count);
    }
    separate_kernels(update.commands);
    update.end_stage("control");
}

void ControlStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](const Batch& batch, uint32_t index) {
        const auto playbacks = std::span(playbacks_).subspan(batch.first_instance, batch.instance_count);
        archive.values(playbacks);
        archive.changes(dirty_, batch.first_instance, batch.instance_count);
        if (!archive.reads()) return;
        check_playbacks(playbacks, group_of(batch));
        if (const uint32_t served = served_of_batch_[index]; served != kNone)
            served_[served].blending_count = static_cast<uint32_t>(std::ranges::count_if(playbacks, blends));
    });
}

}  // namespace throng
