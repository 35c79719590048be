// The steer stage of groups with CrowdGroup::steering: moves agents a step towards the destinations that the
// application sets. All agents of the crowd avoid each other.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/stage.h"
#include "steer/steer.h"

#include <optional>

namespace throng {

// Throws kInvalidArgument if the group's steering is not valid.
void check_steering(const CrowdGroup& group);

class SteerStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose group steers.
    explicit SteerStage(const StageContext& context);

    // `place_and_whether`: xyz is the destination, w is 1, or 0 for none.
    void set_destination(const InBatch& at, const io::vec4& place_and_whether);
    void despawn(std::span<const InstanceHandle> gone) override;

    // Uploads destinations and empties the buckets.
    void begin(const Update& update) override;
    void discard() override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    // Runs after control; later stages see where agents stand. If the time step is not above 0, no agent takes a step,
    // but those born in the update are initialized.
    void record(const Update& update) override;
    uint64_t size_bytes() const override { return places_.size_bytes() + buckets_.size_bytes(); }

private:
    struct ServedBatch {
        uint32_t batch = 0;
        uint32_t first_agent = 0;
        std::vector<io::vec4> destinations;  // as set
        DirtyRanges dirty;
        Bindings places, steer;
    };
    void record_places(VkCommandBuffer commands, const ServedBatch& served) const;
    void record_steps(VkCommandBuffer commands, const ServedBatch& served, float time_step_s) const;

    std::optional<SteerKernels> kernels_;
    std::vector<ServedBatch> served_;
    std::vector<uint32_t> served_of_batch_;
    Buffer places_, buckets_;  // of all agents
    uint32_t bucket_mask_ = 0;
    std::vector<AgentGrid> grids_;
};

}  // namespace throng
