#include "crowd/update_rate_stage.h"

#include "cull/cull_io.h"
#include "update_rate/update_rate.h"

namespace throng {

UpdateRateStage::UpdateRateStage(const StageContext& context)
    : Stage(context), keeps_previous_(context.settings.keep_previous_matrices) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        if (!group_of(batch).skips_updates(context.settings)) continue;
        if (!kernel_) kernel_ = update_rate_kernel(gpu_, context.settings.skin_format);
        ServedBatch& served = served_.emplace_back(ServedBatch{.batch = i, .to_current = {}, .to_previous = {}});
        for (uint32_t slot = 0; slot < batch.skins.size(); ++slot) {
            const Buffer &current = batch.skins[slot], &previous = batch.skins[batch.slot_before(slot)];
            const BufferTable table = batch.table(group_of(batch), {})
                                          .set(
                                              {{io::kSkinTargetBuffer, batch[io::kSkinTargetBuffer].or_else(current)}});
            served.to_current.push_back(
                kernel_->bind(table.with({{io::kPreviousSkinBuffer, previous}, {io::kSkinBuffer, current}})));
            if (keeps_previous_)
                served.to_previous.push_back(
                    kernel_->bind(table.with({{io::kPreviousSkinBuffer, current}, {io::kSkinBuffer, previous}})));
        }
    }
}

void UpdateRateStage::record(const Update& update) {
    if (served_.empty()) return;
    const auto record_section = [&](uint32_t section, std::vector<Bindings> ServedBatch::*bindings) {
        for (const ServedBatch& served : served_) {
            const Batch& batch = batches_[served.batch];
            const Group& group = group_of(batch);
            const auto [set0, set1, set2, set3] = group.set_entry_counts;
            const io::UpdateRatePush push{.section = section,
                                          .palette_count = group.palette_count,
                                          .unused0 = 0,
                                          .unused1 = 0,
                                          .entry_counts = {set0, set1, set2, set3}};
            kernel_->dispatch_indirect(update.commands, (served.*bindings)[batch.slot], push,
                                       batch[io::kDispatchesBuffer], section);
        }
        separate_kernels(update.commands);
    };
    record_section(io::kInterpolated, &ServedBatch::to_current);
    if (keeps_previous_) record_section(io::kAppearing, &ServedBatch::to_previous);
    update.end_stage("update_rate");
}

}  // namespace throng
