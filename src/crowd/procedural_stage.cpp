#include "crowd/procedural_stage.h"

#include "crowd/change_stage.h"
#include "crowd/state_archive.h"

#include <algorithm>

namespace throng {

// Springs begin at rest, and targets with weight 0.
void ProceduralStage::plan(BatchPlan& plan) {
    const std::optional<GroupProcedural>& rules = plan.group().procedural;
    if (!rules) return;
    if (rules->target_count > 0) plan.add_filled(io::kTargetsBuffer, std::vector<io::vec4>(rules->target_count));
    if (rules->spring_count > 0) plan.add_filled(io::kSpringsBuffer, std::vector<io::SpringState>(rules->spring_count));
}

ProceduralStage::ProceduralStage(const StageContext& context) : Stage(context), targets_(batches_.size()) {
    for (size_t i = 0; i < batches_.size(); ++i) {
        const Group& group = group_of(batches_[i]);
        if (!group.procedural) continue;
        for (const ProceduralTables::Dispatch& dispatch : group.procedural->dispatches) {
            std::optional<Kernel>& kernel = kernels_[group.takes_similarities()][dispatch.kind];
            if (!kernel) kernel = procedural_kernel(gpu_, dispatch.kind, group.takes_similarities());
        }
        targets_[i].last.resize(batches_[i].instance_count * size_t{group.procedural->target_count});
    }
}

void ProceduralStage::set_target(uint32_t batch, uint32_t index, const io::vec4& place_and_weight) {
    targets_[batch].last[index] = place_and_weight;
    targets_[batch].dirty.add(index, 1);
}

void ProceduralStage::despawn(std::span<const InstanceHandle> gone) {
    for (const InstanceHandle& one : gone) {
        const InBatch at = in_batch(batches_, one.instance);
        const auto& rules = group_of(batches_[at.batch]).procedural;
        for (uint32_t target = 0; rules && target < rules->target_count; ++target)
            set_target(at.batch, at.instance * rules->target_count + target, {});
    }
}

void ProceduralStage::begin(const Update& update) {
    for (size_t i = 0; i < batches_.size(); ++i) {
        const std::span<const DirtyRanges::Range> ranges = targets_[i].dirty.take();
        for (const auto& [first, count] : ranges)
            update.changes->write(update, ranges.size(), batches_[i], io::kTargetsBuffer, first,
                                  std::span<const io::vec4>(targets_[i].last).subspan(first, count));
    }
    time_step_s_ = update.time_step_s;
    wind_.advance(update.time_step_s);
}

void ProceduralStage::discard() {
    for (Targets& targets : targets_) targets.dirty.put_back();
    wind_.step_back();
}

void ProceduralStage::exchange(StateArchive& archive) { wind_.exchange(archive); }

void ProceduralStage::exchange_group(StateArchive& archive, uint32_t group) {
    for_each_batch_of(group, [&](const Batch&, uint32_t index) {
        auto& [last, dirty] = targets_[index];
        archive.finite_values(last, "a target is not finite");
        archive.changes(dirty, 0, static_cast<uint32_t>(last.size()));
    });
}

ProceduralStage::KindBindings ProceduralStage::bind(uint32_t batch_index, const BufferRange& local) const {
    const Batch& batch = batches_[batch_index];
    const Group& group = group_of(batch);
    KindBindings bindings;
    for (const ProceduralTables::Dispatch& dispatch : group.procedural->dispatches)
        if (!bindings[dispatch.kind].set())
            bindings[dispatch.kind] = kernels_[group.takes_similarities()][dispatch.kind]->bind(
                batch.table(group, batch[io::kPlacementsBuffer]).set({{io::kLocalBuffer, local}}));
    return bindings;
}

uint32_t ProceduralStage::rank_count(uint32_t batch) const {
    const std::optional<GroupProcedural>& procedural = group_of(batches_[batch]).procedural;
    return procedural && !procedural->dispatches.empty() ? procedural->dispatches.back().rank + 1 : 0;
}

void ProceduralStage::record_rank(VkCommandBuffer commands, const KindBindings& bindings, uint32_t batch,
                                  uint32_t rank) const {
    bool is_first = true;
    for (const ProceduralTables::Dispatch& dispatch : group_of(batches_[batch]).procedural->dispatches) {
        if (dispatch.rank != rank) continue;
        // Chains of one rank do not touch each other's joints, but synchronization validation cannot see that.
        if (!is_first) separate_kernels(commands);
        record_dispatch(commands, bindings, batches_[batch], dispatch);
        is_first = false;
    }
}

void ProceduralStage::record_dispatch(VkCommandBuffer commands, const KindBindings& bindings, const Batch& batch,
                                      const ProceduralTables::Dispatch& dispatch) const {
    if (batch.used_count == 0) return;
    const Group& group = group_of(batch);
    const uint32_t workgroups = (batch.used_count + io::kProceduralWorkgroupSize - 1) / io::kProceduralWorkgroupSize;
    io::ProceduralPush push{.instance_count = batch.used_count,
                            .first_instance = batch.first_instance,
                            .joint_count = group.joint_count,
                            .spring_count = group.procedural->spring_count,
                            .target_count = group.procedural->target_count,
                            .first_chain = dispatch.first_chain,
                            .workgroups = workgroups,
                            .time_step_s = time_step_s_,
                            .birth = batch.birth};
    wind_.moment().tell(push);
    // As many chains at once as the device can dispatch.
    const uint32_t chains = std::max(gpu_->properties.limits.maxComputeWorkGroupCount[0] / workgroups, 1u);
    for (uint32_t left = dispatch.chain_count; left > 0;) {
        const uint32_t count = std::min(left, chains);
        kernels_[group.takes_similarities()][dispatch.kind]->dispatch_workgroups(commands, bindings[dispatch.kind],
                                                                                 push, count * workgroups);
        push.first_chain += static_cast<uint32_t>(count * sizeof(io::ProceduralChain) / sizeof(uint32_t));
        left -= count;
    }
}

}  // namespace throng
