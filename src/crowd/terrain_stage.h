// The terrain stage: puts instances of groups with CrowdGroup::terrain on it.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"
#include "gpu/kernel.h"

#include <optional>

namespace throng {

// Throws kInvalidArgument if the group's terrain is not a grid of finite heights.
void check_terrain(const CrowdGroup& group);

class TerrainStage : public Stage {
public:
    // Serves the batches whose group has a terrain.
    explicit TerrainStage(const StageContext& context);

    // Runs after everything that moves placements; later stages see where instances stand.
    void record(const Update& update) override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        Bindings bindings;
    };

    std::optional<Kernel> kernels_[2];  // [Group::varies]
    std::vector<ServedBatch> served_;
};

}  // namespace throng
