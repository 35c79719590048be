#include "crowd/skin_stage.h"

#include "gpu/barrier.h"

namespace throng {

SkinBuffers skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned,
                         BufferRange verdicts) {
    return {group.vertices,
            group.influences,
            skin_matrices,
            skinned,
            group.morphs ? group.morphs->deltas : group.vertices,
            batch.morphs.or_else(group.vertices),
            group.skin_tables.sections,
            group.skin_tables.vertices,
            batch.list.or_else(group.vertices),
            verdicts};
}

io::SkinPush skin_push(const Group& group) {
    return {.section_count = static_cast<uint32_t>(group.sections.size()),
            .vertex_count = group.vertex_count,
            .palette_count = group.palette_count,
            .first_instance = 0,
            .influence_offset = 0,
            .only_animated = 0};
}

SkinStage::SkinStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches,
                     const CullStage* cull, const CrowdSettings& settings)
    : gpu_(std::move(gpu)),
      groups_(groups),
      batches_(batches),
      kernel_(skin_kernel(gpu_, settings.skin_format, settings.skin_blend, cull)) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        std::array<Bindings, 2>& member = members_.emplace_back();
        const Batch& batch = batches_[i];
        const Group& group = groups_[batch.group];
        if (group.vertex_count == 0) continue;
        for (size_t k = 0; k < member.size(); ++k)
            if (batch.skins[k].handle())
                member[k] = kernel_.bind(
                    skin_buffers(group, batch, batch.skins[k], batch.skinned,
                                 cull ? BufferRange(cull->verdicts(i)) : BufferRange(group.vertices)));
    }
}

void SkinStage::record(VkCommandBuffer commands, StageTimer* timer, bool only_animated) const {
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    for (size_t i = 0; i < members_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = groups_[batch.group];
        if (group.vertex_count == 0) continue;
        io::SkinPush push = skin_push(group);
        push.only_animated = only_animated;
        const Bindings& bindings = members_[i][batch.current_skin];
        if (batch.list.handle())
            kernel_.dispatch_indirect(commands, bindings, push, batch.dispatches, io::kWorkSections);
        else
            kernel_.dispatch_workgroups(commands, bindings, push, batch.instance_count);
    }
    if (timer) timer->end_stage(commands, &StageTimes::skin);
}

}  // namespace throng
