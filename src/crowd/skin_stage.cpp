#include "crowd/skin_stage.h"

#include "gpu/barrier.h"

namespace throng {

BufferTable skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned,
                         const BufferRange& verdicts) {
    return batch.table(group, group[io::kVerticesBuffer])
        .set({{io::kSkinBuffer, skin_matrices}, {io::kSkinnedBuffer, skinned}, {io::kVerdictsBuffer, verdicts}});
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
                member[k] = kernel_.bind(skin_buffers(group, batch, batch.skins[k], batch[io::kSkinnedBuffer],
                                                      cull ? BufferRange(cull->verdicts(i)) : BufferRange()));
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
        if (batch[io::kListBuffer].handle())
            kernel_.dispatch_indirect(commands, bindings, push, batch[io::kDispatchesBuffer], io::kWorkSections);
        else
            kernel_.dispatch_workgroups(commands, bindings, push, batch.instance_count);
    }
    if (timer) timer->end_stage(commands, &StageTimes::skin);
}

}  // namespace throng
