// Poses that the application sets for chosen instances, and their fades. They are kept here; begin() uploads those that
// have changed, inside the command buffer.
#pragma once

#include "blend/pose_override.h"
#include "blend/pose_override_io.h"
#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/stage.h"
#include "sample/sample_io.h"

#include <map>

namespace throng {

class PoseStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // What native updates keep of a group's poses, beside its buffers.
    static uint64_t native_bytes(const Group& group);
    // Serves the groups that have room for poses.
    explicit PoseStage(const StageContext& context);

    // As Crowd::set_pose() and clear_pose(). Makes room for all of the instances, or throws kLimit and makes none.
    void make_room(std::span<const InBatch> instances);
    // Needs room made before, a pose from checked_pose(), and a fade that check_fade() accepts.
    void set(const InBatch& at, std::span<const Trs<double>> pose, float fade_s);
    void clear(const InBatch& at, float fade_s);
    void despawn(std::span<const InstanceHandle> gone) override;

    // What native updates of a group read, NativeUpdate::set_poses; null where there is nothing.
    const float* native_poses(uint32_t group) const {
        return reinterpret_cast<const float*>(of_groups_[group].native_poses.get());
    }

    // Takes the fades a step further, and uploads what changed.
    void begin(const Update& update) override;
    // What was set or cleared since stays so.
    void discard() override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    void retire() override;
    uint32_t end_count() const override { return 0; }
    uint64_t size_bytes() const override;

private:
    struct Override {
        uint32_t slot = 0;
        PoseFade fade;
        PoseFade before;           // what `fade` would be without the last begin()
        bool awaits_pose = false;  // between make_room() and set()

        // A further step would change nothing, nor would taking the last one back.
        bool is_at_rest() const { return !fade.is_moving() && !fade.is_gone() && before == fade; }
    };
    struct BatchPoses {
        // [instance_count], as the device has them, or will have by the next begin(); empty where there is no room for
        // poses
        std::vector<io::InstancePose> instances;
        std::map<uint32_t, Override> overrides;  // those that have a slot
        DirtyRanges unsettled;                   // instances whose overrides are not at rest
        DirtyRanges changed;                     // of instances
    };
    struct GroupPoses {
        // A min-heap, of which the lowest slot is taken next: the order in which slots became free must not matter,
        // since a saved state does not keep it
        std::vector<uint32_t> free_slots;
        std::vector<io::JointPose> poses;   // [slots ever used][joint_count]
        DirtyRanges changed;                // of slots
        native::AlignedBytes native_poses;  // [pose_capacity], as NativeRig has them
        uint64_t native_poses_bytes = 0;
    };
    using OverrideAt = std::map<uint32_t, Override>::iterator;

    void exchange_overrides(StateArchive& archive, uint32_t batch);
    void exchange_poses(StateArchive& archive, uint32_t group);
    void find_free_slots(uint32_t group);
    void put_native_pose(uint32_t group, uint32_t slot);
    uint32_t take_slot(const InBatch& at);
    bool take_back_slot(uint32_t group);
    void erase(uint32_t batch, OverrideAt at);
    void follow(uint32_t batch, OverrideAt at);
    // Calls visit(override_at) for each instance of the ranges that has one.
    template <class Visit>
    static void for_each_override(BatchPoses& poses, std::span<const DirtyRanges::Range> ranges, const Visit& visit);
    template <class T>
    void upload_changes(VkCommandBuffer commands, const Buffer& buffer, DirtyRanges& changed,
                        const std::vector<T>& items, uint64_t item_size) const;

    std::vector<BatchPoses> of_batches_;  // [batch]
    std::vector<GroupPoses> of_groups_;   // [group]
};

}  // namespace throng
