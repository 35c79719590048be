// Where instances stand: as the application says and, if that is asked for, as updates have moved them since.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/each.h"
#include "crowd/followed_placements.h"
#include "crowd/population_stage.h"
#include "crowd/stage.h"

namespace throng {

// The root state of an instance that nothing has moved yet.
io::RootState standing_at(const Affine& world_from_model);

class PlacementStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    explicit PlacementStage(const StageContext& context);

    void set(const Instances& instances, const Each<Affine>& world_from_model);
    // From now on known() includes what updates do. If it may `wait`, for submitted updates, that includes what they
    // have done to groups until now; otherwise, from when the next update has run.
    void follow(bool wait);
    // The same as the stage before has done, whose groups are among those of this one.
    void follow_like(const PlacementStage& before);
    bool is_followed() const { return followed_.has_value(); }
    // [instance_count], as the CPU knows them: as last set or, if they are followed, as left by the newest update that
    // it has heard of since.
    const std::vector<Affine>& known();

    void begin(const Update& update) override;
    void end(VkCommandBuffer commands);  // after the last kernel of an update
    void discard() override;
    void exchange(StateArchive& archive) override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    uint32_t end_count() const override { return 0; }
    uint64_t size_bytes() const override { return followed_ ? followed_->size_bytes() : 0; }

private:
    void take_over(const Batch& batch, std::span<const Affine> moved, std::span<const uint32_t> births,
                   uint64_t update);

    std::vector<Affine> placements_;
    // [instance_count], number of the update that takes up what was set last: placements copied from earlier updates
    // are older
    std::vector<uint32_t> set_for_;
    DirtyRanges dirty_;
    uint32_t update_count_ = 0;
    std::optional<FollowedPlacements> followed_;
    bool knows_earlier_ = false;  // what updates did before they were followed
    PopulationStage& population_;
};

}  // namespace throng
