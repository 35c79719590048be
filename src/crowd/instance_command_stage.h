// Commands that an application's shaders have written for groups with CrowdGroup::shader_commands. An update obeys
// them after it has applied what the CPU's calls have set, and before everything else.
#pragma once

#include "command/command_io.h"
#include "crowd/batch_plan.h"
#include "crowd/stage.h"

namespace throng {

// Throws kInvalidArgument or kLimit where a group's settings do not go together.
void check_command_settings(const CrowdGroup& group);

class InstanceCommandStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings);
    static void plan(BatchPlan& plan);
    explicit InstanceCommandStage(const StageContext& context);

    void begin(const Update& update) override;
    void record(const Update& update) override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        Bindings claim, populate, obey;
    };
    void dispatch(const Update& update, const Kernel& kernel, Bindings ServedBatch::*bindings, bool of_all) const;

    Kernel claim_, populate_, obey_;
    std::vector<ServedBatch> served_;
};

}  // namespace throng
