#include "crowd/fused_update.h"

#include "gpu/barrier.h"

namespace throng {

FusedUpdate::FusedUpdate(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches, const CrowdSettings& settings)
    : gpu_(std::move(gpu)), groups_(groups), batches_(batches) {
    for (const Group& group : groups_) {
        Kernels& kernels = kernels_.emplace_back();
        if (!group.fused) continue;
        const auto make = [&](bool blends) { return fused_kernel(gpu_, group.fused->plan, {.packed = group.packed, .blends = blends, .keeps_model = settings.keep_model_matrices, .skin_format = settings.skin_format}); };
        kernels = {make(true), make(false)};
    }
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = groups_[batch.group];
        if (!group.fused) continue;
        const FusedTables& tables = group.fused->tables;
        Member& member = members_.emplace_back(Member{.batch = i, .bindings = {}});
        for (size_t k = 0; k < batch.skins.size(); ++k) {
            const Buffer& skin = batch.skins[k];
            if (!skin.handle()) continue;
            member.bindings[k] = kernels_[batch.group].blending.bind(FusedBuffers{batch.cursors, group.tracks, group.keys, group.words, tables.links, tables.bind_ranges, tables.bind_entries, tables.binds,
                                                                                  skin, settings.keep_model_matrices ? batch.kept_model : skin});
        }
    }
}

void FusedUpdate::record(VkCommandBuffer commands, StageTimer* timer) const {
    if (members_.empty()) return;
    for (const Member& member : members_) {
        const Batch& batch = batches_[member.batch];
        const Group& group = groups_[batch.group];
        const Kernels& kernels = kernels_[batch.group];
        record_fused(commands, batch.blending_count > 0 ? kernels.blending : kernels.single, member.bindings[batch.current_skin], group.fused->plan,
                     {.joint_count = group.joint_count, .instance_count = batch.instance_count, .palette_count = group.palette_count, .rest_track = static_cast<uint32_t>(group.clip_durations_s.size()) * group.joint_count});
    }
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    if (timer) timer->end_stage(commands, &StageTimes::fused);
}

}  // namespace throng
