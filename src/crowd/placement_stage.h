// Where instances stand, as the application says.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/stage.h"

namespace throng {

// Nothing has moved it yet.
io::RootState standing_at(const Affine& world_from_model);

class PlacementStage : public Stage {
public:
    static void plan(BatchPlan& plan) { plan.add_table<Affine>(io::kPlacementsBuffer); }
    explicit PlacementStage(const StageContext& context);

    // Throws kInvalidArgument where a number is not finite; `place` and the placement's number say where.
    static void check(std::span<const Affine> world_from_model, const std::string& place, size_t first_number = 0);
    void set(uint32_t first_instance, std::span<const Affine> world_from_model);
    const std::vector<Affine>& all() const { return placements_; }

    void begin(const Update& update) override;
    void discard() override { dirty_.put_back(); }
    uint32_t end_count() const override { return 0; }

private:
    std::vector<Affine> placements_;  // [instance_count], as last set
    DirtyRanges dirty_;
};

}  // namespace throng
