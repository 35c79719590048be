// The cull stage of crowds that may be updated for a view: which instances are drawn, and in how much detail.
#pragma once

#include "crowd/batch.h"
#include "crowd/group.h"
#include "crowd/stage_timer.h"
#include "cull/cull.h"

#include <optional>

namespace throng {

// The planes of what a view sees, and the eye; of no view, all there is, in full detail.
io::CullView cull_view_of(const CrowdView* view);

// Gives the batch its list, and the commands that animate and draw it; nothing is listed yet.
void make_list(const std::shared_ptr<Gpu>& gpu, const Group& group, Batch& batch);

class CullStage {
public:
    // Of all batches, which have a list; keeps references to both.
    CullStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches);

    void record_view(VkCommandBuffer commands, const CrowdView* view);
    void record(VkCommandBuffer commands, StageTimer* timer) const;
    // Of a batch, after the last update that has finished.
    std::vector<DrawnInstance> read(uint32_t batch) const;
    uint64_t size_bytes() const;

private:
    struct Member {
        Buffer details, counts;
        Bindings cull, offsets, list;
    };
    io::CullPush push_of(const Batch& batch) const;

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Group>& groups_;
    const std::vector<Batch>& batches_;
    CullKernels kernels_;
    Buffer view_;
    std::vector<Member> members_;  // [batch]
};

}  // namespace throng
