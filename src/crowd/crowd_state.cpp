#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "bind/skin_format.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "blend/posed_io.h"
#include "control/control.h"
#include "control/control_reference.h"
#include "control/layer_commands.h"
#include "control/playback.h"
#include "cull/cull_io.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace throng {
namespace {

constexpr uint64_t kMatrix_bytes = sizeof(Affine);
constexpr uint64_t kMorphs_bytes = io::kActiveMorphs * sizeof(io::ActiveMorph);

bool blends(const io::InstancePlayback& playback) { return playback.weight > 0 && playback.weight < 1; }

// Nothing has moved yet.
io::RootState standing_at(const Affine& world_from_model) {
    io::RootState root{.move = {0, 0, 1, 0}, .place = {0, 0, 1, 0}, .base = {}};
    std::memcpy(root.base, &world_from_model, sizeof root.base);
    return root;
}

}  // namespace

CrowdState::CrowdState(std::shared_ptr<Gpu> gpu_in, const CrowdSettings& settings)
    : gpu(std::move(gpu_in)), skin_format(settings.skin_format), skin_blend(settings.skin_blend), control_(control_kernel(gpu)) {
    uint64_t total = 0;
    for (const CrowdGroup& group : settings.groups) {
        if (!group.character) throw Failure(ErrorCode::kInvalidArgument, "crowd", "a group has no character");
        total += group.instance_count;
    }
    if (total == 0) throw Failure(ErrorCode::kInvalidArgument, "crowd", "it has no instances");
    if (total > UINT32_MAX) throw Failure(ErrorCode::kLimit, "crowd", std::to_string(total) + " instances; at most 4,294,967,295");

    check_memory(settings);

    groups.reserve(settings.groups.size());
    for (const CrowdGroup& group : settings.groups) {
        if (const std::string obstacle = skin_format_obstacle(skin_format, *group.character); !obstacle.empty())
            throw Failure(ErrorCode::kUnsupported, group.character->name + ": skin format", obstacle);
        check_steering(group);
        if (const std::string obstacle = skin_blend_obstacle(skin_blend, *group.character); !obstacle.empty())
            throw Failure(ErrorCode::kUnsupported, group.character->name + ": skin blend", obstacle);
        groups.emplace_back(gpu, group, choose_path(*gpu, settings, group), settings);
        make_batches(static_cast<uint32_t>(groups.size() - 1), settings);
        const auto rest = static_cast<uint32_t>(group.character->clips.size());
        const io::SlotPlayback rest_slot{.clip = rest, .loop = 0, .time_s = 0, .speed = 0};
        playbacks_.insert(playbacks_.end(), group.instance_count, {rest_slot, rest_slot, 1});
    }
    for (Batch& batch : batches) {
        const Group& group = groups[batch.group];
        if (!group.controller) batch.control = control_.bind(ControlBuffers{batch.playbacks, group.axes, group.times, batch.cursors});
    }
    if (settings.culls) cull.emplace(gpu, groups, batches, settings);
    procedural.emplace(gpu, groups, batches);
    fused.emplace(gpu, groups, batches, settings);
    pace.emplace(gpu, groups, batches, settings);
    staged.emplace(gpu, groups, batches, skin_format, *procedural);
    make_feedback(settings);
    controllers.emplace(gpu, groups, batches, feedback ? &*feedback : nullptr);
    steer.emplace(gpu, groups, batches);
    poses.emplace(gpu, groups, batches);
    morphs.emplace(gpu, groups, batches);
    if (settings.skins_once) skin.emplace(gpu, groups, batches, cull ? &*cull : nullptr, settings);
    placements.resize(instance_count);
    dirty_playbacks_.add(0, instance_count);
    dirty_placements_.add(0, instance_count);
    if (settings.timestamps && gpu->has_timestamps()) timer = std::make_unique<StageTimer>(gpu, 12 + 5 * staged->wave_count());  // control, steer, cull, morph, fused, pace, skin, the four of them that record_disoccluded() has and what comes before it, and five stages a wave
}

