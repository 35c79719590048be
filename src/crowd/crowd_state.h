// The implementation of Crowd: groups, batches, and the updates that they go through.
//
// A group is one character; a batch is a run of its instances whose buffers fit the device's limits. The control stage
// advances all batches. Then the fused ones go from cursors to skin matrices in one pass, the others stage by stage.
#pragma once

#include "crowd/attach_stage.h"
#include "crowd/control_stage.h"
#include "crowd/controller_stage.h"
#include "crowd/cull_stage.h"
#include "crowd/first_uploads.h"
#include "crowd/instance_command_stage.h"
#include "crowd/look_stage.h"
#include "crowd/placement_stage.h"
#include "crowd/population_stage.h"
#include "crowd/pose_stage.h"
#include "crowd/procedural_stage.h"
#include "crowd/recorded_updates.h"
#include "crowd/retired.h"
#include "crowd/staged_update.h"
#include "crowd/steer_stage.h"

#include <throng/crowd.h>

#include <map>
#include <memory>
#include <optional>

namespace throng {

// Checksums of what must be the same in the crowd that a state was saved from and the one that it is restored to.
struct StateFit {
    uint64_t paths = 0, settings = 0, groups = 0, counts = 0, buffers = 0;
};

struct CrowdState {
    CrowdState(std::shared_ptr<Gpu> gpu, const CrowdSettings& settings);

    const Group& group_at(uint32_t group) const;  // throws kInvalidArgument
    // Takes over all groups of another crowd, which then has none. Returns the numbers that they have here.
    std::vector<GroupIndex> add_groups(CrowdState& from);
    void remove_group(uint32_t group);
    std::vector<InstanceHandle> spawn(uint32_t group, std::span<const Affine> world_from_model);
    void despawn(std::span<const InstanceHandle> instances);
    bool is_alive(const InstanceHandle& instance) const;
    bool has_instance(uint32_t instance) const {
        return batch_at(batches, instance) && population->has_instance(instance);
    }
    InstanceHandle handle(uint32_t instance) const;
    uint32_t alive_count(uint32_t group) const;
    Instances instances(uint32_t group) const;
    void set_playback(const Instances& instances, const Each<Playback>& playback);
    void set_placement(const Instances& instances, const Each<Affine>& world_from_model);
    void set_look(const Instances& instances, const Each<InstanceLook>& look);
    void attach(const Instances& instances, const Each<Attachment>& attachment);
    void detach(const Instances& instances);
    void play(const Instances& instances, uint32_t layer, const Each<LayerPlayback>& playback);
    void set_state(const Instances& instances, uint32_t layer, const Each<PlayedMotion>& state, float fade_s);
    void set_layer(const Instances& instances, uint32_t layer, const Each<LayerBlend>& blend);
    void set_parameter(const Instances& instances, uint32_t parameter, const Each<float>& value);
    void set_target(const Instances& instances, uint32_t target, const Each<TargetPlace>& place);
    void set_destination(const Instances& instances, const Each<Vec3<float>>& world_place);
    void clear_destination(const Instances& instances);
    void set_pose(const Instances& instances, std::span<const Trs<float>> parent_from_joint, float fade_s);
    void clear_pose(const Instances& instances, float fade_s);
    void watch(const Instances& instances);
    void request_poses(const Instances& instances);
    std::vector<Feedback> take_feedback();
    // Whether update() computes natively. A software device does so only without occlusion; a native device refuses
    // occlusion.
    bool updates_natively(bool occlusion) const;
    // Upload the first contents of the buffers, unless an update or either of these calls has done so. The second
    // waits for the upload.
    void record_uploads(VkCommandBuffer commands);
    void finish_uploads();
    void discard_uploads();  // after an update has been discarded: what it has uploaded is uploaded again
    // Throws kInvalidArgument where the last record() was not discarded and its commands have not run. May wait for the
    // device's queue.
    void check_last_has_run(const char* what) const;
    // As PlacementStage::follow().
    void follow_placements(bool wait);
    void update(float time_step_s, const CrowdView* view);
    // With a command buffer of VK_NULL_HANDLE it computes natively, at once.
    void record(VkCommandBuffer commands, float time_step_s, const CrowdView* view);
    void record_disoccluded(VkCommandBuffer commands, const DepthImage& depths);
    void discard_last_record();
    // Whether the last update was recorded into the application's commands, which may not have run.
    bool awaits_commands() const { return awaits_commands_; }
    void save_state(std::vector<std::byte>& out);
    void restore_state(std::span<const std::byte> state);
    std::vector<DrawnInstance> read_drawn();
    std::vector<Affine> read_matrices(const InstanceHandle& instance, bool model);
    std::vector<Vec3<float>> read_positions(const InstanceHandle& instance);
    uint64_t size_bytes() const;

