// The skin stage of crowds whose vertices are skinned once, for all who read them.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"

namespace throng {

class SkinStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Of all batches; keeps references to both. Where the crowd culls, what is drawn is skinned, else everything.
    SkinStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches,
              const CrowdSettings& settings);

    // Behind all that writes skin matrices.
    void record(const Update& update) override { record(update, false); }
    void record_disoccluded(const Update& update, const DepthImage&) override { record(update, true); }
    uint32_t end_count() const override { return 2; }

private:
    void record(const Update& update, bool only_animated) const;

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Group>& groups_;
    const std::vector<Batch>& batches_;
    Kernel kernel_;
    std::vector<std::array<Bindings, 2>> members_;  // [batch][current_skin]
};

// Of one batch. `skin_matrices`: those that are current; `skinned`: where its vertices go.
BufferTable skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned);
io::SkinPush skin_push(const Group& group);

}  // namespace throng