// Refuses at once what cannot fit, before gigabytes are allocated on the way to failing.
void CrowdState::check_memory(const CrowdSettings& settings) const {
    uint64_t needed_bytes = 0;
    for (const CrowdGroup& group : settings.groups) {
        const uint64_t matrices = 1 + (settings.keep_model_matrices ? group.character->rig.joint_count() : 0);
        const uint64_t morph_bytes = group.character->morphs.empty() ? 0 : kMorphs_bytes;
        const uint64_t skin_bytes = group.character->palette.size() * uint64_t{skin_format_bytes(skin_format)} * (1 + (settings.keep_previous_matrices ? 1 : 0) + (settings.culls && settings.skips_updates ? 1 : 0));
        const uint64_t skinned_bytes = settings.skins_once ? group.character->vertices.size() * sizeof(SkinnedVertex) : 0;
        needed_bytes += group.instance_count * (matrices * kMatrix_bytes + skin_bytes + skinned_bytes + morph_bytes + sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor));
        needed_bytes += std::min(group.pose_capacity, group.instance_count) * uint64_t{group.character->rig.joint_count()} * sizeof(io::JointPose);
    }
    if (needed_bytes > gpu->largest_heap_bytes())
        throw Failure(ErrorCode::kLimit, "crowd", std::to_string(needed_bytes >> 20) + " MiB of matrices and state exceed the device's memory of " + std::to_string(gpu->largest_heap_bytes() >> 20) + " MiB");
}

// As few batches as the device's limits allow, of nearly equal size.
void CrowdState::make_batches(uint32_t group_index, const CrowdSettings& settings) {
    const Group& group = groups[group_index];
    const uint32_t count = settings.groups[group_index].instance_count;
    const uint64_t joint_bytes = std::max(group.controller && group.controller->is_inertial ? sizeof(io::InertiaState) : kMatrix_bytes,
                                          group.controller ? group.controller->model_layer_count * sizeof(io::ModelRotations) : 0);
    const uint64_t spring_bytes = group.procedural ? group.procedural->spring_count * sizeof(io::SpringState) : 0;
    const uint64_t skinned_bytes = settings.skins_once ? group.vertex_count * sizeof(SkinnedVertex) : 0;
    const uint64_t target_bytes = group.procedural ? group.procedural->target_count * sizeof(io::vec4) : 0;
    const uint64_t instance_bytes = std::max({group.joint_count * joint_bytes, group.palette_count * kMatrix_bytes, spring_bytes, target_bytes, skinned_bytes, group.morphs ? kMorphs_bytes : 0});
    const uint64_t capacity = std::min<uint64_t>(arena_limit_bytes(*gpu) / instance_bytes, gpu->properties.limits.maxComputeWorkGroupCount[0]);
    if (capacity == 0)
        throw Failure(ErrorCode::kLimit, group.name, "what one instance takes (" + std::to_string(instance_bytes) +
                                                         " bytes) exceed the device's storage-buffer range of " + std::to_string(arena_limit_bytes(*gpu)));
    const uint64_t batch_count = (count + capacity - 1) / capacity;
    for (uint64_t i = 0; i < batch_count; ++i) {
        const auto first = static_cast<uint32_t>(count * i / batch_count), end = static_cast<uint32_t>(count * (i + 1) / batch_count);
        const uint64_t n = end - first;
        Batch batch;
        batch.group = group_index;
        batch.first_instance = instance_count + first;
        batch.instance_count = end - first;
        const auto storage = [&](const char* what, uint64_t size_bytes) { return Buffer(gpu, group.name + ": " + what, size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT); };
        if (group.controller) {
            make_layers(batch);
        } else {
            batch.playbacks = storage("playback states", n * sizeof(io::InstancePlayback));
            batch.cursors = storage("cursors", n * sizeof(io::InstanceCursor));
        }
        if (group.procedural) make_procedural_state(batch);
        if (group.steering) {
            batch.destinations = upload(gpu, group.name + ": destinations", std::vector<io::vec4>(n));
            batch.agents = upload(gpu, group.name + ": agents", std::vector<io::AgentState>(n, {.speed = 0, .patience = 1, .stands = 0}));
        }
        if (settings.culls) make_list(gpu, group, batch);
        batch.placements = make_table<Affine>(gpu, group.name + ": placements", n);
        for (size_t k = 0; k < (settings.keep_previous_matrices ? 2 : 1); ++k)
            batch.skins[k] = storage("skin matrices", n * std::max(group.palette_count, 1u) * skin_format_bytes(skin_format));
        if (settings.culls && settings.skips_updates && group.animates_drawn_only()) batch.ahead = storage("skin matrices ahead", batch.skins[0].size_bytes());
        if (settings.skins_once) batch.skinned = storage("skinned vertices", n * std::max(group.vertex_count, 1u) * sizeof(SkinnedVertex));
        if (group.morphs) batch.morphs = storage("active morphs", n * kMorphs_bytes);
        if (group.morphs && group.controller) batch.voice_times = storage("times of voices", n * group.controller->voice_limit * sizeof(float));
        if (group.sockets) batch.sockets = storage("sockets", n * group.socket_count() * kMatrix_bytes);
        if (group.pose_capacity > 0) batch.posed = upload_table(gpu, group.name + ": instances with a pose set", as_words(std::vector<io::InstancePose>(n)));
        if (settings.keep_model_matrices) batch.kept_model = storage("model matrices", n * group.joint_count * kMatrix_bytes);
        outputs.push_back({.group = group_index,
                           .first_instance = batch.first_instance,
                           .instance_count = batch.instance_count,
                           .palette_count = group.palette_count,
                           .joint_count = group.joint_count,
                           .skin_buffer = batch.skins[0].handle(),
                           .previous_skin_buffer = batch.skins[1].handle(),
                           .model_buffer = batch.kept_model.handle(),
                           .placement_buffer = batch.placements.handle(),
                           .socket_count = group.socket_count(),
                           .socket_buffer = batch.sockets.handle(),
                           .parameter_count = group.controller ? group.controller->parameter_count : 0,
                           .parameter_buffer = batch.parameters.handle(),
                           .root_buffer = batch.roots.handle(),
                           .target_count = group.procedural ? group.procedural->target_count : 0,
                           .target_buffer = batch.targets.handle(),
                           .destination_buffer = batch.destinations.handle(),
                           .morph_buffer = batch.morphs.handle(),
                           .list_buffer = batch.list.handle(),
                           .draw_buffer = batch.draws.handle(),
                           .vertex_count = group.vertex_count,
                           .skinned_buffer = batch.skinned.handle()});
        batches.push_back(std::move(batch));
    }
    instance_count += count;
}

