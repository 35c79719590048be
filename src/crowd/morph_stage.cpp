#include "crowd/morph_stage.h"

namespace throng {

void MorphStage::plan(BatchPlan& plan) {
    if (plan.group().morph_count > 0)
        plan.add_storage(io::kActiveMorphsBuffer, plan.group().active_morph_limit * sizeof(io::ActiveMorph));
}

MorphStage::MorphStage(const StageContext& context) : Stage(context) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (group.morph_count == 0) continue;
        std::optional<Kernel>& kernel = kernels_[group.controller.has_value()][group.varies];
        if (!kernel) kernel = morph_kernel(gpu_, group.controller.has_value(), group.varies);
        served_.push_back({i, kernel->bind(batch.table(group, batch[io::kActiveMorphsBuffer]))});
    }
}

void MorphStage::record(const Update& update) {
    if (served_.empty()) return;
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        const Group& group = group_of(batch);
        const io::MorphPush push{batch.used_count, group.morph_count, group.joint_count,
                                 group.controller ? group.controller->active_clip_limit : 0, group.active_morph_limit};
        kernel_of(group).dispatch_invocations(update.commands, served.bindings, push, batch.used_count);
    }
    update.end_stage("blend");
}

}  // namespace throng
