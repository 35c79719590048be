// The morph stage of groups whose character has morphs, with a controller or without.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"

#include <optional>

namespace throng {

class MorphStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose character has morphs.
    explicit MorphStage(const StageContext& context);

    // Runs after control. Nothing else in an update reads what it writes. Its time counts as blend.
    void record(const Update& update) override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        Bindings bindings;
    };
    const Kernel& kernel_of(const Group& group) const { return *kernels_[group.controller.has_value()][group.varies]; }

    std::optional<Kernel> kernels_[2][2];  // [two clips, layers][Group::varies]
    std::vector<ServedBatch> served_;
};

}  // namespace throng