void CrowdState::make_feedback(const CrowdSettings& settings) {
    watch_capacity_ = settings.watch_capacity;
    bool any = false;
    uint64_t most_sockets = 0;
    for (const Group& group : groups) {
        any = any || group.controller || group.sockets || group.steering;
        most_sockets = std::max<uint64_t>(most_sockets, group.socket_count());
    }
    if (any) feedback.emplace(gpu, settings.event_capacity, watch_capacity_ * (kWatchedInstance_bytes + most_sockets * kMatrix_bytes));
}

void CrowdState::watch(std::span<const uint32_t> instances) {
    if (!feedback) throw Failure(ErrorCode::kInvalidArgument, "watch", "no group has a controller, sockets or steering: there is no feedback");
    if (instances.size() > watch_capacity_)
        throw Failure(ErrorCode::kLimit, "watch", std::to_string(instances.size()) + " instances; CrowdSettings::watch_capacity is " + std::to_string(watch_capacity_));
    std::vector<Watched> watched;
    for (const uint32_t instance : instances) {
        check_range(instance, 1, "watch");
        const Batch& batch = batch_of(instance);
        const auto part = [&](const Buffer& buffer, uint64_t stride_bytes, uint64_t size_bytes) {
            return buffer.handle() ? BufferRange(buffer.handle(), (instance - batch.first_instance) * stride_bytes, size_bytes) : BufferRange();
        };
        const uint64_t socket_bytes = groups[batch.group].socket_count() * kMatrix_bytes;
        watched.push_back({.instance = instance,
                           .placement = part(batch.placements, kMatrix_bytes, kMatrix_bytes),
                           .move = part(batch.roots, sizeof(io::RootState), sizeof(io::RootState::move)),
                           .sockets = part(batch.sockets, socket_bytes, socket_bytes)});
    }
    watched_ = std::move(watched);
}

std::vector<Feedback> CrowdState::take_feedback() { return feedback ? feedback->take() : std::vector<Feedback>(); }

