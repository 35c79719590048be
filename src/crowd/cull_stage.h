// The cull stage of crowds that may be updated for a view: which instances are drawn, and in how much detail; which of
// them are animated, and in which joints.
#pragma once

#include "crowd/batch.h"
#include "crowd/depth_pyramid.h"
#include "crowd/group.h"
#include "crowd/stage_timer.h"
#include "cull/cull.h"

#include <optional>

namespace throng {

// The planes of what a view sees, and the eye; of no view, all there is, in full detail. `full_rate_pixels` is
// CrowdView's, or what the budget makes of it.
io::CullView cull_view_of(const CrowdView* view, float full_rate_pixels);

// Gives the batch its list and its work, and the commands that animate and draw it; nothing is listed yet.
void make_list(Uploads& uploads, const Group& group, Batch& batch);

class CullStage {
public:
    // Of all batches, which have a list; keeps references to both.
    CullStage(Uploads& uploads, const std::vector<Group>& groups, const std::vector<Batch>& batches,
              const CrowdSettings& settings);

    // `seen`: of cull_view_of().
    void record_view(VkCommandBuffer commands, io::CullView seen);
    void record(VkCommandBuffer commands, StageTimer* timer) const;
    // Takes the last record_view() back.
    void discard();
    // The second half of an update for a view with occlusion. Throws kInvalidArgument where the last record_view() was
    // for none, or its second half is recorded already.
    void record_disoccluded(VkCommandBuffer commands, const DepthImage& depths, StageTimer* timer);
    // Of a batch, after the last update that has finished.
    std::vector<DrawnInstance> read(uint32_t batch) const;
    const Buffer& verdicts(uint32_t batch) const { return members_[batch].verdicts; }
    uint64_t size_bytes() const;

private:
    struct Member {
        Buffer verdicts, counts;
        Bindings cull, offsets, list;
    };
    struct Reveal {
        DepthPyramid pyramid;
        std::vector<Bindings> members;  // [batch]
    };
    io::CullPush push_of(const Batch& batch) const;
    void record_lists(VkCommandBuffer commands, StageTimer* timer) const;
    template <class Dispatch>
    void for_each_batch(VkCommandBuffer commands, const Dispatch& dispatch) const;
    CullBuffers buffers_of(size_t batch) const;
    const Reveal& reveal_for(const DepthImage& depths);

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Group>& groups_;
    const std::vector<Batch>& batches_;
    bool keeps_previous_, may_skip_;
    CullKernels kernels_;
    Buffer view_;
    uint32_t update_number_ = 0;
    bool is_half_done_ = false;   // record_disoccluded() is to come
    bool was_half_done_ = false;  // before the last record_view()
    // Made when they are first needed, for the largest picture so far. Smaller ones are kept with what is bound to
    // them, since updates may be under way that use them; each has twice the room of the one before, where the device
    // can bind it.
    std::vector<Reveal> reveals_;
    std::vector<Member> members_;  // [batch]
};

}  // namespace throng
