#include "crowd/skin_stage.h"

namespace throng {

BufferTable skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned) {
    return batch.table(group, group[io::kVerticesBuffer])
        .set({{io::kSkinBuffer, skin_matrices}, {io::kSkinnedBuffer, skinned}});
}

io::SkinPush skin_push(const Group& group) {
    return {.section_count = static_cast<uint32_t>(group.sections.size()),
            .vertex_count = group.vertex_count,
            .palette_count = group.palette_count,
            .first_instance = 0,
            .influence_offset = 0,
            .only_animated = 0,
            .has_skin_pool = group.skin_pool.has_value(),
            .active_morph_limit = group.active_morph_limit};
}

namespace {

bool skins(const Group& group) { return group.vertex_count > 0 && !group.sockets_only; }

}  // namespace

void SkinStage::plan(BatchPlan& plan) {
    plan.add_storage(io::kSkinnedBuffer,
                     (skins(plan.group()) ? plan.group().vertex_count : 1u) * sizeof(SkinnedVertex));
}

SkinStage::SkinStage(const StageContext& context)
    : Stage(context),
      kernel_(skin_kernel(gpu_, context.settings.skin_format, context.settings.skin_blend,
                          context.settings.culling ? SkinScope::kListed : SkinScope::kFinest)) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        std::vector<Bindings>& of_slots = bindings_.emplace_back();
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (!skins(group)) continue;
        for (uint32_t slot = 0; slot < batch.skins.size(); ++slot)
            of_slots.push_back(
                kernel_.bind(skin_buffers(group, batch, batch.skins[slot], batch.shown_in(slot, io::kSkinnedBuffer))));
    }
}

void SkinStage::record(const Update& update, bool only_animated) const {
    separate_kernels(update.commands);
    for (size_t i = 0; i < bindings_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (!skins(group)) continue;
        io::SkinPush push = skin_push(group);
        push.only_animated = only_animated;
        const Bindings& bindings = bindings_[i][batch.slot];
        if (batch[io::kListBuffer])
            kernel_.dispatch_indirect(update.commands, bindings, push, batch[io::kDispatchesBuffer], io::kWorkSections);
        else
            kernel_.dispatch_workgroups(update.commands, bindings, push, batch.instance_count);
    }
    update.end_stage("skin");
}

}  // namespace throng
