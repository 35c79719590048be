// The cull stage of crowds that may be updated for a view: which instances are drawn, and in how much detail; which of
// them are animated, and in which joints.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/depth_pyramid.h"
#include "crowd/stage.h"
#include "cull/cull.h"

#include <optional>

namespace throng {

// The planes of what a view sees, and the eye; of no view, all there is, in full detail. `full_rate_pixels` is
// CrowdView's, or what the budget makes of it.
io::CullView cull_view_of(const CrowdView* view, float full_rate_pixels);

class CullStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings) { return settings.culling.has_value(); }
    // The list and the work of a batch, and the commands that animate and draw it; nothing is listed yet.
    static void plan(BatchPlan& plan);
    explicit CullStage(const StageContext& context);

    void begin(const Update& update) override;
    void record(const Update& update) override;
    void discard() override;
    void exchange(StateArchive& archive) override;
    // Throws kInvalidArgument where the last begin() was for no view with occlusion, or its second half is recorded
    // already.
    void record_disoccluded(const Update& update, const DepthImage& depths) override;
    // Whether record_disoccluded() is to come.
    bool is_half_done() const { return is_half_done_; }
    uint32_t end_count() const override { return 3; }
    // What a batch has listed, after the last update that has finished.
    std::vector<DrawnInstance> read(uint32_t batch) const;
    uint64_t size_bytes() const override;

private:
    struct Member {
        Bindings cells, cull, offsets, list;
        bool has_cells = false;  // of placements as they are
    };
    struct Reveal {
        DepthPyramid pyramid;
        std::vector<Bindings> members;  // [batch]
    };
    float version_of(const Batch& batch) const;
    io::CullPush push_of(const Batch& batch) const;
    void record_cells(const Update& update);
    void record_lists(const Update& update, bool is_second_half) const;
    template <class Dispatch>
    void for_each_batch(VkCommandBuffer commands, const Dispatch& dispatch) const;
    BufferTable table_of(size_t index) const;
    const Reveal& reveal_for(const DepthImage& depths);

    bool keeps_previous_, may_skip_;
    CullKernels kernels_;
    Buffer view_;
    uint32_t update_number_ = 0;
    bool is_half_done_ = false;   // record_disoccluded() is to come
    bool was_half_done_ = false;  // before the last begin()
    // Made when they are first needed, for the largest picture so far. Smaller ones are kept with what is bound to
    // them, since updates may be under way that use them; each has twice the room of the one before, where the device
    // can bind it.
    std::vector<Reveal> reveals_;
    std::vector<Member> members_;  // [batch]
};

}  // namespace throng