// As its instances begin.
void CrowdState::make_layers(Batch& batch) const {
    const Group& group = groups[batch.group];
    const GroupController& controller = *group.controller;
    const auto repeated = [&](const auto& one) {
        std::remove_cvref_t<decltype(one)> all;
        for (uint32_t i = 0; i < batch.instance_count; ++i) all.insert(all.end(), one.begin(), one.end());
        return all;
    };
    static_assert(sizeof(io::LayerState) == io::kLayerStateWords * sizeof(uint32_t) && sizeof(io::LayerPlay) == io::kLayerPlayWords * sizeof(uint32_t));
    batch.layers = upload_writable_table(gpu, group.name + ": layers", as_words(repeated(controller.initial_layers)));
    batch.parameters = upload_writable_table(gpu, group.name + ": parameters", as_words(repeated(controller.initial_parameters)));
    batch.voices = make_table<io::Voice>(gpu, group.name + ": voices", batch.instance_count * uint64_t{controller.voice_limit});
    if (controller.is_inertial) {
        batch.inertias = upload(gpu, group.name + ": inertial transitions", std::vector<io::InstanceInertia>(batch.instance_count));
        batch.inertia_states = Buffer(gpu, group.name + ": poses of inertial transitions", batch.instance_count * uint64_t{group.joint_count} * sizeof(io::InertiaState), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    }
    if (controller.model_layer_count > 0)
        batch.rotations = Buffer(gpu, group.name + ": rotations in model space", batch.instance_count * uint64_t{group.joint_count} * controller.model_layer_count * sizeof(io::ModelRotations), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    if (group.has_root_motion()) batch.roots = upload(gpu, group.name + ": root motion", std::vector<io::RootState>(batch.instance_count, standing_at(Affine{})));
}

// At rest, and without aims.
void CrowdState::make_procedural_state(Batch& batch) const {
    const Group& group = groups[batch.group];
    if (group.procedural->target_count > 0) batch.targets = upload(gpu, group.name + ": targets", std::vector<io::vec4>(batch.instance_count * size_t{group.procedural->target_count}));
    if (group.procedural->spring_count > 0) batch.springs = upload(gpu, group.name + ": springs", std::vector<io::SpringState>(batch.instance_count * size_t{group.procedural->spring_count}));
}

void CrowdState::check_range(uint32_t first_instance, size_t count, const char* what) const {
    if (first_instance <= instance_count && count <= instance_count - first_instance) return;
    throw Failure(ErrorCode::kInvalidArgument, what, "instances " + std::to_string(first_instance) + " to " + std::to_string(first_instance + count) +
                                                         " of a crowd of " + std::to_string(instance_count));
}

const Batch& CrowdState::batch_of(uint32_t instance) const {
    const auto after = std::upper_bound(batches.begin(), batches.end(), instance, [](uint32_t i, const Batch& batch) { return i < batch.first_instance; });
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
            throw Failure(ErrorCode::kInvalidArgument, "playback of instance " + std::to_string(first_instance + i), "it has a controller: use play() or its parameters");
        const auto clip_count = static_cast<uint32_t>(durations_s.size());
        check_playback(playback[i], clip_count, "playback of instance " + std::to_string(first_instance + i));
        // Wrapped in double precision here, so that a late time costs no digits on the GPU.
        const auto slot = [&](const ClipPlayback& from) {
            if (from.clip == kNone) return io::SlotPlayback{.clip = clip_count, .loop = 0, .time_s = 0, .speed = 0};
            const double time_s = local_time_reference(from.time_s, durations_s[from.clip], from.loop);
            return io::SlotPlayback{.clip = from.clip, .loop = from.loop ? 1u : 0u, .time_s = static_cast<float>(time_s), .speed = from.speed};
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
        if (before != after) batches[static_cast<size_t>(&batch_of(first_instance + i) - batches.data())].blending_count += after ? 1u : ~0u;
    }
}

void CrowdState::set_placement(uint32_t first_instance, std::span<const Affine> world_from_model) {
    check_range(first_instance, world_from_model.size(), "placement");
    for (size_t i = 0; i < world_from_model.size(); ++i)
        for (const auto& row : world_from_model[i].row)
            if (!std::all_of(row.begin(), row.end(), [](float f) { return std::isfinite(f); }))
                throw Failure(ErrorCode::kInvalidArgument, "placement of instance " + std::to_string(first_instance + i), "a number is not finite");
    std::copy(world_from_model.begin(), world_from_model.end(), placements.begin() + first_instance);
    dirty_placements_.add(first_instance, static_cast<uint32_t>(world_from_model.size()));
}

const GroupController& CrowdState::controller_of(uint32_t instance, const char* what) const {
    check_range(instance, 1, what);
    const Group& group = groups[batch_of(instance).group];
    if (!group.controller) throw Failure(ErrorCode::kInvalidArgument, std::string(what) + " of instance " + std::to_string(instance), group.name + " has no controller");
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
    send(instance, play_command(controller.layer_kinds, durations_s, layer, playback, "play of instance " + std::to_string(instance)));
}

void CrowdState::set_layer(uint32_t instance, uint32_t layer, const LayerBlend& blend) {
    const GroupController& controller = controller_of(instance, "layer");
    send(instance, layer_command(controller.layer_kinds, controller.mask_count, layer, blend, "layer of instance " + std::to_string(instance)));
}

void CrowdState::set_parameters(uint32_t instance, uint32_t parameter, std::span<const float> values) {
    const GroupController& controller = controller_of(instance, "parameter");
    const std::string place = "parameter of instance " + std::to_string(instance);
    check_parameters(controller.parameter_count, parameter, values, place);
    for (uint32_t i = 0; i < values.size(); ++i) send(instance, {.kind = io::kCommandParameter, .target = parameter + i, .value = values[i]});
}

void CrowdState::set_target(uint32_t instance, uint32_t target, const Vec3<float>& world_place, float weight) {
    check_range(instance, 1, "target");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    const uint32_t count = group.procedural ? group.procedural->target_count : 0;
    check_target(target, count, world_place, weight, "target of instance " + std::to_string(instance));
    procedural->set_target(index_of(batch), (instance - batch.first_instance) * count + target, {world_place.x, world_place.y, world_place.z, weight});
}

const Batch& CrowdState::batch_of_agent(uint32_t instance) const {
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (!group.steering) throw Failure(ErrorCode::kInvalidArgument, "destination of instance " + std::to_string(instance), group.name + " has no steering");
    return batch;
}

void CrowdState::set_destination(uint32_t first_instance, std::span<const Vec3<float>> world_places) {
    check_range(first_instance, world_places.size(), "destination");
    for (uint32_t i = 0; i < world_places.size(); ++i) {
        batch_of_agent(first_instance + i);
        if (!std::isfinite(world_places[i].x) || !std::isfinite(world_places[i].y) || !std::isfinite(world_places[i].z))
            throw Failure(ErrorCode::kInvalidArgument, "destination of instance " + std::to_string(first_instance + i), "a number is not finite");
    }
    for (uint32_t i = 0; i < world_places.size(); ++i) {
        const Batch& batch = batch_of(first_instance + i);
        steer->set_destination(index_of(batch), first_instance + i - batch.first_instance, {world_places[i].x, world_places[i].y, world_places[i].z, 1});
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
    poses->set(index_of(batch), instance - batch.first_instance, parent_from_joint, fade_s, "pose of instance " + std::to_string(instance));
}

void CrowdState::clear_pose(uint32_t instance, float fade_s) {
    check_range(instance, 1, "pose");
    const Batch& batch = batch_of(instance);
    poses->clear(index_of(batch), instance - batch.first_instance, fade_s, "pose of instance " + std::to_string(instance));
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
        if (batch.playbacks.handle()) record_update(*gpu, commands, batch.playbacks, first - batch.first_instance, std::span<const io::InstancePlayback>(playbacks_).subspan(first, count));
    });
    upload_ranges(dirty_placements_, [&](const Batch& batch, uint32_t first, uint32_t count) {
        record_update(*gpu, commands, batch.placements, first - batch.first_instance, std::span<const Affine>(placements).subspan(first, count));
        if (!batch.roots.handle()) return;
        std::vector<io::RootState> roots;
        for (uint32_t i = first; i < first + count; ++i) roots.push_back(standing_at(placements[i]));
        record_update(*gpu, commands, batch.roots, first - batch.first_instance, std::span<const io::RootState>(roots));
    });
}

void CrowdState::record(VkCommandBuffer commands, float time_step_s, const CrowdView* view) {
    if (view && !cull) throw Failure(ErrorCode::kInvalidArgument, "view", "CrowdSettings::culls is not set");
    if (!std::isfinite(time_step_s)) throw Failure(ErrorCode::kInvalidArgument, "time step", "must be finite");
    const io::CullView seen = cull_view_of(view, paced_full_rate_pixels(view));
    constexpr Access kConsumers = kShaderRead | kVertexRead | kTransferRead | kIndirectRead;
    // Whoever reads the last update's results must be done.
    memory_barrier(*gpu, commands, kConsumers | kShaderWrite | kTransferWrite, kShaderRead | kShaderWrite | kTransferWrite);
    if (feedback) feedback->begin(commands);  // before anything is taken up, since it may refuse
    upload_changes(commands);
    if (cull) cull->record_view(commands, seen);
    for (Batch& batch : batches) batch.blends = batch.blending_count > 0;
    procedural->begin_update(commands, time_step_s);
    steer->begin_update(commands);
    controllers->record_commands(commands);
    poses->record(commands, time_step_s);
    take_turns();
    memory_barrier(*gpu, commands, kTransferWrite, kShaderRead | kShaderWrite | kVertexRead);
    if (timer) timer->begin(commands);
    record_control(commands, time_step_s);
    steer->record(commands, time_step_s, timer.get());
    if (cull) cull->record(commands, timer.get());
    morphs->record(commands, timer.get());
    fused->record(commands, timer.get());
    pace->record(commands, timer.get());
    staged->record(commands, timer.get());
    if (skin) skin->record(commands, timer.get());
    if (feedback) feedback->end(commands, watched_);
    if (!has_updated_) copy_to_previous(commands);
    has_updated_ = true;
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kConsumers);
}

