#include "crowd/placement_stage.h"

#include "base/failure.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {

io::RootState standing_at(const Affine& world_from_model) {
    io::RootState root{.move = {0, 0, 1, 0}, .place = {0, 0, 1, 0}, .base = {}};
    std::memcpy(root.base, &world_from_model, sizeof root.base);
    return root;
}

PlacementStage::PlacementStage(const StageContext& context) : Stage(context), placements_(context.instance_count) {
    dirty_.add(0, context.instance_count);
}

void PlacementStage::check(std::span<const Affine> world_from_model, const std::string& place, size_t first_number) {
    for (size_t i = 0; i < world_from_model.size(); ++i)
        for (const auto& row : world_from_model[i].row)
            if (!std::all_of(row.begin(), row.end(), [](float f) { return std::isfinite(f); }))
                throw Failure(ErrorCode::kInvalidArgument, place + std::to_string(first_number + i),
                              "a number is not finite");
}

void PlacementStage::set(uint32_t first_instance, std::span<const Affine> world_from_model) {
    std::copy(world_from_model.begin(), world_from_model.end(), placements_.begin() + first_instance);
    dirty_.add(first_instance, static_cast<uint32_t>(world_from_model.size()));
}

void PlacementStage::begin(const Update& update) {
    std::vector<bool> moved(batches_.size());
    for_each_part(batches_, dirty_.take(), [&](const Batch& batch, uint32_t first, uint32_t count) {
        moved[batch_index_of(batches_, first)] = true;
        const uint32_t first_of_batch = first - batch.first_instance;
        record_update(*gpu_, update.commands, batch[io::kPlacementsBuffer], first_of_batch,
                      std::span<const Affine>(placements_).subspan(first, count));
        if (!batch[io::kRootsBuffer]) return;
        std::vector<io::RootState> roots;
        for (uint32_t i = first; i < first + count; ++i) roots.push_back(standing_at(placements_[i]));
        record_update(*gpu_, update.commands, batch[io::kRootsBuffer], first_of_batch,
                      std::span<const io::RootState>(roots));
    });
    for (size_t i = 0; i < batches_.size(); ++i) {
        batches_[i].is_moved = moved[i];
        if (moved[i]) ++batches_[i].move_count;
    }
}

}  // namespace throng
