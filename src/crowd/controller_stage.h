// The control stage of groups with a controller. Applies commands of the CPU; then parameters and layers -> active
// clips, events and root motion.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/feedback.h"
#include "crowd/stage.h"

#include <optional>

namespace throng {

class ControllerStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose group has a controller. Events go to the feedback, which exists if any group has a
    // controller.
    explicit ControllerStage(const StageContext& context);

    // Queues what the next begin() hands to the GPU; `command.instance` is the number within the batch.
    void add(uint32_t batch, const io::ControlCommand& command);

    void begin(const Update& update) override;
    void record(const Update& update) override;
    // Puts the last update's commands back, before those added since.
    void discard() override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    uint64_t size_bytes() const override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        std::vector<io::ControlCommand> pending, recorded;  // for the next update; of the last one
        size_t kept_count = 0;                              // size of `pending` after the last drop_superseded()
        Buffer uploaded;                                    // kRound commands at a time; made when there are any
        Bindings commands, controller;
    };
    void make_uploads(ServedBatch& served);
    void drop_superseded(ServedBatch& served) const;
    bool record_round(VkCommandBuffer commands, size_t first);

    Kernel command_kernel_, controller_kernel_;
    std::vector<ServedBatch> served_;
    std::vector<uint32_t> served_of_batch_;
    const FeedbackRing* feedback_;
};

}  // namespace throng