    std::shared_ptr<Gpu> gpu;
    uint32_t instance_count = 0;
    SkinFormat skin_format = SkinFormat::kAffine;
    SkinBlend skin_blend = SkinBlend::kLinear;
    bool skins_once = false;
    std::deque<Group> groups;    // with gaps (Group::is_gone()), which later groups fill
    std::vector<Batch> batches;  // in ascending order of their instances; numbers between them are unused
    std::vector<std::vector<OutputBlock>> outputs;  // [frame slot][batch]
    uint32_t slot = 0;                              // of the last update
    std::unique_ptr<StageTimer> timer;
    std::optional<FeedbackRing> feedback;

    // In the order of an update. The pointers below refer to some of them, and are null if the crowd does not need the
    // stage.
    std::vector<std::unique_ptr<Stage>> stages;
    ChangeStage* changes = nullptr;  // this and the next two are always there
    PopulationStage* population = nullptr;
    PlacementStage* placements = nullptr;
    LookStage* looks = nullptr;
    ControlStage* control = nullptr;
    ControllerStage* controllers = nullptr;
    SteerStage* steer = nullptr;
    CullStage* cull = nullptr;
    PoseStage* poses = nullptr;
    ProceduralStage* procedural = nullptr;
    StagedUpdate* staged = nullptr;
    AttachStage* attachments = nullptr;
    InstanceCommandStage* instance_commands = nullptr;

private:
    // A buffer of a batch that a state holds.
    struct KeptBuffer {
        const Batch* batch;
        uint32_t number;
        const Buffer* buffer;
    };

    void check_groups(const CrowdSettings& settings) const;
    void make_groups(Uploads& uploads, const CrowdSettings& settings);
    BatchPlan plan_batches(const Group& group, const CrowdSettings& settings) const;
    void check_memory(std::string_view what, uint64_t needed_bytes) const;
    uint64_t batch_count_of(const BatchPlan& plan, uint32_t count) const;
    void make_batches(Uploads& uploads, const BatchPlan& plan, uint32_t group, uint32_t count);
    OutputBlock output_of(const Batch& batch, uint32_t slot) const;
    uint64_t skin_row_count(const Batch& batch) const;
    HostOutputs host_outputs(const Batch& batch, uint32_t slot) const;
    void make_feedback();
    WatchedBatch watched_in(const Batch& batch) const;
    void find_watched_runs();
    std::vector<RequestedPose> take_pose_requests();
    using Stages = std::vector<std::unique_ptr<Stage>>;
    Stages make_stages(Uploads& uploads);
    void use_stages(Stages made);
    static uint32_t end_count_of(const Stages& of);
    static uint32_t timer_room_for(const Stages& of);
    std::unique_ptr<StageTimer> make_timer(const Stages& of) const;
    void make_outputs();
    Update update_of(VkCommandBuffer commands, float time_step_s, const io::CullView& view) const;
    void check_runs(bool natively) const;
    void free_what_may_go();
    void go_to_slot(uint32_t next);
    Access consumers() const;
    void copy_shown(VkCommandBuffer commands) const;
    float budgeted_full_rate_pixels(const CrowdView& view);
    void send(uint32_t instance, io::ControlCommand command);
    template <class MakeCommand>
    void send_each(const Instances& instances, const char* what, const MakeCommand& make_command);
    StateFit state_fit() const;
    std::vector<KeptBuffer> kept_buffers() const;
    void exchange(StateArchive& archive);
    void download_all(std::span<const KeptBuffer> kept, std::span<std::byte> contents) const;
    static void clear_playbacks(std::span<const KeptBuffer> kept, std::span<std::byte> contents);
    void upload_all(std::span<const KeptBuffer> kept, std::span<const std::byte> contents) const;
    void check_agents(const Instances& instances) const;
    void copy_to_previous(VkCommandBuffer commands) const;
    // For calls that name instances: throws kInvalidArgument if one is not there.
    void check_alive(const Instances& instances, const char* what) const;
    void check_alive(uint32_t first_instance, uint32_t count, const char* what) const;
    void check_readable(const InstanceHandle& handle) const;
    static void refuse_if_shaders_populate(const Group& group, const char* what);
    void check_handle(const InstanceHandle& handle, const char* what) const;
    // Also throws if the group that had this number has been removed. Does not check whether the number belongs to
    // another instance now.
    void check_in_group(const InstanceHandle& handle, const char* what) const;
    void check_range(uint32_t first_instance, uint32_t count, const char* what) const;
    InBatch at(uint32_t instance) const { return in_batch(batches, instance); }
    const Group& group_of(uint32_t instance) const { return groups[batch_of(instance).group]; }
    const Batch& batch_of(uint32_t instance) const;
    uint32_t read_word(const Buffer& words, uint32_t instance) const;
    uint32_t read_skin_row(const Group& group, const Batch& batch, uint32_t instance) const;
    uint32_t joint_set_of(const Batch& batch, uint32_t instance) const;

