// What the application changes: checked and kept, and taken up by the next update.
#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "control/control_reference.h"
#include "control/layer_commands.h"
#include "control/playback.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

bool blends(const io::InstancePlayback& playback) { return playback.weight > 0 && playback.weight < 1; }

}  // namespace

io::RootState standing_at(const Affine& world_from_model) {
    io::RootState root{.move = {0, 0, 1, 0}, .place = {0, 0, 1, 0}, .base = {}};
    std::memcpy(root.base, &world_from_model, sizeof root.base);
    return root;
}

void CrowdState::check_range(uint32_t first_instance, size_t count, const char* what) const {
    if (first_instance <= instance_count && count <= instance_count - first_instance) return;
    throw Failure(ErrorCode::kInvalidArgument, what,
                  "instances " + std::to_string(first_instance) + " to " + std::to_string(first_instance + count) +
                      " of a crowd of " + std::to_string(instance_count));
}

const Batch& CrowdState::batch_of(uint32_t instance) const {
    const auto after = std::upper_bound(batches.begin(), batches.end(), instance,
                                        [](uint32_t i, const Batch& batch) { return i < batch.first_instance; });
    return *std::prev(after);
}

void CrowdState::set_playback(uint32_t first_instance, std::span<const Playback> playback) {
    check_range(first_instance, playback.size(), "playback");
    std::vector<io::InstancePlayback> checked;
    checked.reserve(playback.size());
    for (uint32_t i = 0; i < playback.size(); ++i) {
        const Group& group = groups[batch_of(first_instance + i).group];
        const auto& durations_s = group.clip_durations_s;
        if (group.controller)
            throw Failure(ErrorCode::kInvalidArgument, "playback of instance " + std::to_string(first_instance + i),
                          "it has a controller: use play() or its parameters");
        const auto clip_count = static_cast<uint32_t>(durations_s.size());
        check_playback(playback[i], clip_count, "playback of instance " + std::to_string(first_instance + i));
        // Wrapped in double precision here, so that a late time costs no digits on the GPU.
        const auto slot = [&](const ClipPlayback& from) {
            if (from.clip == kNone) return io::SlotPlayback{.clip = clip_count, .loop = 0, .time_s = 0, .speed = 0};
            const double time_s = local_time_reference(from.time_s, durations_s[from.clip], from.loop);
            return io::SlotPlayback{.clip = from.clip,
                                    .loop = from.loop ? 1u : 0u,
                                    .time_s = static_cast<float>(time_s),
                                    .speed = from.speed};
        };
        checked.push_back({slot(playback[i].first), slot(playback[i].second), playback[i].weight});
    }
    count_blending(first_instance, checked);
    std::copy(checked.begin(), checked.end(), playbacks_.begin() + first_instance);
    dirty_playbacks_.add(first_instance, static_cast<uint32_t>(playback.size()));
}

void CrowdState::count_blending(uint32_t first_instance, std::span<const io::InstancePlayback> changed) {
    for (uint32_t i = 0; i < changed.size(); ++i) {
        const bool before = blends(playbacks_[first_instance + i]), after = blends(changed[i]);
        if (before != after)
            batches[static_cast<size_t>(&batch_of(first_instance + i) - batches.data())].blending_count += after ? 1u
                                                                                                                 : ~0u;
    }
}

void CrowdState::set_placement(uint32_t first_instance, std::span<const Affine> world_from_model) {
    check_range(first_instance, world_from_model.size(), "placement");
    for (size_t i = 0; i < world_from_model.size(); ++i)
        for (const auto& row : world_from_model[i].row)
            if (!std::all_of(row.begin(), row.end(), [](float f) { return std::isfinite(f); }))
                throw Failure(ErrorCode::kInvalidArgument,
                              "placement of instance " + std::to_string(first_instance + i), "a number is not finite");
    std::copy(world_from_model.begin(), world_from_model.end(), placements.begin() + first_instance);
    dirty_placements_.add(first_instance, static_cast<uint32_t>(world_from_model.size()));
}

const GroupController& CrowdState::controller_of(uint32_t instance, const char* what) const {
    check_range(instance, 1, what);
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
    check_range(instance, 1, "target");
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
    check_range(first_instance, world_places.size(), "destination");
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
    check_range(first_instance, count, "destination");
    for (uint32_t i = first_instance; i < first_instance + count; ++i) batch_of_agent(i);
    for (uint32_t i = first_instance; i < first_instance + count; ++i) {
        const Batch& batch = batch_of(i);
        steer->set_destination(index_of(batch), i - batch.first_instance, {});
    }
}

void CrowdState::set_pose(uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s) {
    check_range(instance, 1, "pose");
    const Batch& batch = batch_of(instance);
    poses->set(index_of(batch), instance - batch.first_instance, parent_from_joint, fade_s,
               "pose of instance " + std::to_string(instance));
}

void CrowdState::clear_pose(uint32_t instance, float fade_s) {
    check_range(instance, 1, "pose");
    const Batch& batch = batch_of(instance);
    poses->clear(index_of(batch), instance - batch.first_instance, fade_s,
                 "pose of instance " + std::to_string(instance));
}

void CrowdState::upload_changes(VkCommandBuffer commands) {
    const auto upload_ranges = [&](DirtyRanges& dirty, const auto& upload_part) {
        for (auto [first, count] : dirty.take()) {
            while (count > 0) {
                const Batch& batch = batch_of(first);
                const uint32_t n = std::min(count, batch.first_instance + batch.instance_count - first);
                upload_part(batch, first, n);
                first += n;
                count -= n;
            }
        }
    };
    upload_ranges(dirty_playbacks_, [&](const Batch& batch, uint32_t first, uint32_t count) {
        if (batch[io::kPlaybacksBuffer].handle())
            record_update(*gpu, commands, batch[io::kPlaybacksBuffer], first - batch.first_instance,
                          std::span<const io::InstancePlayback>(playbacks_).subspan(first, count));
    });
    upload_ranges(dirty_placements_, [&](const Batch& batch, uint32_t first, uint32_t count) {
        record_update(*gpu, commands, batch[io::kPlacementsBuffer], first - batch.first_instance,
                      std::span<const Affine>(placements).subspan(first, count));
        if (!batch[io::kRootsBuffer].handle()) return;
        std::vector<io::RootState> roots;
        for (uint32_t i = first; i < first + count; ++i) roots.push_back(standing_at(placements[i]));
        record_update(*gpu, commands, batch[io::kRootsBuffer], first - batch.first_instance,
                      std::span<const io::RootState>(roots));
    });
}

}  // namespace throng
