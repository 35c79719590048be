// A stage of an update. A crowd has those that it needs in a list (crowd_state.cpp), in their order.
#pragma once

#include "crowd/stage_timer.h"
#include "cull/cull_io.h"

#include <throng/crowd.h>

namespace throng {

// An update that is being recorded.
struct Update {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    float time_step_s = 0;
    io::CullView view = {};       // of cull_view_of()
    StageTimer* timer = nullptr;  // null without CrowdSettings::timestamps

    // To be called after the stage's last command, so that its time is known under this name of kStageNames.
    void end_stage(std::string_view name) const {
        if (timer) timer->end_stage(commands, name);
    }
};

class Stage {
public:
    Stage() = default;
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    virtual ~Stage() = default;

    // Hands to the GPU what the application has changed, before anything is recorded.
    virtual void begin(const Update&) {}
    virtual void record(const Update&) {}
    // In the second half of an update for a view with occlusion: once more for those that this animates.
    virtual void record_disoccluded(const Update&, const DepthImage&) {}
    // What the last begin() has taken up is pending again: the update will never be submitted.
    virtual void discard() {}

    // How many times at most an update, both halves of it, calls end_stage().
    virtual uint32_t end_count() const { return 1; }
    // The memory that the stage itself owns, beside the buffers of groups and batches.
    virtual uint64_t size_bytes() const { return 0; }
};

}  // namespace throng