void CrowdState::record_disoccluded(VkCommandBuffer commands, const DepthImage& depths) {
    if (!cull) throw Failure(ErrorCode::kInvalidArgument, "disoccluded", "CrowdSettings::culls is not set");
    constexpr Access kConsumers = kShaderRead | kVertexRead | kTransferRead | kIndirectRead;
    memory_barrier(*gpu, commands, kConsumers, kShaderWrite);  // what was listed has been drawn
    cull->record_disoccluded(commands, depths, timer.get());
    fused->record_listed(commands, timer.get());
    pace->record(commands, timer.get());
    if (skin) skin->record_animated(commands, timer.get());
    memory_barrier(*gpu, commands, kShaderWrite, kConsumers);
}

// Raised by what the last update took more than the budget, at most by half, and lowered more slowly, so that it settles.
float CrowdState::paced_full_rate_pixels(const CrowdView* view) {
    if (!view) return 0;
    if (!(view->budget_ms > 0) || !timer) return view->full_rate_pixels;
    constexpr float kSlack = 0.9f, kMost = 1e6f;
    if (const std::optional<StageTimes> times = timer->take_newest()) {
        const auto load = static_cast<float>(times->total()) / view->budget_ms;
        pace_ = std::clamp(load > 1 ? pace_ * std::min(load, 1.5f) : load < kSlack ? pace_ * 0.95f : pace_, 1.0f, kMost);
    }
    return pace_ > 1 ? std::max(view->full_rate_pixels, 1.0f) * pace_ : view->full_rate_pixels;
}

