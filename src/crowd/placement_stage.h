// Where instances stand, as the application says.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/each.h"
#include "crowd/stage.h"

namespace throng {

bool is_finite(const Affine& affine);

// Nothing has moved it yet.
io::RootState standing_at(const Affine& world_from_model);

class PlacementStage : public Stage {
public:
    static void plan(BatchPlan& plan) { plan.add_table<Affine>(io::kPlacementsBuffer); }
    explicit PlacementStage(const StageContext& context);

    void set(const Instances& instances, const Each<Affine>& world_from_model);
    const std::vector<Affine>& all() const { return placements_; }

    void begin(const Update& update) override;
    void discard() override { dirty_.put_back(); }
    void exchange(StateArchive& archive) override;
    uint32_t end_count() const override { return 0; }

private:
    std::vector<Affine> placements_;  // [instance_count], as last set
    DirtyRanges dirty_;
};

}  // namespace throng
