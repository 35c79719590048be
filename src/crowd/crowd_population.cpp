// Instances that come and go.
#include "base/failure.h"
#include "base/finite.h"
#include "crowd/crowd_state.h"

#include <algorithm>

namespace throng {
const Group& CrowdState::group_at(uint32_t group) const {
    if (group >= groups.size())
        throw Failure(ErrorCode::kInvalidArgument, "crowd",
                      "group " + std::to_string(group) + " is out of range: this crowd's group numbers are below " +
                          std::to_string(groups.size()));
    if (groups[group].is_gone())
        throw Failure(ErrorCode::kInvalidArgument, "crowd", "group " + std::to_string(group) + " has been removed");
    return groups[group];
}

void CrowdState::refuse_if_shaders_populate(const Group& group, const char* what) {
    if (group.shaders_populate)
        throw Failure(ErrorCode::kInvalidArgument, what, group.name,
                      ": only shaders spawn, despawn and control its instances (ShaderCommands::populate)");
}

std::vector<InstanceHandle> CrowdState::spawn(uint32_t group, std::span<const Affine> world_from_model) {
    if (!group_at(group).varies)
        throw Failure(ErrorCode::kInvalidArgument, groups[group].name + ": spawn", "CrowdGroup::capacity is not set");
    refuse_if_shaders_populate(groups[group], "spawn");
    for (size_t i = 0; i < world_from_model.size(); ++i)
        if (!all_finite(world_from_model[i]))
            throw Failure(ErrorCode::kInvalidArgument, "spawn: placement " + std::to_string(i),
                          "a number is not finite");
    const std::vector<uint32_t> instances = population->spawn(group, static_cast<uint32_t>(world_from_model.size()));
    std::vector<InstanceHandle> handles;
    handles.reserve(instances.size());
    for (const uint32_t instance : instances) {
        handles.push_back(handle(instance));
        if (groups[group].controller) send(instance, {.kind = io::kCommandBegin});
    }
    placements->set(handles, Each(handles, world_from_model, "spawn"));
    return handles;
}

namespace {

// Marks them in bits, since sorting thousands of numbers takes longer.
void refuse_repeated(std::span<const InstanceHandle> instances) {
    if (instances.empty()) return;
    const auto [least, most] = std::ranges::minmax(instances, {}, &InstanceHandle::instance);
    std::vector<bool> is_given(most.instance - least.instance + size_t{1});
    for (const auto& [instance, generation] : instances) {
        if (is_given[instance - least.instance])
            throw Failure(ErrorCode::kInvalidArgument, "despawn",
                          "instance " + std::to_string(instance) + " is given twice");
        is_given[instance - least.instance] = true;
    }
}

}  // namespace

void CrowdState::despawn(std::span<const InstanceHandle> instances) {
    for (size_t i = 0; i < instances.size(); ++i) {
        const InstanceHandle& gone = instances[i];
        check_in_group(gone, "despawn");
        refuse_if_shaders_populate(group_of(gone.instance), "despawn");
        if (!is_alive(gone)) throw Failure(ErrorCode::kInvalidArgument, "despawn", name_of(gone) + " is not alive");
        if (!group_of(gone.instance).varies)
            throw Failure(ErrorCode::kInvalidArgument, "despawn",
                          name_of(gone) + " cannot be despawned: its group has no CrowdGroup::capacity");
    }
    refuse_repeated(instances);
    for (const auto& stage : stages) stage->despawn(instances);
    for (std::vector<uint32_t>* requests : {&pose_requests_, &recorded_pose_requests_})
        std::erase_if(*requests, [&](uint32_t instance) { return !has_instance(instance); });
    std::erase_if(watched_, [&](const Watched& watched) { return !has_instance(watched.instance); });
}

bool CrowdState::is_alive(const InstanceHandle& instance) const {
    const Batch* const batch = batch_at(batches, instance.instance);
    return batch && population->is_alive(*batch, instance);
}

InstanceHandle CrowdState::handle(uint32_t instance) const {
    check_alive(Instances::numbered(instance), "handle");
    return {instance, population->generation(instance)};
}

uint32_t CrowdState::alive_count(uint32_t group) const {
    refuse_if_shaders_populate(group_at(group), "alive count");
    if (group_at(group).varies) return population->alive_count(group);
    uint32_t count = 0;
    for (const Batch& batch : batches) count += batch.group == group ? batch.instance_count : 0;
    return count;
}

}  // namespace throng