// What was current becomes previous.
void CrowdState::take_turns() {
    for (size_t i = 0; i < batches.size(); ++i) {
        if (!batches[i].skins[1].handle()) continue;
        batches[i].current_skin ^= 1;
        std::swap(outputs[i].skin_buffer, outputs[i].previous_skin_buffer);
    }
}

// The first update has none before it: nothing has moved.
void CrowdState::copy_to_previous(VkCommandBuffer commands) const {
    memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kTransferRead | kTransferWrite);
    for (const Batch& batch : batches) {
        const Buffer& previous = batch.skins[1 - batch.current_skin];
        if (!previous.handle()) continue;
        const VkBufferCopy copy{0, 0, previous.size_bytes()};
        gpu->vk.vkCmdCopyBuffer(commands, batch.skin().handle(), previous.handle(), 1, &copy);
    }
}

void CrowdState::record_control(VkCommandBuffer commands, float time_step_s) {
    controllers->record(commands, time_step_s);
    for (const Batch& batch : batches)
        if (batch.playbacks.handle()) control_.dispatch_invocations(commands, batch.control, io::ControlPush{batch.instance_count, groups[batch.group].joint_count, time_step_s}, batch.instance_count);
    memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
    if (timer) timer->end_stage(commands, &StageTimes::control);
}

