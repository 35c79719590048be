// A stage of an update. A crowd has those that it needs in a list (crowd_state.cpp), in their order.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/stage_timer.h"
#include "cull/cull_io.h"
#include "gpu/barrier.h"

#include <throng/crowd.h>

#include <deque>
#include <memory>

namespace throng {

class ChangeStage;

// An update that is being recorded.
struct Update {
    VkCommandBuffer commands = VK_NULL_HANDLE;
    ChangeStage* changes = nullptr;  // takes what the begin() of stages has to upload
    float time_step_s = 0;
    io::CullView view = {};       // of cull_view_of()
    StageTimer* timer = nullptr;  // null without CrowdSettings::timestamps

    // To be called after the stage's last command, so that its time is known under this name of stage_names().
    void end_stage(std::string_view name) const {
        if (timer) timer->end_stage(commands, name);
    }
};

class FeedbackRing;
class Stage;
class StateArchive;

// What a stage is made from, before the first update. The stage keeps references to the groups and batches.
struct StageContext {
    Uploads& uploads;
    const CrowdSettings& settings;
    const std::deque<Group>& groups;
    std::vector<Batch>& batches;
    uint32_t instance_count = 0;
    const FeedbackRing* feedback = nullptr;             // null where no group has anything to report
    const std::vector<std::unique_ptr<Stage>>& before;  // earlier stages of the list
};

// A stage T also has the constructor T(const StageContext&) and, unless those of Stage will do, a static is_needed()
// and plan().
class Stage {
public:
    // Whether crowds with these settings have the stage.
    static bool is_needed(const CrowdSettings&) { return true; }
    // Adds the buffers that it needs for batches of a group.
    static void plan(BatchPlan&) {}

    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    virtual ~Stage() = default;

    // Hands to the GPU what the application has changed, before anything is recorded.
    virtual void begin(const Update&) {}
    virtual void record(const Update&) {}
    // Records once more in the second half of an update for a view with occlusion, for the instances that this half
    // animates.
    virtual void record_disoccluded(const Update&, const DepthImage&) {}
    // What the last begin() has taken up is pending again: the update will never be submitted.
    virtual void discard() {}
    // These instances have gone: clears what was set for them, since the next ones with their numbers would inherit it.
    virtual void despawn(std::span<const InstanceHandle> /*gone*/) {}
    // Write or read the state that the stage continues from, apart from the buffers that Crowd::save_state() saves: the
    // first that of the whole crowd, the second that of one group. Not called while an update is being recorded.
    virtual void exchange(StateArchive&) {}
    virtual void exchange_group(StateArchive&, uint32_t /*group*/) {}

    // Another stage has taken over: frees what only the CPU uses.
    virtual void retire() {}

    // The largest number of times that an update, both halves of it, calls end_stage().
    virtual uint32_t end_count() const { return 1; }
    // The memory that the stage itself owns, apart from the buffers of groups and batches. Can be called after those
    // are gone.
    virtual uint64_t size_bytes() const { return 0; }

protected:
    explicit Stage(const StageContext& context)
        : gpu_(context.uploads.gpu()), groups_(context.groups), batches_(context.batches) {}

    const Group& group_of(const Batch& batch) const { return groups_[batch.group]; }
    // apply(batch, its index), in ascending order of their instances.
    template <class Apply>
    void for_each_batch_of(uint32_t group, const Apply& apply) {
        for (uint32_t i = 0; i < batches_.size(); ++i)
            if (batches_[i].group == group) apply(batches_[i], i);
    }
    // What earlier kernels wrote is visible to later ones, and later ones wait until earlier ones have read.
    void separate_kernels(VkCommandBuffer commands) const {
        memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    }

    std::shared_ptr<Gpu> gpu_;
    const std::deque<Group>& groups_;
    std::vector<Batch>& batches_;
};

// The first T of the stages, or null.
template <class T>
T* find_stage(const std::vector<std::unique_ptr<Stage>>& stages) {
    for (const auto& stage : stages)
        if (T* const found = dynamic_cast<T*>(stage.get())) return found;
    return nullptr;
}

}  // namespace throng
