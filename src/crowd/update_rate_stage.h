// The update_rate stage of crowds whose skin matrices outlive an update. It writes the matrices of instances that
// are not animated in every update and, if previous matrices are kept, the previous ones of those that are newly drawn.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"

namespace throng {

class UpdateRateStage : public Stage {
public:
    // Serves the batches of groups whose skin matrices outlive an update (Group::skips_updates()).
    explicit UpdateRateStage(const StageContext& context);

    // Runs after the fused update.
    void record(const Update& update) override;
    void record_disoccluded(const Update& update, const DepthImage&) override { record(update); }
    uint32_t end_count() const override { return 2; }

private:
    struct ServedBatch {
        uint32_t batch = 0;
        std::vector<Bindings> to_current;   // [frame slot]
        std::vector<Bindings> to_previous;  // the same, with CrowdSettings::keep_previous_matrices
    };

    bool keeps_previous_;
    std::optional<Kernel> kernel_;
    std::vector<ServedBatch> served_;
};

}  // namespace throng
