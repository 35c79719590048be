#include "crowd/terrain_stage.h"

#include "base/failure.h"
#include "base/finite.h"
#include "base/message_name.h"
#include "steer/terrain.kernel.h"

#include <cmath>

namespace throng {

void check_terrain(const CrowdGroup& group) {
    if (!group.terrain) return;
    const Terrain& terrain = *group.terrain;
    const auto refuse = [&](const std::string& what) {
        throw Failure(ErrorCode::kInvalidArgument, message_name(group.character->name) + ": terrain", what);
    };
    if (terrain.columns == 0 || terrain.rows == 0 || terrain.heights.size() != uint64_t{terrain.columns} * terrain.rows)
        refuse(std::to_string(terrain.heights.size()) + " heights for " + std::to_string(terrain.columns) +
               " columns and " + std::to_string(terrain.rows) +
               " rows; there must be columns * rows of them, and at least one");
    if (!std::isfinite(terrain.x) || !std::isfinite(terrain.z) || !std::isnormal(terrain.spacing) ||
        !(terrain.spacing > 0) || !std::isnormal(1 / terrain.spacing))
        refuse("x, z and spacing must be finite, and spacing above 0");
    if (!all_finite(terrain.heights)) refuse("a height is not finite");
}

TerrainStage::TerrainStage(const StageContext& context) : Stage(context) {
    for (uint32_t i = 0; i < batches_.size(); ++i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        if (!group.terrain) continue;
        std::optional<Kernel>& kernel = kernels_[group.varies];
        if (!kernel) kernel = kernels::terrain.on(gpu_, {group.varies});
        served_.push_back({i, kernel->bind(batch.table(group, batch[io::kPlacementsBuffer]))});
    }
}

void TerrainStage::record(const Update& update) {
    if (served_.empty()) return;
    for (const ServedBatch& served : served_) {
        const Batch& batch = batches_[served.batch];
        const Group& group = group_of(batch);
        io::TerrainPush push = *group.terrain;
        push.instance_count = batch.used_count;
        kernels_[group.varies]->dispatch_invocations(update.commands, served.bindings, push, push.instance_count);
    }
    separate_kernels(update.commands);
    update.end_stage("terrain");
}

}  // namespace throng
