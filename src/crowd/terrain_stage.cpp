#include "crowd/terrain_stage.h"

#include "base/failure.h"
#include "base/finite.h"
#include "steer/terrain.kernel.h"

#include <cmath>

namespace throng {

void check_terrain(const CrowdSettings& settings) {
    for (const CrowdGroup& group : settings.groups)
        if (group.on_terrain && !settings.terrain)
            throw Failure(ErrorCode::kInvalidArgument, group.character->name + ": on_terrain",
                          "CrowdSettings::terrain is not set");
    if (!settings.terrain) return;
    const Terrain& terrain = *settings.terrain;
    const auto refuse = [](const std::string& what) {
        throw Failure(ErrorCode::kInvalidArgument, "crowd: terrain", what);
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
    const Terrain& terrain = *context.settings.terrain;
    kernel_ = kernels::terrain.on(gpu_);
    push_ = {.instance_count = 0,
             .columns = terrain.columns,
             .rows = terrain.rows,
             .x = terrain.x,
             .z = terrain.z,
             .inverse_spacing = 1 / terrain.spacing};
    for (uint32_t i = 0; i < batches_.size(); ++i)
        if (const Batch& batch = batches_[i]; group_of(batch).on_terrain)
            served_.push_back(
                {i,
                 kernel_.bind(batch.table(group_of(batch), {}).set({{io::kHeightsBuffer, context.terrain_heights}}))});
}

void TerrainStage::record(const Update& update) {
    if (served_.empty()) return;
    for (const ServedBatch& served : served_) {
        io::TerrainPush push = push_;
        push.instance_count = batches_[served.batch].used_count;
        kernel_.dispatch_invocations(update.commands, served.bindings, push, push.instance_count);
    }
    separate_kernels(update.commands);
    update.end_stage("terrain");
}

}  // namespace throng
