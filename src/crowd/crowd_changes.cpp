// Changes by the application: checked and kept here, and applied by the next update.
#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "base/finite.h"
#include "control/layer_commands.h"
#include "procedural/procedural_plan.h"

#include <algorithm>
#include <cmath>

namespace throng {

void CrowdState::check_range(uint32_t first_instance, uint32_t count, const char* what) const {
    if (first_instance <= instance_count && count <= instance_count - first_instance) return;
    const uint64_t last_instance = uint64_t{first_instance} + count - 1;
    const std::string range = count > 1 ? joined("instances ", first_instance, " to ", last_instance, " are")
                                        : joined("instance ", first_instance, " is");
    throw Failure(ErrorCode::kInvalidArgument, what, range, " out of range: this crowd's instance numbers are below ",
                  instance_count);
}

void CrowdState::check_handle(const InstanceHandle& handle, const char* what) const {
    if (handle.instance == kNone)
        throw Failure(ErrorCode::kInvalidArgument, what,
                      "the handle is empty: use one from Crowd::spawn() or handle()");
    check_range(handle.instance, 1, what);
}

void CrowdState::check_in_group(const InstanceHandle& handle, const char* what) const {
    check_handle(handle, what);
    if (!batch_at(batches, handle.instance))
        throw Failure(ErrorCode::kInvalidArgument, what, name_of(handle), " is gone: its group has been removed");
}

void CrowdState::check_alive(const Instances& instances, const char* what) const {
    if (!instances.handles()) return check_alive(instances.first(), instances.size(), what);
    const Batch* batch = nullptr;  // often the same as for the previous handle
    for (const InstanceHandle& handle : std::span(instances.handles(), instances.size())) {
        check_handle(handle, what);
        if (!batch || !batch->has(handle.instance)) batch = batch_at(batches, handle.instance);
        if (batch) refuse_if_shaders_populate(groups[batch->group], what);
        if (!batch || !population->is_alive(*batch, handle))
            throw Failure(ErrorCode::kInvalidArgument, what, name_of(handle), " is not alive");
    }
}

void CrowdState::check_alive(uint32_t first_instance, uint32_t count, const char* what) const {
    check_range(first_instance, count, what);
    const uint32_t end = first_instance + count;
    for (uint32_t instance = first_instance; instance < end;) {
        const Batch* const batch = batch_at(batches, instance);
        if (!batch)
            throw Failure(ErrorCode::kInvalidArgument, what, "instance ", instance,
                          " is gone: its group has been removed");
        const Group& group = groups[batch->group];
        refuse_if_shaders_populate(group, what);
        const uint32_t end_of_part = std::min(end, batch->first_instance + batch->instance_count);
        if (!group.varies) instance = end_of_part;
        for (; instance < end_of_part; ++instance)
            if (!population->has_instance(instance))
                throw Failure(ErrorCode::kInvalidArgument, what, "instance ", instance,
                              " is not alive: it has not been spawned, or it has been despawned");
    }
}

const Batch& CrowdState::batch_of(uint32_t instance) const { return batches[batch_index_of(batches, instance)]; }

Instances CrowdState::instances(uint32_t group) const {
    group_at(group);
    uint32_t first = 0, count = 0;
    for (const Batch& batch : batches) {
        if (batch.group != group) continue;
        if (count == 0) first = batch.first_instance;
        count += batch.instance_count;
    }
    return Instances::numbered(first, count);
}

void CrowdState::set_playback(const Instances& instances, const Each<Playback>& playback) {
    check_alive(instances, "playback");
    control->set(instances, playback);
}

void CrowdState::set_placement(const Instances& instances, const Each<Affine>& world_from_model) {
    check_alive(instances, "placement");
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (!all_finite(world_from_model[i]))
            refuse(ErrorPlace("placement", instances.number(i)), "a number is not finite");
    placements->set(instances, world_from_model);
}

void CrowdState::set_look(const Instances& instances, const Each<InstanceLook>& look) {
    check_alive(instances, "look");
    if (!looks) throw Failure(ErrorCode::kInvalidArgument, "look", "no group has CrowdGroup::outfits");
    looks->set(instances, look);
}

void CrowdState::send(uint32_t instance, io::ControlCommand command) {
    const InBatch of = at(instance);
    command.instance = of.instance;
    controllers->add(of.batch, command);
}

// make_command(i, group, place) makes the i-th instance's command, or throws. All are made before the first is sent.
template <class MakeCommand>
void CrowdState::send_each(const Instances& instances, const char* what, const MakeCommand& make_command) {
    check_alive(instances, what);
    std::vector<io::ControlCommand> commands;
    commands.reserve(instances.size());
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const Group& group = group_of(instances.number(i));
        if (!group.controller) refuse(ErrorPlace(what, instances.number(i)), group.name + " has no controller");
        commands.push_back(make_command(i, group, ErrorPlace(what, instances.number(i))));
    }
    for (uint32_t i = 0; i < instances.size(); ++i) send(instances.number(i), commands[i]);
}

