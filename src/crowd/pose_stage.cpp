#include "crowd/pose_stage.h"

#include "base/failure.h"
#include "base/finite.h"
#include "crowd/state_archive.h"

#include <algorithm>
#include <functional>

namespace throng {
namespace {

io::JointPose to_io(const Trs<double>& pose) {
    const auto& [q, t, s] = pose.as<float>();
    return {.rotation = {q.x, q.y, q.z, q.w}, .translation = {t.x, t.y, t.z, 0}, .scale = {s.x, s.y, s.z, 0}};
}

Trs<float> from_io(const io::JointPose& pose) {
    const auto& [q, t, s] = pose;
    return {.rotation = {q.x, q.y, q.z, q.w}, .translation = {t.x, t.y, t.z}, .scale = {s.x, s.y, s.z}};
}

}  // namespace

void PoseStage::plan(BatchPlan& plan) {
    if (plan.group().pose_capacity == 0) return;
    plan.add(io::kPoseOverridesBuffer, sizeof(io::InstancePose),
             [](Uploads& uploads, const std::string& what, uint64_t n) {
                 return fill_table(uploads, what, std::vector<io::InstancePose>(1), n);
             });
}

PoseStage::PoseStage(const StageContext& context)
    : Stage(context), of_batches_(batches_.size()), of_groups_(groups_.size()) {
    for (size_t i = 0; i < groups_.size(); ++i)
        if (const uint64_t size_bytes = native_bytes(groups_[i]); size_bytes > 0) {
            of_groups_[i].native_poses = native::aligned_bytes(size_bytes);
            of_groups_[i].native_poses_bytes = size_bytes;
        }
    for (size_t i = 0; i < batches_.size(); ++i)
        if (group_of(batches_[i]).pose_capacity > 0) of_batches_[i].instances.resize(batches_[i].instance_count);
}

uint64_t PoseStage::native_bytes(const Group& group) {
    return group.native_rig() ? group.pose_capacity * group.native_rig()->pose_floats() * sizeof(float) : 0;
}

void PoseStage::retire() {
    of_batches_.clear();
    of_groups_.clear();
}

uint64_t PoseStage::size_bytes() const {
    uint64_t sum = 0;
    for (const GroupPoses& of_group : of_groups_) sum += of_group.native_poses_bytes;
    return sum;
}

void PoseStage::make_room(std::span<const InBatch> instances) {
    std::vector<std::pair<uint32_t, OverrideAt>> made, had;
    try {
        for (const InBatch& at : instances) {
            std::map<uint32_t, Override>& overrides = of_batches_[at.batch].overrides;
            if (const auto found = overrides.find(at.instance); found != overrides.end()) {
                had.emplace_back(at.batch, found);
                found->second.awaits_pose = true;
            } else {
                of_batches_[at.batch].unsettled.add(at.instance, 1);
                const Override with_room{.slot = take_slot(at), .fade = {}, .before = {}, .awaits_pose = true};
                made.emplace_back(at.batch, overrides.emplace(at.instance, with_room).first);
            }
        }
    } catch (...) {
        for (const auto& [batch, override_at] : had) override_at->second.awaits_pose = false;
        for (const auto& [batch, override_at] : made) erase(batch, override_at);
        throw;
    }
}

uint32_t PoseStage::take_slot(const InBatch& at) {
    const uint32_t group_index = batches_[at.batch].group;
    const Group& group = groups_[group_index];
    GroupPoses& poses = of_groups_[group_index];
    const auto used = static_cast<uint32_t>(poses.poses.size() / group.joint_count);
    if (group.pose_capacity == 0)
        throw Failure(ErrorCode::kLimit, group.name + ": pose", "CrowdGroup::pose_capacity is not set");
    if (poses.free_slots.empty() && used == group.pose_capacity && !take_back_slot(group_index))
        throw Failure(ErrorCode::kLimit,
                      "pose of instance " + std::to_string(batches_[at.batch].first_instance + at.instance),
                      "all " + std::to_string(group.pose_capacity) + " poses of " + group.name +
                          " (CrowdGroup::pose_capacity) are in use");
    if (poses.free_slots.empty()) {
        poses.poses.resize(poses.poses.size() + group.joint_count);
        return used;
    }
    std::ranges::pop_heap(poses.free_slots, std::greater());
    const uint32_t slot = poses.free_slots.back();
    poses.free_slots.pop_back();
    return slot;
}

// Frees the slot of a pose that the last update has faded out. If that update is discarded later, the pose stays gone.
bool PoseStage::take_back_slot(uint32_t group) {
    for (uint32_t i = 0; i < of_batches_.size(); ++i) {
        if (batches_[i].group != group) continue;
        std::map<uint32_t, Override>& overrides = of_batches_[i].overrides;
        const OverrideAt gone = std::ranges::find_if(
            overrides, [](const auto& one) { return one.second.fade.is_gone() && !one.second.awaits_pose; });
        if (gone == overrides.end()) continue;
        erase(i, gone);
        return true;
    }
    return false;
}

void PoseStage::erase(uint32_t batch, OverrideAt at) {
    std::vector<uint32_t>& free_slots = of_groups_[batches_[batch].group].free_slots;
    free_slots.push_back(at->second.slot);
    std::ranges::push_heap(free_slots, std::greater());
    of_batches_[batch].overrides.erase(at);
}

void PoseStage::set(const InBatch& at, std::span<const Trs<double>> pose, float fade_s) {
    const Group& group = group_of(batches_[at.batch]);
    Override& pose_override = of_batches_[at.batch].overrides.at(at.instance);
    pose_override.awaits_pose = false;
    for (PoseFade* fade : {&pose_override.fade, &pose_override.before}) fade->set(fade_s);
    of_batches_[at.batch].unsettled.add(at.instance, 1);
    GroupPoses& poses = of_groups_[batches_[at.batch].group];
    std::ranges::transform(
        pose, poses.poses.begin() + static_cast<ptrdiff_t>(uint64_t{pose_override.slot} * group.joint_count), to_io);
    poses.changed.add(pose_override.slot, 1);
    put_native_pose(batches_[at.batch].group, pose_override.slot);
}

void PoseStage::put_native_pose(uint32_t group_index, uint32_t slot) {
    const Group& group = groups_[group_index];
    const GroupPoses& poses = of_groups_[group_index];
    if (!poses.native_poses) return;
    const size_t floats = group.native_rig()->pose_floats();
    auto* const all = reinterpret_cast<float*>(poses.native_poses.get());
    std::vector<Trs<float>> pose;
    for (uint32_t joint = 0; joint < group.joint_count; ++joint)
        pose.push_back(from_io(poses.poses[uint64_t{slot} * group.joint_count + joint]));
    group.native_rig()->put_pose(pose, {all + slot * floats, floats});
}

void PoseStage::clear(const InBatch& at, float fade_s) {
    const OverrideAt found = of_batches_[at.batch].overrides.find(at.instance);
    if (found == of_batches_[at.batch].overrides.end()) return;
    Override& pose_override = found->second;
    for (PoseFade* fade : {&pose_override.fade, &pose_override.before}) fade->clear(fade_s);
    of_batches_[at.batch].unsettled.add(at.instance, 1);
    follow(at.batch, found);
    if (pose_override.fade.is_gone() && pose_override.before.is_gone()) erase(at.batch, found);
}

void PoseStage::despawn(std::span<const InstanceHandle> gone) {
    for (const InstanceHandle& one : gone) clear(in_batch(batches_, one.instance), 0);
}

// Updates the slot and weight that the device has of an instance.
void PoseStage::follow(uint32_t batch, OverrideAt at) {
    BatchPoses& poses = of_batches_[batch];
    const auto& [instance, pose_override] = *at;
    const io::InstancePose now{.slot = pose_override.slot, .weight = pose_override.fade.weight()};
    io::InstancePose& known = poses.instances[instance];
    if (known.slot != now.slot || known.weight != now.weight) poses.changed.add(instance, 1);
    known = now;
}

template <class Visit>
void PoseStage::for_each_override(BatchPoses& poses, std::span<const DirtyRanges::Range> ranges, const Visit& visit) {
    for (const auto& [first, count] : ranges)
        for (uint32_t instance = first; instance < first + count; ++instance)
            if (const OverrideAt at = poses.overrides.find(instance); at != poses.overrides.end()) visit(at);
}

// A slot becomes free one update after its pose has gone, when that can no longer be discarded.
void PoseStage::begin(const Update& update) {
    for (uint32_t i = 0; i < of_batches_.size(); ++i) {
        BatchPoses& batch = of_batches_[i];
        for_each_override(batch, batch.unsettled.take(), [&](OverrideAt at) {
            Override& pose_override = at->second;
            if (pose_override.fade.is_gone()) {
                erase(i, at);
                return;
            }
            pose_override.before = pose_override.fade;
            pose_override.fade.advance(update.time_step_s);
            follow(i, at);
            if (!pose_override.is_at_rest()) batch.unsettled.add(at->first, 1);
        });
        upload_changes(update.commands, batches_[i][io::kPoseOverridesBuffer], batch.changed, batch.instances, 1);
    }
    for (size_t i = 0; i < of_groups_.size(); ++i)
        upload_changes(update.commands, groups_[i][io::kSetPosesBuffer], of_groups_[i].changed, of_groups_[i].poses,
                       groups_[i].joint_count);
}

void PoseStage::discard() {
    for (uint32_t i = 0; i < of_batches_.size(); ++i) {
        BatchPoses& batch = of_batches_[i];
        batch.changed.put_back();
        for_each_override(batch, batch.unsettled.pending(), [&](OverrideAt at) {
            at->second.fade = at->second.before;
            follow(i, at);
        });
    }
    for (GroupPoses& poses : of_groups_) poses.changed.put_back();
}

// An item has `item_size` elements.
template <class T>
void PoseStage::upload_changes(VkCommandBuffer commands, const Buffer& buffer, DirtyRanges& changed,
                               const std::vector<T>& items, uint64_t item_size) const {
    for (const auto& [first, count] : changed.take())
        record_update(*gpu_, commands, buffer, first * item_size,
                      std::span(items).subspan(first * item_size, count * item_size));
}

// All is handed to the device with the next update.
void PoseStage::exchange_group(StateArchive& archive, uint32_t group) {
    exchange_poses(archive, group);
    for_each_batch_of(group, [&](const Batch&, uint32_t index) { exchange_overrides(archive, index); });
    if (archive.reads()) find_free_slots(group);
}

void PoseStage::exchange_poses(StateArchive& archive, uint32_t group_index) {
    const Group& group = groups_[group_index];
    if (group.pose_capacity == 0) return;
    GroupPoses& poses = of_groups_[group_index];
    archive.list(poses.poses, uint64_t{group.pose_capacity} * group.joint_count);
    if (!archive.reads()) return;
    StateArchive::require(poses.poses.size() % group.joint_count == 0, "a pose lacks joints");
    StateArchive::require(
        std::ranges::all_of(poses.poses,
                            [](const io::JointPose& joint) {
                                const auto& [r, t, s] = joint;
                                return all_finite(std::array{r.x, r.y, r.z, r.w, t.x, t.y, t.z, s.x, s.y, s.z});
                            }),
        "a pose is not finite");
    const auto slot_count = static_cast<uint32_t>(poses.poses.size() / group.joint_count);
    poses.changed = {};
    poses.changed.add(0, slot_count);
    for (uint32_t slot = 0; slot < slot_count; ++slot) put_native_pose(group_index, slot);
}

void PoseStage::exchange_overrides(StateArchive& archive, uint32_t batch) {
    BatchPoses& poses = of_batches_[batch];
    std::vector<uint32_t> instances;
    for (const auto& [instance, pose_override] : poses.overrides) instances.push_back(instance);
    archive.list(instances, poses.instances.size());
    if (archive.reads()) {
        poses.overrides.clear();
        std::ranges::fill(poses.instances, io::InstancePose{});
        poses.changed = {};
        poses.changed.add(0, static_cast<uint32_t>(poses.instances.size()));
    }
    for (const uint32_t instance : instances) {
        StateArchive::require(instance < poses.instances.size(), "a pose is for an instance that does not exist");
        const OverrideAt at = poses.overrides.try_emplace(instance).first;
        Override& pose_override = at->second;
        archive.value(pose_override.slot);
        pose_override.fade.exchange(archive);
        if (!archive.reads()) continue;
        pose_override.before = pose_override.fade;
        poses.unsettled.add(instance, 1);
        follow(batch, at);
    }
}

void PoseStage::find_free_slots(uint32_t group) {
    GroupPoses& poses = of_groups_[group];
    std::vector<bool> is_taken(poses.poses.size() / std::max(groups_[group].joint_count, 1u));  // [slots ever used]
    for_each_batch_of(group, [&](const Batch&, uint32_t index) {
        for (const auto& [instance, pose_override] : of_batches_[index].overrides) {
            const uint32_t slot = pose_override.slot;
            StateArchive::require(slot < is_taken.size() && !is_taken[slot],
                                  "an instance's pose does not exist, or belongs to another one too");
            is_taken[slot] = true;
        }
    });
    poses.free_slots.clear();
    for (size_t slot = 0; slot < is_taken.size(); ++slot)  // an ascending list is a min-heap
        if (!is_taken[slot]) poses.free_slots.push_back(static_cast<uint32_t>(slot));
}

}  // namespace throng
