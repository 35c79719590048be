#include "crowd/fused_update.h"

#include "bind/sockets.h"
#include "gpu/barrier.h"

namespace throng {

FusedUpdate::FusedUpdate(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches, const CrowdSettings& settings)
    : gpu_(std::move(gpu)), groups_(groups), batches_(batches) {
    for (const Group& group : groups_) {
        Kernels& kernels = kernels_.emplace_back();
        if (!group.fused) continue;
        kernels.are_listed = settings.culls && !settings.keep_previous_matrices && group.animates_drawn_only();
        const auto make = [&](bool blends) { return fused_kernel(gpu_, group.fused->plan, {.packed = group.packed, .blends = blends, .keeps_model = settings.keep_model_matrices, .skin_format = settings.skin_format, .layered = group.controller.has_value(), .socket_count = group.socket_count(), .inertial = group.controller && group.controller->is_inertial, .posed = group.pose_capacity > 0, .listed = kernels.are_listed}); };
        kernels.blending = make(true);
        if (!group.controller) kernels.single = make(false);
    }
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = groups_[batch.group];
        if (!group.fused) continue;
        const FusedTables& tables = group.fused->tables;
        Member& member = members_.emplace_back(Member{.batch = i, .bindings = {}, .sockets = {}});
        if (group.sockets && group.socket_space == SocketSpace::kWorld) {
            if (!sockets_) sockets_ = socket_kernel(gpu_);
            member.sockets = sockets_->bind(SocketBuffers{batch.sockets, group.sockets->table, batch.placements, batch.sockets});
        }
        for (size_t k = 0; k < batch.skins.size(); ++k) {
            const Buffer& skin = batch.skins[k];
            if (!skin.handle()) continue;
            const Buffer& cursors = group.controller ? skin : batch.cursors;
            const Buffer &voices = group.controller ? batch.voices : group.tracks, &masks = group.controller ? group.controller->masks : group.words;
            member.bindings[k] = kernels_[batch.group].blending.bind(FusedBuffers{cursors, group.tracks, group.keys, group.words, tables.links, tables.bind_ranges, tables.bind_entries, tables.binds,
                                                                                  skin, settings.keep_model_matrices ? batch.kept_model : skin, voices, masks, group.sockets ? group.sockets->slots : group.words, batch.sockets.or_else(skin), batch.inertias.or_else(skin), batch.inertia_states.or_else(skin), batch.posed.or_else(group.words), group.poses.or_else(group.keys), batch.list.or_else(group.words)});
        }
    }
}

void FusedUpdate::record(VkCommandBuffer commands, StageTimer* timer) const {
    if (members_.empty()) return;
    for (const Member& member : members_) {
        const Batch& batch = batches_[member.batch];
        const Group& group = groups_[batch.group];
        const Kernels& kernels = kernels_[batch.group];
        const Kernel& kernel = group.controller || batch.blending_count > 0 ? kernels.blending : kernels.single;
        const io::FusedPush push{.joint_count = group.joint_count, .instance_count = batch.instance_count, .palette_count = group.palette_count, .rest_track = static_cast<uint32_t>(group.clip_durations_s.size()) * group.joint_count, .voice_limit = group.controller ? group.controller->voice_limit : 0};
        if (kernels.are_listed) kernel.dispatch_indirect(commands, member.bindings[batch.current_skin], push, batch.dispatch);
        else record_fused(commands, kernel, member.bindings[batch.current_skin], group.fused->plan, push);
    }
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    if (sockets_) record_sockets(commands);
    if (timer) timer->end_stage(commands, &StageTimes::fused);
}

// From model to world space, in place.
void FusedUpdate::record_sockets(VkCommandBuffer commands) const {
    for (const Member& member : members_) {
        const Batch& batch = batches_[member.batch];
        const Group& group = groups_[batch.group];
        if (!group.sockets || group.socket_space != SocketSpace::kWorld) continue;
        sockets_->dispatch_invocations(commands, member.sockets, io::SocketPush{batch.instance_count, group.joint_count, group.socket_count(), group.socket_flags()}, batch.instance_count * group.socket_count());
    }
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
}

}  // namespace throng
