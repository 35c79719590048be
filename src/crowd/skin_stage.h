// The skin stage of crowds with CrowdSettings::skins_once: skins vertices once for all their readers.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage.h"

namespace throng {

class SkinStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings) { return settings.skins_once; }
    static void plan(BatchPlan& plan);
    // Skins what is drawn where the crowd culls, else everything.
    explicit SkinStage(const StageContext& context);

    // Runs after everything that writes skin matrices.
    void record(const Update& update) override { record(update, false); }
    void record_disoccluded(const Update& update, const DepthImage&) override { record(update, true); }
    uint32_t end_count() const override { return 2; }

private:
    void record(const Update& update, bool only_animated) const;

    Kernel kernel_;
    std::vector<std::vector<Bindings>> bindings_;  // [batch][frame slot]
};

// For one batch. `skin_matrices`: the current ones; `skinned`: where the skinned vertices are written.
BufferTable skin_buffers(const Group& group, const Batch& batch, const Buffer& skin_matrices, const Buffer& skinned);
io::SkinPush skin_push(const Group& group);

}  // namespace throng