    // Groups that come and go: crowd_groups.cpp
    struct StageState {
        const Stage* stage = nullptr;
        std::vector<std::byte> of_crowd;
        std::map<uint32_t, std::vector<std::byte>> of_groups;
    };
    // A group that joins the crowd, or leaves it.
    struct Move {
        uint32_t from = 0, to = 0;                         // groups; `to` is kNone if it leaves
        uint32_t first_from = 0, first_to = 0, count = 0;  // its instances
    };
    struct GroupInTransit {
        Group group;
        CrowdGroup settings;
        std::vector<Batch> batches;
    };
    // What the crowd continues with after a change of groups.
    struct RebuiltStages {
        Stages stages{};
        std::unique_ptr<FirstUploads> uploads{};
        std::unique_ptr<StageTimer> timer{};  // if the one before has too little room
        std::optional<Retired> retired{};     // will keep what updates under way may use
    };
    void check_may_change(const char* what) const;
    void check_goes_with(const CrowdState& other) const;
    std::vector<StageState> stage_states() const;
    Move plan_move(const CrowdState& from, uint32_t group, std::span<const Move> others) const;
    GroupInTransit take_out(uint32_t group);
    void put_in(GroupInTransit moving, uint32_t group, uint32_t first_instance);
    void count_instances();
    RebuiltStages rebuild_stages(std::span<const StageState> before, std::span<const StageState> joining,
                                 std::span<const Move> moves);
    void commit_group_change(RebuiltStages made, Retired::Things gone);

    EventPool events_;
    RecordedUpdates recorded_{events_};
    CrowdSettings settings_;                                    // without what the application owns
    std::vector<std::unique_ptr<FirstUploads>> first_uploads_;  // of the crowd, and of later changes of groups
    std::vector<Retired> retired_;
    uint32_t timer_room_ = 0;  // StageTimer's max_stages
    bool natively_ = false;    // all groups are updated natively, where that is possible
    bool keeps_previous_ = false;
    bool is_in_flight_ = false;          // drawing may read the outputs of one update while the next one runs
    std::optional<Kernel> skin_kernel_;  // made when positions are first read back
    bool has_updated_ = false;
    bool was_native_ = false;  // whether the last update was computed natively
    bool had_native_ = false;  // `was_native_` and `has_updated_` before the last record(), for discard
    bool had_updated_ = false;
    bool awaits_commands_ =
        false;                  // the last update was recorded into commands, which may have run or been dropped since
    bool can_discard_ = false;  // the last record() has not been discarded, and groups have not changed since
    bool may_be_pending_ = false;    // commands of a record() that has not been discarded may not have run
    bool is_half_recorded_ = false;  // the last record() failed midway
    static constexpr float kMaxFullRateFactor = 1e6f;
    float full_rate_factor_ = 1;    // the budget's factor on CrowdView::full_rate_pixels; 1..kMaxFullRateFactor
    std::vector<Watched> watched_;  // by instance
    WatchedRuns watched_runs_;      // of the last update; kept to reuse the memory
    uint32_t watch_capacity_ = 0;
    std::vector<uint32_t> pose_requests_, recorded_pose_requests_;  // for the next record(), and of the last one
    uint32_t pose_request_capacity_ = 0;
};

}  // namespace throng
