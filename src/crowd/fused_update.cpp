#include "crowd/fused_update.h"

#include "base/count.h"
#include "bind/sockets.h"
#include "crowd/group_skin_pool.h"
#include "cull/cull_io.h"
#include "native/native.h"

#include <algorithm>

namespace throng {
namespace {

template <class T>
T* in_memory(const Buffer& buffer) {
    return reinterpret_cast<T*>(buffer.mapped());
}

}  // namespace

void FusedUpdate::plan(BatchPlan& plan) {
    const Group& group = plan.group();
    const CrowdSettings& settings = plan.settings();
    if (group.skin_pool) return plan_skin_pool(plan);
    const bool has_target = group.skips_updates(settings) && settings.culling->skips_updates,
               is_saved = settings.keep_previous_matrices || has_target;
    // The update_rate stage reads skin matrices as rows of 16 bytes.
    const auto add_skin = [&](uint32_t number) {  // of each frame slot
        const uint64_t bytes = uint64_t{std::max(group.palette_count, 1u)} * skin_format_bytes(settings.skin_format);
        if (!group.skips_updates(settings))
            return is_saved ? plan.add_zeros(number, bytes) : plan.add_storage(number, bytes);
        plan.add(number, bytes, [=](Uploads& uploads, const std::string& what, uint64_t n) {
            Buffer table = make_table_bytes(uploads.gpu(), what, rounded_up(n * bytes, 16), 16);
            if (is_saved) uploads.add(table, {});
            return table;
        });
    };
    add_skin(io::kSkinBuffer);
    if (has_target) add_skin(io::kSkinTargetBuffer);
    if (group.sockets) plan.add_storage(io::kSocketsBuffer, group.socket_count() * sizeof(Affine));
    if (settings.keep_model_matrices && !group.sockets_only)
        plan.add_storage(io::kModelBuffer, group.joint_count * sizeof(Affine));
}

FusedUpdate::FusedUpdate(const StageContext& context)
    : Stage(context),
      culls_(context.settings.culling.has_value()),
      poses_(*find_stage<PoseStage>(context.before)),
      skin_format_(context.settings.skin_format) {
    if (!gpu_->is_native())
        for (const Group& group : groups_) {
            std::vector<Kernels>& sets = kernels_.emplace_back();
            for (size_t set = 0; set < group.fused.size(); ++set)
                sets.push_back(make_kernels(group, set, context.settings));
        }
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (group.fused.empty()) continue;
        ServedBatch& served = served_.emplace_back(ServedBatch{.batch = i, .sets = {}, .sockets = {}});
        if (!gpu_->is_native()) bind(served);
        if (!group.sockets || group.socket_flags() == 0) continue;
        if (!sockets_) sockets_ = socket_kernel(gpu_);
        served.sockets = sockets_->bind(batch.table(group, batch[io::kSocketsBuffer]));
    }
}

FusedUpdate::Kernels FusedUpdate::make_kernels(const Group& group, size_t set, const CrowdSettings& settings) const {
    const auto make = [&](bool blends) {
        return fused_kernel(gpu_, group.fused[set].plan,
                            {.packed = group.packed,
                             .blends = blends,
                             .keeps_model = settings.keep_model_matrices,
                             .skin_format = settings.skin_format,
                             .layered = group.controller.has_value(),
                             .socket_count = group.socket_count(),
                             .inertial = group.controller && group.controller->is_inertial,
                             .pose_overrides = group.pose_capacity > 0,
                             .listed = is_listed(group),
                             .maps_joints = set > 0 || group.rows,
                             .skin_pool = group.skin_pool.has_value(),
                             .rows = group.rows ? group.rows->of_set(static_cast<uint32_t>(set)) : FusedRows()});
    };
    Kernels kernels{.blending = make(true), .single = {}};
    if (!group.controller) kernels.single = make(false);
    return kernels;
}

void FusedUpdate::bind(ServedBatch& served) const {
    const Batch& batch = batches_[served.batch];
    const Group& group = group_of(batch);
    for (size_t set = 0; set < group.fused.size(); ++set) {
        SetBindings& bindings = served.sets.emplace_back();
        // Bindings for which the character has no buffer get the dispatch's own output, so that two dispatches never
        // share one.
        const auto bound = [&](const Buffer& skin) {
            return kernels_[batch.group][set].blending.bind(
                batch.table(group, skin).add(group.fused[set].tables).set({{io::kSkinBuffer, skin}}));
        };
        for (const Buffer& skin : batch.skins) bindings.skins.push_back(bound(skin));
        if (batch[io::kSkinTargetBuffer]) bindings.target = bound(batch[io::kSkinTargetBuffer]);
    }
}

void FusedUpdate::record(const Update& update) {
    if (served_.empty()) return;
    record_sets(update.commands, [](const Group&) { return true; });
    if (sockets_) record_sockets(update.commands);
    update.end_stage("fused");
}

