// The control stage of groups without a controller: clips and times that the application sets -> cursors.
#pragma once

#include "control/control_io.h"
#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/each.h"
#include "crowd/stage.h"

namespace throng {

class ControlStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose group has no controller.
    explicit ControlStage(const StageContext& context);

    // As Crowd::set_playback().
    void set(const Instances& instances, const Each<Playback>& playback);
    void despawn(std::span<const InstanceHandle> gone) override;

    void begin(const Update& update) override;
    void record(const Update& update) override;
    void discard() override { dirty_.put_back(); }
    void exchange_group(StateArchive& archive, uint32_t group) override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        uint32_t blending_count = 0;  // instances in which both clips have weight, as last set
        Bindings bindings;
    };
    io::InstancePlayback checked(uint32_t instance, const Playback& playback) const;
    void put(uint32_t instance, const io::InstancePlayback& playback);

    std::optional<Kernel> kernel_;
    std::vector<ServedBatch> served_;
    std::vector<uint32_t> served_of_batch_;
    std::vector<io::InstancePlayback> playbacks_;  // [instance_count], as last set
    DirtyRanges dirty_;
};

}  // namespace throng
