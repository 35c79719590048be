// The terrain stage of crowds with CrowdSettings::terrain: puts instances of groups with CrowdGroup::on_terrain on it.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"
#include "gpu/kernel.h"
#include "steer/terrain_io.h"

namespace throng {

// Throws kInvalidArgument where CrowdSettings::terrain is not a grid of finite heights, or is missing and a group has
// CrowdGroup::on_terrain.
void check_terrain(const CrowdSettings& settings);

class TerrainStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings) { return settings.terrain.has_value(); }
    // Serves the batches whose group has CrowdGroup::on_terrain.
    explicit TerrainStage(const StageContext& context);

    // Runs after everything that moves placements; later stages see where instances stand.
    void record(const Update& update) override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        Bindings bindings;
    };

    Kernel kernel_;
    io::TerrainPush push_{};
    std::vector<ServedBatch> served_;
};

}  // namespace throng
