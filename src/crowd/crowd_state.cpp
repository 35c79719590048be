#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "bind/skin_format.h"
#include "control/control.h"
#include "crowd/reference.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng {

CrowdState::CrowdState(std::shared_ptr<Gpu> gpu_in, const CrowdSettings& settings)
    : gpu(std::move(gpu_in)),
      skin_format(settings.skin_format),
      skin_blend(settings.skin_blend),
      control_(control_kernel(gpu)) {
    uint64_t total = 0;
    for (const CrowdGroup& group : settings.groups) {
        if (!group.character) throw Failure(ErrorCode::kInvalidArgument, "crowd", "a group has no character");
        check_has_joints(*group.character);
        total += group.instance_count;
    }
    if (total == 0) throw Failure(ErrorCode::kInvalidArgument, "crowd", "it has no instances");
    if (total > UINT32_MAX)
        throw Failure(ErrorCode::kLimit, "crowd", std::to_string(total) + " instances; at most 4,294,967,295");

    check_memory(settings);

    Uploads uploads(gpu);
    groups.reserve(settings.groups.size());
    for (const CrowdGroup& group : settings.groups) {
        if (const std::string obstacle = skin_format_obstacle(skin_format, *group.character); !obstacle.empty())
            throw Failure(ErrorCode::kUnsupported, group.character->name + ": skin format", obstacle);
        check_steering(group);
        if (const std::string obstacle = skin_blend_obstacle(skin_blend, *group.character); !obstacle.empty())
            throw Failure(ErrorCode::kUnsupported, group.character->name + ": skin blend", obstacle);
        groups.emplace_back(uploads, group, choose_path(*gpu, settings, group), settings);
        make_batches(uploads, static_cast<uint32_t>(groups.size() - 1), settings);
        const auto rest = static_cast<uint32_t>(group.character->clips.size());
        const io::SlotPlayback rest_slot{.clip = rest, .loop = 0, .time_s = 0, .speed = 0};
        playbacks_.insert(playbacks_.end(), group.instance_count, {rest_slot, rest_slot, 1});
    }
    for (Batch& batch : batches) {
        const Group& group = groups[batch.group];
        if (!group.controller)
            batch.control = control_.bind(ControlBuffers{batch.playbacks, group.axes, group.times, batch.cursors});
    }
    if (settings.culls) cull.emplace(uploads, groups, batches, settings);
    procedural.emplace(gpu, groups, batches);
    fused.emplace(gpu, groups, batches, settings);
    pace.emplace(gpu, groups, batches, settings);
    staged.emplace(gpu, groups, batches, skin_format, *procedural);
    make_feedback(settings);
    controllers.emplace(gpu, groups, batches, feedback ? &*feedback : nullptr);
    steer.emplace(gpu, groups, batches);
    poses.emplace(gpu, groups, batches);
    morphs.emplace(gpu, groups, batches);
    if (settings.skins_once) skin.emplace(gpu, groups, batches, cull ? &*cull : nullptr, settings);
    uploads.finish();
    placements.resize(instance_count);
    dirty_playbacks_.add(0, instance_count);
    dirty_placements_.add(0, instance_count);
    // Control, steer, cull, morph, fused, pace, skin, the four of them that record_disoccluded() has and what comes
    // before it, and five stages a wave
    if (settings.timestamps && gpu->has_timestamps())
        timer = std::make_unique<StageTimer>(gpu, 12 + 5 * staged->wave_count());
}

void CrowdState::record(VkCommandBuffer commands, float time_step_s, const CrowdView* view) {
    if (view && !cull) throw Failure(ErrorCode::kInvalidArgument, "view", "CrowdSettings::culls is not set");
    if (!std::isfinite(time_step_s)) throw Failure(ErrorCode::kInvalidArgument, "time step", "must be finite");
    const io::CullView seen = cull_view_of(view, paced_full_rate_pixels(view));
    constexpr Access kConsumers = kShaderRead | kVertexRead | kTransferRead | kIndirectRead;
    // Whoever reads the last update's results must be done.
    memory_barrier(*gpu, commands, kConsumers | kShaderWrite | kTransferWrite,
                   kShaderRead | kShaderWrite | kTransferWrite);
    if (feedback) feedback->begin(commands);  // before anything is taken up, since it may refuse
    can_discard_ = true;
    upload_changes(commands);
    if (cull) cull->record_view(commands, seen);
    for (Batch& batch : batches) batch.blends = batch.blending_count > 0;
    procedural->begin_update(commands, time_step_s);
    steer->begin_update(commands);
    controllers->record_commands(commands);
    poses->record(commands, time_step_s);
    take_turns();
    memory_barrier(*gpu, commands, kTransferWrite, kShaderRead | kShaderWrite | kVertexRead);
    if (timer) timer->begin(commands);
    record_control(commands, time_step_s);
    steer->record(commands, time_step_s, timer.get());
    if (cull) cull->record(commands, timer.get());
    morphs->record(commands, timer.get());
    fused->record(commands, timer.get());
    pace->record(commands, timer.get());
    staged->record(commands, timer.get());
    if (skin) skin->record(commands, timer.get());
    if (timer) timer->publish(commands);
    if (feedback) feedback->end(commands, watched_);
    if (!has_updated_) copy_to_previous(commands);
    had_updated_ = std::exchange(has_updated_, true);
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kConsumers);
}

