// Cursors -> skin matrices in one pass, for the groups that are fused.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/pose_stage.h"
#include "crowd/stage.h"

namespace throng {

class FusedUpdate : public Stage {
public:
    // Adds skin matrices, and whatever else either path of an update writes.
    static void plan(BatchPlan& plan);
    // Serves the batches whose group is fused.
    explicit FusedUpdate(const StageContext& context);

    void record(const Update& update) override;
    // Animates the groups that are animated only where drawn.
    void record_disoccluded(const Update& update, const DepthImage& depths) override;
    uint32_t end_count() const override { return 2; }

private:
    // One clip per instance costs about half as much as two, so a batch in which no instance blends uses a kernel that
    // does not look for a second.
    struct Kernels {
        Kernel blending, single;
    };
    struct SetBindings {
        std::vector<Bindings> skins;  // [frame slot]
        Bindings target;              // for instances that are animated ahead
    };
    struct ServedBatch {
        uint32_t batch = 0;
        std::vector<SetBindings> sets;  // of joints
        Bindings sockets;               // where sockets are transformed to world space
    };
    Kernels make_kernels(const Group& group, size_t set, const CrowdSettings& settings) const;
    void bind(ServedBatch& served) const;
    template <class Applies>
    void record_sets(VkCommandBuffer commands, const Applies& applies) const;
    void record_set(VkCommandBuffer commands, const ServedBatch& served, uint32_t set) const;
    void update_natively(const ServedBatch& served, uint32_t set) const;
    void update_natively(const ServedBatch& served, uint32_t set, const Buffer& skin, uint32_t section) const;
    bool is_listed(const Group& group) const { return group.varies || animates_drawn_only(group); }
    bool animates_drawn_only(const Group& group) const { return culls_ && group.animates_drawn_only(); }

    void record_sockets(VkCommandBuffer commands) const;

    bool culls_;
    const PoseStage& poses_;
    SkinFormat skin_format_;
    std::vector<std::vector<Kernels>> kernels_;  // [group][set of joints]; none on a native device
    std::optional<Kernel> sockets_;
    std::vector<ServedBatch> served_;
};

}  // namespace throng
