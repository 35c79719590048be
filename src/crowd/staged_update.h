// Cursors -> skin matrices, stage by stage: sample, blend, procedural rules, scan, bind, each through memory. Layers
// are sampled and blended by one kernel, whose time counts as sample.
//
// A wave is a run of batches whose intermediates (poses, local and model matrices) fit the arena together. A wave goes
// through the stages as a whole, so that small groups share a dispatch's latency; then the next wave reuses the arena.
#pragma once

#include "blend/layered.h"
#include "crowd/batch_plan.h"
#include "crowd/procedural_stage.h"
#include "crowd/stage.h"

#include <map>
#include <optional>

namespace throng {

// The largest size of a buffer of intermediates.
uint64_t arena_limit_bytes(const Gpu& gpu);

class StagedUpdate : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose group is not fused.
    explicit StagedUpdate(const StageContext& context);

    void record(const Update& update) override;
    uint32_t end_count() const override;
    uint32_t wave_count() const { return static_cast<uint32_t>(waves_.size()); }
    uint64_t size_bytes() const override;

private:
    struct ServedBatch {
        uint32_t batch = 0;
        uint64_t arena_offset_bytes = 0;
        Bindings sample_first, sample_second, blend;  // of two clips
        Bindings layered;                             // of layers
        ProceduralStage::KindBindings procedural;
        Bindings scan, sockets;
        std::vector<Bindings> bind;  // [frame slot]
    };
    struct Wave {
        uint32_t first_served = 0, served_count = 0;
    };

    void make_waves();
    void bind_batch(ServedBatch& served);
    void record_wave(const Update& update, const Wave& wave) const;
    void record_procedural(const Update& update, std::span<const ServedBatch> of_wave) const;
    const Kernel& sample_of(const Group& group) const { return *sample_[group.packed][group.varies]; }
    static LayeredSettings layered_settings(const Group& group);
    const Kernel& layered_of(const Group& group) const { return layered_.at(layered_settings(group)); }
    void record_layered(VkCommandBuffer commands, const ServedBatch& served, uint32_t instance_count,
                        const Group& group) const;
    const Kernel& blend_of(const Group& group) const {
        return *blend_[group.takes_similarities()][group.pose_capacity > 0][group.varies];
    }
    const Kernel& bind_of(const Group& group) const { return *bind_[group.varies]; }

    const ProceduralStage& procedural_;
    std::vector<ServedBatch> served_;
    std::vector<Wave> waves_;
    // Kernels, made for the combinations that occur among the groups
    std::optional<Kernel> sample_[2][2];    // [packed][Group::varies]
    std::optional<Kernel> blend_[2][2][2];  // [similarities][pose_overrides][Group::varies]
    std::map<LayeredSettings, Kernel> layered_;
    std::optional<Kernel> bind_[2], sockets_;  // [Group::varies]
    // The arena, 48 bytes a joint each; second_poses serves the scan as scratch once blended
    Buffer first_poses_, second_poses_, local_, model_;
};

}  // namespace throng