void CrowdState::record_disoccluded(VkCommandBuffer commands, const DepthImage& depths) {
    if (!cull) throw Failure(ErrorCode::kInvalidArgument, "disoccluded", "CrowdSettings::culls is not set");
    constexpr Access kConsumers = kShaderRead | kVertexRead | kTransferRead | kIndirectRead;
    memory_barrier(*gpu, commands, kConsumers, kShaderWrite);  // what was listed has been drawn
    cull->record_disoccluded(commands, depths, timer.get());
    fused->record_listed(commands, timer.get());
    pace->record(commands, timer.get());
    if (skin) skin->record_animated(commands, timer.get());
    if (timer) timer->publish(commands);
    memory_barrier(*gpu, commands, kShaderWrite, kConsumers);
}

// What the update has taken up is pending again, and what it let go on goes back; the timer notices by itself that it
// never runs.
void CrowdState::discard_last_record() {
    if (!can_discard_)
        throw Failure(ErrorCode::kInvalidArgument, "discard",
                      "there is no record() to discard, or it has been discarded");
    can_discard_ = false;
    has_updated_ = had_updated_;
    dirty_playbacks_.put_back();
    dirty_placements_.put_back();
    procedural->discard();
    steer->discard();
    controllers->discard();
    poses->discard();
    if (cull) cull->discard();
    if (feedback) feedback->discard();
    take_turns();
}

// Raised by what the last update took more than the budget, at most by half, and lowered more slowly, so that it
// settles.
float CrowdState::paced_full_rate_pixels(const CrowdView* view) {
    if (!view) return 0;
    if (!(view->budget_ms > 0) || !timer) return view->full_rate_pixels;
    constexpr float kSlack = 0.9f, kMost = 1e6f;
    if (const std::optional<StageTimes> times = timer->take_newest()) {
        const auto load = static_cast<float>(times->total()) / view->budget_ms;
        pace_ = std::clamp(load > 1        ? pace_ * std::min(load, 1.5f)
                           : load < kSlack ? pace_ * 0.95f
                                           : pace_,
                           1.0f, kMost);
    }
    return pace_ > 1 ? std::max(view->full_rate_pixels, 1.0f) * pace_ : view->full_rate_pixels;
}

// What was current becomes previous.
void CrowdState::take_turns() {
    for (size_t i = 0; i < batches.size(); ++i) {
        if (!batches[i].skins[1].handle()) continue;
        batches[i].current_skin ^= 1;
        std::swap(outputs[i].skin_buffer, outputs[i].previous_skin_buffer);
    }
}

// The first update has none before it: nothing has moved.
void CrowdState::copy_to_previous(VkCommandBuffer commands) const {
    memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kTransferRead | kTransferWrite);
    for (const Batch& batch : batches) {
        const Buffer& previous = batch.skins[1 - batch.current_skin];
        if (!previous.handle()) continue;
        const VkBufferCopy copy{0, 0, previous.size_bytes()};
        gpu->vk.vkCmdCopyBuffer(commands, batch.skin().handle(), previous.handle(), 1, &copy);
    }
}

void CrowdState::record_control(VkCommandBuffer commands, float time_step_s) {
    controllers->record(commands, time_step_s);
    for (const Batch& batch : batches)
        if (batch.playbacks.handle())
            control_.dispatch_invocations(
                commands, batch.control,
                io::ControlPush{batch.instance_count, groups[batch.group].joint_count, time_step_s},
                batch.instance_count);
    memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    if (timer) timer->end_stage(commands, &StageTimes::control);
}

}  // namespace throng
