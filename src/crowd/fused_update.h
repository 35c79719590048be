// Cursors -> skin matrices in one pass, for the groups that are fused.
#pragma once

#include "crowd/batch.h"
#include "crowd/group.h"
#include "crowd/stage_timer.h"

namespace throng {

class FusedUpdate {
public:
    // Of those batches whose group is fused; keeps references to both.
    FusedUpdate(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches, const CrowdSettings& settings);

    void record(VkCommandBuffer commands, StageTimer* timer) const;

private:
    // One clip an instance costs about half of two, so a batch in which none blends has a kernel that does not look for a second.
    struct Kernels {
        Kernel blending, single;
        bool are_listed = false;  // they animate only what is drawn
    };
    struct Member {
        uint32_t batch = 0;
        std::array<Bindings, 2> bindings;  // one for each of the batch's skin buffers
        Bindings sockets;                  // where they go to world space
    };

    std::shared_ptr<Gpu> gpu_;
    const std::vector<Group>& groups_;
    const std::vector<Batch>& batches_;
    void record_sockets(VkCommandBuffer commands) const;

    std::vector<Kernels> kernels_;  // [group]
    std::optional<Kernel> sockets_;
    std::vector<Member> members_;
};

}  // namespace throng
