// The cull stage of crowds that may be updated for a view: which instances are drawn, and in how much detail; which of
// them are animated, and in which joints.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/depth_pyramid.h"
#include "crowd/stage.h"
#include "cull/cull.h"

#include <optional>

namespace throng {

// The frustum planes of a view, and its eye. Without a view everything is seen, in full detail. `full_rate_pixels` is
// CrowdView's, or what the budget makes of it.
constexpr float kMaxFullRatePixels = 1e30f;
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
    // Throws kInvalidArgument if the last begin() was not for a view with occlusion, or its second half has been
    // recorded already.
    void record_disoccluded(const Update& update, const DepthImage& depths) override;
    // Allocates what record_disoccluded() needs for pictures of this size, so that it cannot fail for lack of memory.
    void make_room_for(const DepthImage& depths) { reveal_for(depths); }
    // Whether the second half of the last update, record_disoccluded(), is still to be recorded.
    bool is_half_done() const { return is_half_done_; }
    uint32_t end_count() const override { return 3; }
    // The instances that the last finished update listed for a batch.
    std::vector<DrawnInstance> read(uint32_t batch) const;
    uint64_t size_bytes() const override;

private:
    struct ServedBatch {
        Bindings cells, cull, offsets, list;
        bool has_cells = false;  // that match the current placements
    };
    struct Reveal {
        DepthPyramid pyramid;
        std::vector<Bindings> bindings;  // [batch]
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
    bool is_half_done_ = false;   // record_disoccluded() is still to be called
    bool was_half_done_ = false;  // before the last begin()
    // Made when needed, for the largest picture so far. Smaller ones are kept with their bindings, since updates
    // under way may use them. Each has twice the room of the one before, if the device can bind that.
    std::vector<Reveal> reveals_;
    std::vector<ServedBatch> served_;  // [batch]
};

}  // namespace throng