void CrowdState::attach(const Instances& instances, const Each<Attachment>& attachment) {
    check_alive(instances, "attachment");
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (!is_alive(attachment[i].carrier))
            refuse(ErrorPlace("attachment", instances.number(i)),
                   "its carrier, " + name_of(attachment[i].carrier) + ", is not alive");
    if (!attachments && instances.size() > 0)
        refuse(ErrorPlace("attachment", instances.number(0)), "no group has CrowdGroup::is_carried set");
    if (attachments) attachments->attach(instances, attachment);
}

void CrowdState::detach(const Instances& instances) {
    check_alive(instances, "attachment");
    if (attachments) attachments->detach(instances);
}

void CrowdState::play(const Instances& instances, uint32_t layer, const Each<LayerPlayback>& playback) {
    send_each(instances, "play", [&](uint32_t i, const Group& group, const ErrorPlace& place) {
        return play_command(group.controller->layer_kinds, group.clip_durations_s, layer, playback[i], place);
    });
}

void CrowdState::set_state(const Instances& instances, uint32_t layer, const Each<PlayedMotion>& state, float fade_s) {
    send_each(instances, "state", [&](uint32_t i, const Group& group, const ErrorPlace& place) {
        return state_command(group.controller->layer_kinds, layer, state[i], fade_s, place);
    });
}

void CrowdState::set_layer(const Instances& instances, uint32_t layer, const Each<LayerBlend>& blend) {
    send_each(instances, "layer", [&](uint32_t i, const Group& group, const ErrorPlace& place) {
        return layer_command(group.controller->layer_kinds, group.controller->mask_count, layer, blend[i], place);
    });
}

void CrowdState::set_parameter(const Instances& instances, uint32_t parameter, const Each<float>& value) {
    send_each(instances, "parameter", [&](uint32_t i, const Group& group, const ErrorPlace& place) {
        check_parameter(group.controller->parameter_count, parameter, value[i], place);
        return io::ControlCommand{.kind = io::kCommandParameter, .target = parameter, .value = value[i]};
    });
}

void CrowdState::set_target(const Instances& instances, uint32_t target, const Each<TargetPlace>& place) {
    check_alive(instances, "target");
    const auto target_count = [&](uint32_t instance) { return group_of(instance).procedural->target_count; };
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const ErrorPlace of_instance("target", instances.number(i));
        if (const Group& group = group_of(instances.number(i)); !group.procedural)
            refuse(of_instance, group.name + " has no procedural rules");
        check_target(target, target_count(instances.number(i)), place[i], of_instance);
    }
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const InBatch of = at(instances.number(i));
        const auto& [x, y, z] = place[i].world_place;
        procedural->set_target(of.batch, of.instance * target_count(instances.number(i)) + target,
                               {x, y, z, place[i].weight});
    }
}

void CrowdState::check_agents(const Instances& instances) const {
    check_alive(instances, "destination");
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (const Group& group = group_of(instances.number(i)); !group.steering)
            refuse(ErrorPlace("destination", instances.number(i)), group.name + " has no steering");
}

void CrowdState::set_destination(const Instances& instances, const Each<Vec3<float>>& world_place) {
    check_agents(instances);
    for (uint32_t i = 0; i < instances.size(); ++i)
        if (!all_finite(world_place[i]))
            refuse(ErrorPlace("destination", instances.number(i)), "a number is not finite");
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const auto& [x, y, z] = world_place[i];
        steer->set_destination(at(instances.number(i)), {x, y, z, 1});
    }
}

void CrowdState::clear_destination(const Instances& instances) {
    check_agents(instances);
    for (uint32_t i = 0; i < instances.size(); ++i) steer->set_destination(at(instances.number(i)), {});
}

void CrowdState::set_pose(const Instances& instances, std::span<const Trs<float>> parent_from_joint, float fade_s) {
    check_alive(instances, "pose");
    check_fade(fade_s, "pose");
    std::vector<InBatch> at_each;
    std::vector<std::vector<Trs<double>>> poses_of;
    // Several instances share one pose if there are as many transforms as the first instance has joints. Otherwise each
    // has its own.
    const bool is_shared = instances.size() > 1 &&
                           parent_from_joint.size() == group_of(instances.number(0)).joint_count;
    size_t next = 0;
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const Group& group = group_of(instances.number(i));
        const bool is_last = is_shared || i + 1 == instances.size();
        const size_t left = parent_from_joint.size() - next;
        const auto pose = parent_from_joint.subspan(next, is_last ? left : std::min<size_t>(left, group.joint_count));
        poses_of.push_back(
            checked_pose(pose, group.joint_count, group.uniform_scale, ErrorPlace("pose", instances.number(i))));
        at_each.push_back(at(instances.number(i)));
        if (!is_shared) next += pose.size();
    }
    poses->make_room(at_each);
    for (size_t i = 0; i < at_each.size(); ++i) poses->set(at_each[i], poses_of[i], fade_s);
}

void CrowdState::clear_pose(const Instances& instances, float fade_s) {
    check_alive(instances, "pose");
    check_fade(fade_s, "pose");
    for (uint32_t i = 0; i < instances.size(); ++i) poses->clear(at(instances.number(i)), fade_s);
}

}  // namespace throng
