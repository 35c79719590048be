// The skin stage of crowds whose vertices are skinned once, for all who read them.
#pragma once

#include "crowd/batch.h"
#include "crowd/cull_stage.h"
#include "crowd/group.h"
#include "crowd/stage_timer.h"

namespace throng {

class SkinStage {
public:
    // Of all batches; keeps references to both. `cull`, where the crowd culls: what is drawn is skinned, else
    // everything.
    SkinStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches,
              const CullStage* cull, const CrowdSettings& settings);

    // Behind all that writes skin matrices.
    void record(VkCommandBuffer commands, StageTimer* timer) const { record(commands, timer, false); }
    // In the second half of an update, of those that this has animated.
    void record_animated(VkCommandBuffer commands, StageTimer* timer) const { record(commands, timer, true); }

private:
    void record(VkCommandBuffer commands, StageTimer* timer, bool only_animated) const;

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Group>& groups_;
    const std::vector<Batch>& batches_;
    Kernel kernel_;
    std::vector<std::array<Bindings, 2>> members_;  // [batch][current_skin]
};

// Of one batch. `skin_matrices`: those that are current; `skinned`: where its vertices go.
BufferTable skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned,
                         const BufferRange& verdicts);
io::SkinPush skin_push(const Group& group);

}  // namespace throng
