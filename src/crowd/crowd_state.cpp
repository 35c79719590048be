#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "crowd/change_stage.h"
#include "crowd/fused_update.h"
#include "crowd/morph_stage.h"
#include "crowd/skin_stage.h"
#include "crowd/terrain_stage.h"
#include "crowd/update_rate_stage.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng {
namespace {

struct StageKind {
    bool (*is_needed)(const CrowdSettings&);
    void (*plan)(BatchPlan&);
    std::unique_ptr<Stage> (*make)(const StageContext&);
};

template <class T>
constexpr StageKind kind_of() {
    return {T::is_needed, T::plan,
            [](const StageContext& context) -> std::unique_ptr<Stage> { return std::make_unique<T>(context); }};
}

// The stages in the order of an update.
constexpr std::array kStages{
    kind_of<ChangeStage>(),          kind_of<PopulationStage>(), kind_of<PlacementStage>(),  kind_of<LookStage>(),
    kind_of<InstanceCommandStage>(), kind_of<ControlStage>(),    kind_of<ControllerStage>(), kind_of<SteerStage>(),
    kind_of<TerrainStage>(),         kind_of<CullStage>(),       kind_of<PoseStage>(),       kind_of<MorphStage>(),
    kind_of<ProceduralStage>(),      kind_of<FusedUpdate>(),     kind_of<UpdateRateStage>(), kind_of<StagedUpdate>(),
    kind_of<AttachStage>(),          kind_of<SkinStage>()};

}  // namespace

CrowdState::CrowdState(std::shared_ptr<Gpu> gpu_in, const CrowdSettings& asked)
    : gpu(std::move(gpu_in)),
      skin_format(asked.skin_format),
      skin_blend(asked.skin_blend),
      skins_once(asked.skins_once),
      events_(gpu),
      keeps_previous_(asked.keep_previous_matrices),
      is_in_flight_(asked.frames_in_flight > 1) {
    const CrowdSettings settings = with_implied(asked);
    check_groups(settings);
    Uploads& uploads = first_uploads_.emplace_back(std::make_unique<FirstUploads>(gpu, events_))->uploads;
    uploads.shares = true;  // the data of groups never changes
    make_groups(uploads, settings);
    uploads.shares = false;
    for (size_t i = 0; i < groups.size(); ++i) groups[i].initial_count = asked.groups[i].instance_count;
    std::vector<BatchPlan> plans;
    for (const Group& group : groups) plans.push_back(plan_batches(group, settings));
    uint64_t needed_bytes = pose_bytes(settings);
    for (size_t i = 0; i < plans.size(); ++i) {
        const uint32_t count = settings.groups[i].instance_count;
        needed_bytes += count * plans[i].instance_bytes() + batch_count_of(plans[i], count) * plans[i].batch_bytes() +
                        PoseStage::native_bytes(groups[i]);
        const bool shares_host_memory = gpu->is_native() || gpu->is_cpu();
        if (shares_host_memory) needed_bytes += count * plans[i].host_bytes();
    }
    check_memory("matrices and state", needed_bytes);
    for (uint32_t i = 0; i < groups.size(); ++i) make_batches(uploads, plans[i], i, settings.groups[i].instance_count);
    outputs.resize(frame_slot_count(settings));
    make_outputs();
    for (Group& group : groups)
        if (group.skin_pool) group.skin_pool->shared_skin = {};
    settings_ = settings;
    for (CrowdGroup& group : settings_.groups) {
        group.character = nullptr;
        group.controller = nullptr;
        group.procedural = nullptr;
        group.terrain = nullptr;
    }
    make_feedback();
    use_stages(make_stages(uploads));
    for (uint32_t i = 0; i < groups.size(); ++i) population->begin_group(i);
    if (gpu->is_native()) finish_uploads();
    timer = make_timer(stages);
    timer_room_ = timer_room_for(stages);
}

BatchPlan CrowdState::plan_batches(const Group& group, const CrowdSettings& settings) const {
    BatchPlan plan(group, settings);
    for (const StageKind& kind : kStages)
        if (kind.is_needed(settings)) kind.plan(plan);
    return plan;
}