std::vector<Affine> CrowdState::read_matrices(uint32_t instance, bool model) const {
    check_range(instance, 1, "read-back");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (model && !batch.kept_model.handle())
        throw Failure(ErrorCode::kInvalidArgument, "read-back", "model matrices are kept only with CrowdSettings::keep_model_matrices");
    const uint64_t size_bytes = model ? group.joint_count * kMatrix_bytes : uint64_t{group.palette_count} * skin_format_bytes(skin_format);
    const BufferRange range(model ? batch.kept_model.handle() : batch.skin().handle(), (instance - batch.first_instance) * size_bytes, size_bytes);
    return unpack_skin(model ? SkinFormat::kAffine : skin_format, download<std::byte>(gpu, range));
}

std::vector<Vec3<float>> CrowdState::read_positions(uint32_t instance) {
    check_range(instance, 1, "read-back");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (group.vertex_count == 0) return {};
    if (!skin_kernel_) skin_kernel_ = skin_kernel(gpu, skin_format, skin_blend, false);
    const Buffer skinned(gpu, group.name + ": skinned vertices", group.vertex_count * sizeof(SkinnedVertex), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const Bindings bindings = skin_kernel_->bind(skin_buffers(group, batch, batch.skin(), skinned, group.vertices));
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite, kShaderRead);
        io::SkinPush push = skin_push(group);
        push.first_instance = instance - batch.first_instance;
        push.influence_offset = joint_set_of(batch, push.first_instance) * group.influence_count;
        skin_kernel_->dispatch_workgroups(commands, bindings, push, 1);
    });
    std::vector<Vec3<float>> positions;
    for (const SkinnedVertex& vertex : download<SkinnedVertex>(gpu, skinned)) positions.push_back(vertex.position);
    return positions;
}

// Of joints that an instance's skin matrices are of; those of the finest, where it has not been drawn.
uint32_t CrowdState::joint_set_of(const Batch& batch, uint32_t instance) const {
    return batch.states.handle() ? download<uint32_t>(gpu, BufferRange(batch.states.handle(), instance * sizeof(uint32_t), sizeof(uint32_t)))[0] >> io::kStateSetShift : 0;
}

std::vector<DrawnInstance> CrowdState::read_drawn() const {
    if (!cull) throw Failure(ErrorCode::kInvalidArgument, "read-back", "CrowdSettings::culls is not set");
    std::vector<DrawnInstance> drawn;
    for (uint32_t batch = 0; batch < batches.size(); ++batch) {
        const std::vector<DrawnInstance> of_batch = cull->read(batch);
        drawn.insert(drawn.end(), of_batch.begin(), of_batch.end());
    }
    return drawn;
}

uint64_t CrowdState::size_bytes() const {
    uint64_t sum = staged->size_bytes() + controllers->size_bytes() + steer->size_bytes() + (feedback ? feedback->size_bytes() : 0) + (cull ? cull->size_bytes() : 0);
    for (const Group& group : groups) sum += group.size_bytes();
    for (const Batch& batch : batches)
        for (const Buffer* buffer : {&batch.playbacks, &batch.cursors, &batch.layers, &batch.parameters, &batch.voices, &batch.roots, &batch.voice_times, &batch.morphs, &batch.inertias, &batch.inertia_states, &batch.rotations, &batch.targets, &batch.springs, &batch.destinations, &batch.agents, &batch.sockets, &batch.posed, &batch.list, &batch.work, &batch.states, &batch.dispatches, &batch.draws, &batch.ahead, &batch.skinned, &batch.placements, &batch.skins[0], &batch.skins[1], &batch.kept_model}) sum += buffer->size_bytes();
    return sum;
}

}  // namespace throng