void FusedUpdate::record_disoccluded(const Update& update, const DepthImage&) {
    if (served_.empty()) return;
    record_sets(update.commands, [&](const Group& group) { return animates_drawn_only(group); });
    update.end_stage("fused");
}

// There is a barrier between two sets of joints, since synchronization validation treats each buffer that both write as
// one range.
template <class Applies>
void FusedUpdate::record_sets(VkCommandBuffer commands, const Applies& applies) const {
    size_t most = 0;
    for (const Group& group : groups_) most = std::max(most, group.fused.size());
    for (uint32_t set = 0; set < most; ++set) {
        for (const ServedBatch& served : served_) {
            const Group& group = group_of(batches_[served.batch]);
            if (set < group.fused.size() && applies(group)) record_set(commands, served, set);
        }
        separate_kernels(commands);
    }
}

void FusedUpdate::record_set(VkCommandBuffer commands, const ServedBatch& served, uint32_t set) const {
    if (!commands) return update_natively(served, set);
    const Batch& batch = batches_[served.batch];
    const Group& group = group_of(batch);
    const Kernels& kernels = kernels_[batch.group][set];
    const FusedJoints& joints = group.fused[set];
    const SetBindings& bindings = served.sets[set];
    const Kernel& kernel = group.controller || batch.blends ? kernels.blending : kernels.single;
    io::FusedPush push{.joint_count = joints.joint_count,
                       .rig_joint_count = group.joint_count,
                       .instance_count = batch.instance_count,
                       .palette_count = group.palette_count,
                       .rest_track = rest_track_of(group),
                       .active_clip_limit = group.controller ? group.controller->active_clip_limit : 0};
    if (!is_listed(group)) return record_fused(commands, kernel, bindings.skins[batch.slot], joints.plan, push);
    push.section = io::kAnimated + set;
    kernel.dispatch_indirect(commands, bindings.skins[batch.slot], push, batch[io::kDispatchesBuffer], push.section);
    if (!batch[io::kSkinTargetBuffer]) return;
    push.section = io::kAnimatedAhead + set;
    kernel.dispatch_indirect(commands, bindings.target, push, batch[io::kDispatchesBuffer], push.section);
}

void FusedUpdate::update_natively(const ServedBatch& served, uint32_t set) const {
    const Batch& batch = batches_[served.batch];
    update_natively(served, set, batch.skin(), io::kAnimated + set);
    if (is_listed(group_of(batch)) && batch[io::kSkinTargetBuffer])
        update_natively(served, set, batch[io::kSkinTargetBuffer], io::kAnimatedAhead + set);
}

void FusedUpdate::update_natively(const ServedBatch& served, uint32_t set, const Buffer& skin, uint32_t section) const {
    const Batch& batch = batches_[served.batch];
    const Group& group = group_of(batch);
    const FusedJoints& joints = group.fused[set];
    NativeUpdate natively{.cursors = in_memory<const io::InstanceCursor>(batch[io::kCursorsBuffer]),
                          .active_clips = in_memory<const io::ActiveClip>(batch[io::kActiveClipsBuffer]),
                          .active_clip_limit = group.controller ? group.controller->active_clip_limit : 0,
                          .masks = reinterpret_cast<const float*>(joints.native_masks.get()),
                          .inertias = in_memory<const io::InstanceInertia>(batch[io::kInertiasBuffer]),
                          .inertia_states = reinterpret_cast<float*>(batch.inertia_states.get()),
                          .pose_overrides = in_memory<const io::InstancePose>(batch[io::kPoseOverridesBuffer]),
                          .set_poses = poses_.native_poses(batch.group),
                          .skin_format = skin_format_,
                          .skin = skin.mapped(),
                          .skin_rows = in_memory<const uint32_t>(batch[io::kSkinRowsBuffer]),
                          .model = in_memory<Affine>(batch[io::kModelBuffer]),
                          .sockets = in_memory<Affine>(batch[io::kSocketsBuffer])};
    uint32_t count = batch.instance_count;
    if (is_listed(group)) {
        const auto* const work = in_memory<const uint32_t>(batch[io::kWorkBuffer]);
        natively.listed = work + work[2 * section];
        count = work[2 * section + 1];
    }
    gpu_->processor->for_parts(count, min_part(*joints.native, skin_format_), [&](uint32_t first, uint32_t end) {
        throng::update(*joints.native, natively, first, end);
    });
}

// Transforms sockets from model to world space, in place.
void FusedUpdate::record_sockets(VkCommandBuffer commands) const {
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        const Group& group = group_of(batch);
        if (!group.sockets || group.socket_flags() == 0) continue;
        sockets_->dispatch_invocations(commands, served.sockets,
                                       io::SocketPush{batch.used_count, group.joint_count, group.socket_count(),
                                                      group.socket_flags(), batch.birth},
                                       batch.used_count * group.socket_count());
    }
    separate_kernels(commands);
}

}  // namespace throng