CrowdState::Stages CrowdState::make_stages(Uploads& uploads) {
    Stages made;
    const StageContext context{.uploads = uploads,
                               .settings = settings_,
                               .groups = groups,
                               .batches = batches,
                               .instance_count = instance_count,
                               .feedback = feedback ? &*feedback : nullptr,
                               .before = made};
    for (const StageKind& kind : kStages)
        if (kind.is_needed(settings_)) made.push_back(kind.make(context));
    return made;
}

void CrowdState::use_stages(Stages made) {
    stages = std::move(made);
    changes = find_stage<ChangeStage>(stages);
    population = find_stage<PopulationStage>(stages);
    placements = find_stage<PlacementStage>(stages);
    looks = find_stage<LookStage>(stages);
    control = find_stage<ControlStage>(stages);
    controllers = find_stage<ControllerStage>(stages);
    steer = find_stage<SteerStage>(stages);
    cull = find_stage<CullStage>(stages);
    poses = find_stage<PoseStage>(stages);
    procedural = find_stage<ProceduralStage>(stages);
    staged = find_stage<StagedUpdate>(stages);
    attachments = find_stage<AttachStage>(stages);
    instance_commands = find_stage<InstanceCommandStage>(stages);
}

uint32_t CrowdState::end_count_of(const Stages& of) {
    uint32_t sum = 0;
    for (const auto& stage : of) sum += stage->end_count();
    return sum;
}

// With room for the stages of groups that are added later.
uint32_t CrowdState::timer_room_for(const Stages& of) {
    constexpr uint32_t kMore = 16;
    return end_count_of(of) + kMore;
}

std::unique_ptr<StageTimer> CrowdState::make_timer(const Stages& of) const {
    if (!settings_.timestamps || !gpu->has_timestamps()) return nullptr;
    return std::make_unique<StageTimer>(gpu, timer_room_for(of));
}

void CrowdState::make_outputs() {
    for (uint32_t of = 0; of < outputs.size(); ++of) {
        outputs[of].clear();
        for (const Batch& batch : batches) outputs[of].push_back(output_of(batch, of));
    }
}

void CrowdState::record_uploads(VkCommandBuffer commands) {
    for (const auto& uploads : first_uploads_) uploads->record(commands);
}

void CrowdState::finish_uploads() {
    for (const auto& uploads : first_uploads_) uploads->finish();
}

void CrowdState::discard_uploads() {
    for (const auto& uploads : first_uploads_) uploads->discard_update();
}

void CrowdState::follow_placements(bool wait) {
    const bool are_there = has_updated_ && (!awaits_commands_ || first_uploads_.front()->first_update_has_run());
    placements->follow(wait && are_there);
}

Update CrowdState::update_of(VkCommandBuffer commands, float time_step_s, const io::CullView& view) const {
    return {.commands = commands, .changes = changes, .time_step_s = time_step_s, .view = view, .timer = timer.get()};
}

bool CrowdState::updates_natively(bool occlusion) const { return gpu->is_native() || (natively_ && !occlusion); }

void CrowdState::update(float time_step_s, const CrowdView* view) {
    if (feedback && feedback->is_full()) {  // what has not run when the queue is idle was dropped
        gpu->wait_idle();
        feedback->drop_pending();
    }
    if (!updates_natively(view && view->occlusion)) {
        gpu->submit_and_wait([&](VkCommandBuffer commands) { record(commands, time_step_s, view); });
        awaits_commands_ = can_discard_ = may_be_pending_ = false;
        free_what_may_go();
        return;
    }
    if (!gpu->is_native()) gpu->wait_idle();  // what was submitted may still read what is written now
    record(VK_NULL_HANDLE, time_step_s, view);
}

void CrowdState::check_runs(bool natively) const {
    if (!natively)
        for (const Group& group : groups)
            if (group.sockets_only)
                throw Failure(ErrorCode::kUnsupported, group.name + ": sockets only",
                              "they are computed only natively: by update(), and without occlusion");
    // Native updates keep the state of inertial transitions in memory of their own, which kernels do not see, and vice
    // versa
    const bool has_inertia = std::ranges::any_of(batches, [&](const Batch& batch) {
        const Group& group = groups[batch.group];
        return batch.has_updated && group.native && group.controller && group.controller->is_inertial;
    });
    if (has_inertia && natively != was_native_)
        throw Failure(ErrorCode::kUnsupported, "crowd",
                      "with inertial transitions, update() and recorded updates cannot take turns: choose "
                      "UpdatePath::kDevice, which runs both on the device");
}

