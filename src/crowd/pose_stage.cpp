#include "crowd/pose_stage.h"

#include "base/failure.h"

#include <algorithm>

namespace throng {
namespace {

io::JointPose to_io(const Trs<double>& pose) {
    const auto& [q, t, s] = pose.as<float>();
    return {.rotation = {q.x, q.y, q.z, q.w}, .translation = {t.x, t.y, t.z, 0}, .scale = {s.x, s.y, s.z, 0}};
}

}  // namespace

PoseStage::PoseStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches)
    : gpu_(std::move(gpu)), groups_(groups), batches_(batches), of_batches_(batches.size()), of_groups_(groups.size()) {
    for (size_t i = 0; i < batches_.size(); ++i)
        if (groups_[batches_[i].group].pose_capacity > 0) of_batches_[i].instances.resize(batches_[i].instance_count);
}

// With a slot, given where the instance has none yet.
PoseStage::Posed& PoseStage::posed_at(uint32_t batch, uint32_t instance, const std::string& place) {
    std::map<uint32_t, Posed>& posed = of_batches_[batch].posed;
    if (const auto found = posed.find(instance); found != posed.end()) return found->second;
    const Group& group = groups_[batches_[batch].group];
    GroupPoses& poses = of_groups_[batches_[batch].group];
    if (poses.free_slots.empty()) {
        const auto slot = static_cast<uint32_t>(poses.poses.size() / group.joint_count);
        if (slot == group.pose_capacity)
            throw Failure(ErrorCode::kLimit, place, "all " + std::to_string(group.pose_capacity) + " poses of CrowdGroup::pose_capacity of " + group.name + " are in use");
        poses.poses.resize(poses.poses.size() + group.joint_count);
        poses.free_slots.push_back(slot);
    }
    Posed& one = posed[instance];
    one.slot = poses.free_slots.back();
    poses.free_slots.pop_back();
    return one;
}

void PoseStage::set(uint32_t batch, uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s, const std::string& place) {
    const Group& group = groups_[batches_[batch].group];
    check_fade(fade_s, place);
    const std::vector<Trs<double>> pose = checked_pose(parent_from_joint, group.joint_count, group.uniform_scale, place);
    Posed& posed = posed_at(batch, instance, place);
    posed.fade.set(fade_s);
    GroupPoses& poses = of_groups_[batches_[batch].group];
    std::ranges::transform(pose, poses.poses.begin() + static_cast<ptrdiff_t>(uint64_t{posed.slot} * group.joint_count), to_io);
    poses.changed.add(posed.slot, 1);
}

void PoseStage::clear(uint32_t batch, uint32_t instance, float fade_s, const std::string& place) {
    check_fade(fade_s, place);
    const PosedAt found = of_batches_[batch].posed.find(instance);
    if (found == of_batches_[batch].posed.end()) return;
    found->second.fade.clear(fade_s);
    follow(batch, found);
}

// What the device is to know of an instance; its slot is free where the pose has gone. Returns the next one.
PoseStage::PosedAt PoseStage::follow(uint32_t batch, PosedAt at) {
    BatchPoses& poses = of_batches_[batch];
    const auto& [instance, posed] = *at;
    const bool has_gone = !posed.fade.is_set() && !posed.fade.is_moving();
    const io::InstancePose now{.slot = posed.slot, .weight = posed.fade.weight()};
    io::InstancePose& known = poses.instances[instance];
    if (known.slot != now.slot || known.weight != now.weight) poses.changed.add(instance, 1);
    known = now;
    if (!has_gone) return std::next(at);
    of_groups_[batches_[batch].group].free_slots.push_back(posed.slot);
    return poses.posed.erase(at);
}

void PoseStage::record(VkCommandBuffer commands, float time_step_s) {
    for (uint32_t i = 0; i < of_batches_.size(); ++i) {
        BatchPoses& batch = of_batches_[i];
        for (PosedAt at = batch.posed.begin(); at != batch.posed.end();) {
            at->second.fade.advance(time_step_s);
            at = follow(i, at);
        }
        upload_changes(commands, batches_[i].posed, batch.changed, batch.instances, 1);
    }
    for (size_t i = 0; i < of_groups_.size(); ++i) upload_changes(commands, groups_[i].poses, of_groups_[i].changed, of_groups_[i].poses, groups_[i].joint_count);
}

// An item has `item_size` elements.
template <class T>
void PoseStage::upload_changes(VkCommandBuffer commands, const Buffer& buffer, DirtyRanges& changed, const std::vector<T>& items, uint64_t item_size) const {
    for (const auto& [first, count] : changed.take()) record_update(*gpu_, commands, buffer, first * item_size, std::span(items).subspan(first * item_size, count * item_size));
}

}  // namespace throng
