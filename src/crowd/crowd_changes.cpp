// What the application changes: checked and kept, and taken up by the next update.
#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "control/layer_commands.h"

#include <algorithm>
#include <cmath>

namespace throng {

void CrowdState::check_range(uint32_t first_instance, size_t count, const char* what) const {
    if (first_instance <= instance_count && count <= instance_count - first_instance) return;
    throw Failure(ErrorCode::kInvalidArgument, what,
                  "instances " + std::to_string(first_instance) + " to " + std::to_string(first_instance + count) +
                      " of a crowd of " + std::to_string(instance_count));
}

// Of a call that names instances.
void CrowdState::check_there(uint32_t first_instance, size_t count, const char* what) const {
    check_range(first_instance, count, what);
    for (uint32_t i = first_instance; population && i < first_instance + count; ++i)
        if (!population->is_alive(i))
            throw Failure(ErrorCode::kInvalidArgument, what,
                          "instance " + std::to_string(i) + " is not there: it has not been spawned, or has gone");
}

const Batch& CrowdState::batch_of(uint32_t instance) const { return batches[batch_index_of(batches, instance)]; }

void CrowdState::set_playback(uint32_t first_instance, std::span<const Playback> playback) {
    check_there(first_instance, playback.size(), "playback");
    control->set(first_instance, playback);
}

void CrowdState::set_placement(uint32_t first_instance, std::span<const Affine> world_from_model) {
    check_there(first_instance, world_from_model.size(), "placement");
    PlacementStage::check(world_from_model, "placement of instance ", first_instance);
    placements->set(first_instance, world_from_model);
}

const GroupController& CrowdState::controller_of(uint32_t instance, const char* what) const {
    check_there(instance, 1, what);
    const Group& group = groups[batch_of(instance).group];
    if (!group.controller)
        throw Failure(ErrorCode::kInvalidArgument, std::string(what) + " of instance " + std::to_string(instance),
                      group.name + " has no controller");
    return *group.controller;
}

void CrowdState::send(uint32_t instance, io::ControlCommand command) {
    const Batch& batch = batch_of(instance);
    command.instance = instance - batch.first_instance;
    controllers->add(static_cast<uint32_t>(&batch - batches.data()), command);
}

void CrowdState::play(uint32_t instance, uint32_t layer, const LayerPlayback& playback) {
    const GroupController& controller = controller_of(instance, "play");
    const auto& durations_s = groups[batch_of(instance).group].clip_durations_s;
    send(instance, play_command(controller.layer_kinds, durations_s, layer, playback,
                                "play of instance " + std::to_string(instance)));
}

void CrowdState::set_layer(uint32_t instance, uint32_t layer, const LayerBlend& blend) {
    const GroupController& controller = controller_of(instance, "layer");
    send(instance, layer_command(controller.layer_kinds, controller.mask_count, layer, blend,
                                 "layer of instance " + std::to_string(instance)));
}

void CrowdState::set_parameters(uint32_t instance, uint32_t parameter, std::span<const float> values) {
    const GroupController& controller = controller_of(instance, "parameter");
    const std::string place = "parameter of instance " + std::to_string(instance);
    check_parameters(controller.parameter_count, parameter, values, place);
    for (uint32_t i = 0; i < values.size(); ++i)
        send(instance, {.kind = io::kCommandParameter, .target = parameter + i, .value = values[i]});
}

void CrowdState::set_target(uint32_t instance, uint32_t target, const Vec3<float>& world_place, float weight) {
    check_there(instance, 1, "target");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    const uint32_t count = group.procedural ? group.procedural->target_count : 0;
    check_target(target, count, world_place, weight, "target of instance " + std::to_string(instance));
    procedural->set_target(index_of(batch), (instance - batch.first_instance) * count + target,
                           {world_place.x, world_place.y, world_place.z, weight});
}

const Batch& CrowdState::batch_of_agent(uint32_t instance) const {
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (!group.steering)
        throw Failure(ErrorCode::kInvalidArgument, "destination of instance " + std::to_string(instance),
                      group.name + " has no steering");
    return batch;
}

void CrowdState::set_destination(uint32_t first_instance, std::span<const Vec3<float>> world_places) {
    check_there(first_instance, world_places.size(), "destination");
    for (uint32_t i = 0; i < world_places.size(); ++i) {
        batch_of_agent(first_instance + i);
        if (!std::isfinite(world_places[i].x) || !std::isfinite(world_places[i].y) || !std::isfinite(world_places[i].z))
            throw Failure(ErrorCode::kInvalidArgument, "destination of instance " + std::to_string(first_instance + i),
                          "a number is not finite");
    }
    for (uint32_t i = 0; i < world_places.size(); ++i) {
        const Batch& batch = batch_of(first_instance + i);
        steer->set_destination(index_of(batch), first_instance + i - batch.first_instance,
                               {world_places[i].x, world_places[i].y, world_places[i].z, 1});
    }
}

void CrowdState::clear_destination(uint32_t first_instance, uint32_t count) {
    check_there(first_instance, count, "destination");
    for (uint32_t i = first_instance; i < first_instance + count; ++i) batch_of_agent(i);
    for (uint32_t i = first_instance; i < first_instance + count; ++i) {
        const Batch& batch = batch_of(i);
        steer->set_destination(index_of(batch), i - batch.first_instance, {});
    }
}

void CrowdState::set_pose(uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s) {
    check_there(instance, 1, "pose");
    const Batch& batch = batch_of(instance);
    poses->set(index_of(batch), instance - batch.first_instance, parent_from_joint, fade_s,
               "pose of instance " + std::to_string(instance));
}

void CrowdState::clear_pose(uint32_t instance, float fade_s) {
    check_there(instance, 1, "pose");
    const Batch& batch = batch_of(instance);
    poses->clear(index_of(batch), instance - batch.first_instance, fade_s,
                 "pose of instance " + std::to_string(instance));
}

}  // namespace throng