void CrowdState::check_last_has_run(const char* what) const {
    if ((!may_be_pending_ && !is_half_recorded_) || recorded_.has_last_run()) return;
    gpu->wait_idle();
    if (!recorded_.has_last_run())
        throw Failure(ErrorCode::kInvalidArgument, what,
                      can_discard_
                          ? "the commands of the last record() have not run: submit them, or call discard_last_record()"
                          : "the commands of the last record() have not run: submit them, or record and submit an "
                            "update after it");
}

void CrowdState::record(VkCommandBuffer commands, float time_step_s, const CrowdView* view) {
    if (view && !cull) throw Failure(ErrorCode::kInvalidArgument, "view", "CrowdSettings::culling is not set");
    if (view && view->occlusion && gpu->is_native())
        throw Failure(ErrorCode::kUnsupported, "occlusion", "a native device has no depths to test");
    if (!std::isfinite(time_step_s)) throw Failure(ErrorCode::kInvalidArgument, "time step", "must be finite");
    io::CullView seen = cull_view_of(view, view ? view->full_rate_pixels : 0);
    // Readers of the last update's results must have finished. With several frames in flight the application ensures
    // that, and drawing may continue during this update.
    const Access readers = is_in_flight_ ? kShaderRead | kTransferRead : consumers();
    memory_barrier(*gpu, commands, readers | kShaderWrite | kTransferWrite,
                   kShaderRead | kShaderWrite | kTransferWrite);
    check_runs(commands == VK_NULL_HANDLE);
    if (feedback) feedback->begin(commands);  // before anything changes, because it may throw
    if (view) seen = cull_view_of(view, budgeted_full_rate_pixels(*view));
    free_what_may_go();  // also uploads that have run: the next line would set their events
    for (const auto& uploads : first_uploads_) uploads->begin_update(commands);
    had_native_ = std::exchange(was_native_, commands == VK_NULL_HANDLE);
    awaits_commands_ = commands != VK_NULL_HANDLE;  // a native update has run when this returns
    can_discard_ = false;                           // until all is recorded
    is_half_recorded_ = true;
    const Update update = update_of(commands, time_step_s, seen);
    for (const auto& stage : stages) stage->begin(update);
    go_to_slot((slot + 1) % static_cast<uint32_t>(outputs.size()));
    memory_barrier(*gpu, commands, kTransferWrite, kShaderRead | kShaderWrite | consumers());
    if (timer) timer->begin(commands);
    for (const auto& stage : stages) stage->record(update);
    if (timer) timer->publish(commands);
    if (feedback) {
        find_watched_runs();
        feedback->end(commands, watched_, watched_runs_, take_pose_requests());
    }
    placements->end(commands);
    copy_to_previous(commands);
    had_updated_ = std::exchange(has_updated_, true);
    for (Batch& batch : batches) {
        batch.had_updated = std::exchange(batch.has_updated, true);
        batch.had_outputs = std::exchange(batch.has_outputs, true);
    }
    copy_shown(commands);
    for (Retired& retired : retired_) retired.record(commands);
    // The application's shaders may write commands for the next update as soon as this one has read its own
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite,
                   instance_commands ? consumers() | kShaderWrite | kTransferWrite : consumers());
    recorded_.record(commands);
    is_half_recorded_ = false;
    can_discard_ = may_be_pending_ = commands != VK_NULL_HANDLE;
}

void CrowdState::record_disoccluded(VkCommandBuffer commands, const DepthImage& depths) {
    if (!cull) throw Failure(ErrorCode::kInvalidArgument, "disoccluded", "CrowdSettings::culling is not set");
    if (gpu->is_native())
        throw Failure(ErrorCode::kUnsupported, "disoccluded", "a native device has no depths to test");
    memory_barrier(*gpu, commands, consumers(), kShaderWrite | kTransferWrite);  // what was listed has been drawn
    const Update update = update_of(commands, 0, {});
    for (const auto& stage : stages) stage->record_disoccluded(update, depths);
    if (timer) timer->publish(commands);
    copy_shown(commands);
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, consumers());
}

// What may read the results. A queue without graphics must not name drawing stages in its barriers, and if other
// families share the buffers, the update may be recorded for such a queue
// (VUID-vkCmdPipelineBarrier2-dstStageMask-03850).
Access CrowdState::consumers() const {
    return gpu->has_graphics() && gpu->sharing_families.empty()
               ? kShaderRead | kVertexRead | kTransferRead | kIndirectRead
               : kAnyAccess;
}

