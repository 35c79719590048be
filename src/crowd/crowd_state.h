// The inside of a Crowd: groups, batches, and the updates that they go through.
//
// A group is one character; a batch is a run of its instances whose buffers fit the device's limits. control advances
// all batches; then the fused ones go from cursors to skin matrices in one pass, the others stage by stage.
#pragma once

#include "crowd/controller_stage.h"
#include "crowd/cull_stage.h"
#include "crowd/dirty_ranges.h"
#include "crowd/fused_update.h"
#include "crowd/pace_stage.h"
#include "crowd/procedural_stage.h"
#include "crowd/skin_stage.h"
#include "crowd/pose_stage.h"
#include "crowd/morph_stage.h"
#include "crowd/steer_stage.h"
#include "crowd/staged_update.h"
#include "control/control_io.h"

#include <throng/crowd.h>

#include <memory>
#include <optional>

namespace throng {

struct CrowdLife {};

// Nothing has moved it yet.
io::RootState standing_at(const Affine& world_from_model);

struct CrowdState {
    CrowdState(std::shared_ptr<Gpu> gpu, const CrowdSettings& settings);

    void set_playback(uint32_t first_instance, std::span<const Playback> playback);
    void set_placement(uint32_t first_instance, std::span<const Affine> world_from_model);
    void play(uint32_t instance, uint32_t layer, const LayerPlayback& playback);
    void set_layer(uint32_t instance, uint32_t layer, const LayerBlend& blend);
    void set_parameters(uint32_t instance, uint32_t parameter, std::span<const float> values);
    void set_target(uint32_t instance, uint32_t target, const Vec3<float>& world_place, float weight);
    void set_destination(uint32_t first_instance, std::span<const Vec3<float>> world_places);
    void clear_destination(uint32_t first_instance, uint32_t count);
    void set_pose(uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s);
    void clear_pose(uint32_t instance, float fade_s);
    void watch(std::span<const uint32_t> instances);
    std::vector<Feedback> take_feedback();
    void record(VkCommandBuffer commands, float time_step_s, const CrowdView* view);
    void record_disoccluded(VkCommandBuffer commands, const DepthImage& depths);
    void discard_last_record();
    std::vector<DrawnInstance> read_drawn() const;
    std::vector<Affine> read_matrices(uint32_t instance, bool model) const;
    std::vector<Vec3<float>> read_positions(uint32_t instance);
    uint64_t size_bytes() const;

    std::shared_ptr<Gpu> gpu;
    // By it others know this crowd from one that is made later at the same place, and when it is gone.
    std::shared_ptr<const CrowdLife> life = std::make_shared<const CrowdLife>();
    uint32_t instance_count = 0;
    SkinFormat skin_format = SkinFormat::kAffine;
    SkinBlend skin_blend = SkinBlend::kLinear;
    std::vector<Group> groups;
    std::vector<Batch> batches;
    std::vector<OutputBlock> outputs;
    std::vector<Affine> placements;  // [instance_count], as last set
    std::unique_ptr<StageTimer> timer;
    std::optional<CullStage> cull;  // where CrowdSettings::culls
    std::optional<ProceduralStage> procedural;
    std::optional<FusedUpdate> fused;
    std::optional<PaceStage> pace;
    std::optional<StagedUpdate> staged;
    std::optional<FeedbackRing> feedback;
    std::optional<ControllerStage> controllers;
    std::optional<SteerStage> steer;
    std::optional<PoseStage> poses;
    std::optional<MorphStage> morphs;
    std::optional<SkinStage> skin;  // where CrowdSettings::skins_once

private:
    void make_batches(Uploads& uploads, uint32_t group, const CrowdSettings& settings);
    void take_turns();
    float paced_full_rate_pixels(const CrowdView* view);
    void make_feedback(const CrowdSettings& settings);
    void make_layers(Uploads& uploads, Batch& batch) const;
    void make_procedural_state(Uploads& uploads, Batch& batch) const;
    void send(uint32_t instance, io::ControlCommand command);
    const Batch& batch_of_agent(uint32_t instance) const;
    const GroupController& controller_of(uint32_t instance, const char* what) const;
    void check_memory(const CrowdSettings& settings) const;
    void upload_changes(VkCommandBuffer commands);
    void record_control(VkCommandBuffer commands, float time_step_s);
    void copy_to_previous(VkCommandBuffer commands) const;
    void count_blending(uint32_t first_instance, std::span<const io::InstancePlayback> changed);
    void check_range(uint32_t first_instance, size_t count, const char* what) const;
    const Batch& batch_of(uint32_t instance) const;
    uint32_t joint_set_of(const Batch& batch, uint32_t instance) const;
    uint32_t index_of(const Batch& batch) const { return static_cast<uint32_t>(&batch - batches.data()); }

    Kernel control_;
    std::optional<Kernel> skin_kernel_;            // made when positions are first read back
    std::vector<io::InstancePlayback> playbacks_;  // [instance_count], as last set
    bool has_updated_ = false;
    bool had_updated_ = false;  // before the last record()
    bool can_discard_ = false;  // the last record() has not been discarded
    float pace_ = 1;            // what the budget makes of CrowdView::full_rate_pixels, as a factor
    std::vector<Watched> watched_;
    uint32_t watch_capacity_ = 0;
    DirtyRanges dirty_playbacks_, dirty_placements_;
};

}  // namespace throng