// Changes that the update has taken up become pending again, and what it has advanced goes back. The timer detects by
// itself that the update never runs.
void CrowdState::discard_last_record() {
    if (is_half_recorded_)
        throw Failure(ErrorCode::kInvalidArgument, "discard",
                      "the last record() failed halfway: restore a saved state instead");
    if (!can_discard_)
        throw Failure(
            ErrorCode::kInvalidArgument, "discard",
            "there is no record() to discard, or it has been discarded, or an update() has run or groups have "
            "changed since");
    if (recorded_.has_last_run())
        throw Failure(ErrorCode::kInvalidArgument, "discard", "the commands of the last record() have run");
    can_discard_ = false;  // the one before it may be pending still
    recorded_.discard();
    has_updated_ = had_updated_;
    was_native_ = had_native_;
    for (Batch& batch : batches) {
        batch.has_updated = batch.had_updated;
        batch.has_outputs = batch.had_outputs;
    }
    discard_uploads();
    for (Retired& retired : retired_) retired.discard();
    for (const auto& stage : stages) stage->discard();
    if (feedback) feedback->discard();
    pose_requests_.insert(pose_requests_.begin(), recorded_pose_requests_.begin(), recorded_pose_requests_.end());
    recorded_pose_requests_.clear();
    go_to_slot((slot == 0 ? static_cast<uint32_t>(outputs.size()) : slot) - 1);
}

// Raises the factor by as much as the last update exceeded the budget, at most by half, and lowers it more slowly, so
// that it settles.
float CrowdState::budgeted_full_rate_pixels(const CrowdView& view) {
    if (!(view.budget_ms > 0) || !timer) return view.full_rate_pixels;
    constexpr float kSlack = 0.9f;
    if (const std::optional<StageTimes> times = timer->take_newest()) {
        const auto load = static_cast<float>(times->total()) / view.budget_ms;
        full_rate_factor_ = std::clamp(load > 1        ? full_rate_factor_ * std::min(load, 1.5f)
                                       : load < kSlack ? full_rate_factor_ * 0.95f
                                                       : full_rate_factor_,
                                       1.0f, kMaxFullRateFactor);
    }
    if (!(full_rate_factor_ > 1)) return view.full_rate_pixels;
    return std::min(std::max(view.full_rate_pixels, 1.0f) * full_rate_factor_, kMaxFullRatePixels);
}

void CrowdState::free_what_may_go() {
    for (const auto& uploads : first_uploads_) uploads->poll();
    // Keeps the first one, which knows whether an update has run
    for (size_t i = first_uploads_.size(); i-- > 1;) {
        if (!first_uploads_[i]->is_done()) continue;
        events_.give_back(first_uploads_[i]->take_event());
        first_uploads_.erase(first_uploads_.begin() + static_cast<ptrdiff_t>(i));
    }
    for (size_t i = retired_.size(); i-- > 0;) {
        retired_[i].free_one();
        if (!retired_[i].is_empty()) continue;
        events_.give_back(retired_[i].take_event());
        retired_.erase(retired_.begin() + static_cast<ptrdiff_t>(i));
    }
}

void CrowdState::go_to_slot(uint32_t next) {
    slot = next;
    for (Batch& batch : batches) batch.slot = next;
}

// The first update of a group has no previous matrices, so the current ones are copied, as if nothing had moved.
void CrowdState::copy_to_previous(VkCommandBuffer commands) const {
    if (!keeps_previous_ || std::ranges::all_of(batches, &Batch::has_updated)) return;
    memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kTransferRead | kTransferWrite);
    for (const Batch& batch : batches)
        if (!batch.has_updated) record_copy(*gpu, commands, batch.skin(), batch.skins[batch.slot_before(batch.slot)]);
}

void CrowdState::copy_shown(VkCommandBuffer commands) const {
    if (!is_in_flight_) return;
    memory_barrier(*gpu, commands, kShaderWrite | kTransferRead | kTransferWrite, kTransferRead | kTransferWrite);
    for (const Batch& batch : batches)
        for (const uint32_t number : kShownBuffers)
            if (batch[number]) record_copy(*gpu, commands, batch[number], batch.shown[slot][number]);
}

}  // namespace throng
