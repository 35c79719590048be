// The making of a crowd: what it takes, and the buffers of its batches.
#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "blend/posed_io.h"

#include <algorithm>

namespace throng {
namespace {

constexpr uint64_t kMatrix_bytes = sizeof(Affine);
constexpr uint64_t kMorphs_bytes = io::kActiveMorphs * sizeof(io::ActiveMorph);

}  // namespace

// Refuses at once what cannot fit, before gigabytes are allocated on the way to failing.
void CrowdState::check_memory(const CrowdSettings& settings) const {
    uint64_t needed_bytes = 0;
    for (const CrowdGroup& group : settings.groups) {
        const uint64_t matrices = 1 + (settings.keep_model_matrices ? group.character->rig.joint_count() : 0);
        const uint64_t morph_bytes = group.character->morphs.empty() ? 0 : kMorphs_bytes;
        const uint64_t skin_bytes = group.character->palette.size() * uint64_t{skin_format_bytes(skin_format)} *
                                    (1 + (settings.keep_previous_matrices ? 1 : 0) +
                                     (settings.culls && settings.skips_updates ? 1 : 0));
        const uint64_t skinned_bytes = settings.skins_once ? group.character->vertices.size() * sizeof(SkinnedVertex)
                                                           : 0;
        needed_bytes += group.instance_count * (matrices * kMatrix_bytes + skin_bytes + skinned_bytes + morph_bytes +
                                                sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor));
        needed_bytes += std::min(group.pose_capacity, group.instance_count) *
                        uint64_t{group.character->rig.joint_count()} * sizeof(io::JointPose);
    }
    if (needed_bytes > gpu->largest_heap_bytes())
        throw Failure(ErrorCode::kLimit, "crowd",
                      std::to_string(needed_bytes >> 20) + " MiB of matrices and state exceed the device's memory of " +
                          std::to_string(gpu->largest_heap_bytes() >> 20) + " MiB");
}

// As few batches as the device's limits allow, of nearly equal size.
void CrowdState::make_batches(Uploads& uploads, uint32_t group_index, const CrowdSettings& settings) {
    const Group& group = groups[group_index];
    const uint32_t count = settings.groups[group_index].instance_count;
    const uint64_t joint_bytes = std::max(
        group.controller && group.controller->is_inertial ? sizeof(io::InertiaState) : kMatrix_bytes,
        group.controller ? group.controller->model_layer_count * sizeof(io::ModelRotations) : 0);
    const uint64_t spring_bytes = group.procedural ? group.procedural->spring_count * sizeof(io::SpringState) : 0;
    const uint64_t skinned_bytes = settings.skins_once ? group.vertex_count * sizeof(SkinnedVertex) : 0;
    const uint64_t target_bytes = group.procedural ? group.procedural->target_count * sizeof(io::vec4) : 0;
    const uint64_t instance_bytes = std::max({group.joint_count * joint_bytes, group.palette_count * kMatrix_bytes,
                                              spring_bytes, target_bytes, skinned_bytes,
                                              group.morphs ? kMorphs_bytes : 0});
    const uint64_t capacity = std::min<uint64_t>(arena_limit_bytes(*gpu) / instance_bytes,
                                                 gpu->properties.limits.maxComputeWorkGroupCount[0]);
    if (capacity == 0)
        throw Failure(ErrorCode::kLimit, group.name,
                      "what one instance takes (" + std::to_string(instance_bytes) +
                          " bytes) exceed the device's storage-buffer range of " +
                          std::to_string(arena_limit_bytes(*gpu)));
    const uint64_t batch_count = (count + capacity - 1) / capacity;
    for (uint64_t i = 0; i < batch_count; ++i) {
        const auto first = static_cast<uint32_t>(count * i / batch_count),
                   end = static_cast<uint32_t>(count * (i + 1) / batch_count);
        const uint64_t n = end - first;
        Batch batch;
        batch.group = group_index;
        batch.first_instance = instance_count + first;
        batch.instance_count = end - first;
        const auto storage = [&](const char* what, uint64_t size_bytes) {
            return Buffer(gpu, group.name + ": " + what, size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        };
        // The pace stage reads them as rows of 16 bytes.
        const auto matrices = [&](const char* what) {
            const uint64_t size_bytes = n * std::max(group.palette_count, 1u) * skin_format_bytes(skin_format);
            return group.is_paced(settings)
                       ? make_table_bytes(gpu, group.name + ": " + what, (size_bytes + 15) / 16 * 16, 16)
                       : storage(what, size_bytes);
        };
        if (group.controller) {
            make_layers(uploads, batch);
        } else {
            batch.playbacks = storage("playback states", n * sizeof(io::InstancePlayback));
            batch.cursors = storage("cursors", n * sizeof(io::InstanceCursor));
        }
        if (group.procedural) make_procedural_state(uploads, batch);
        if (group.steering) {
            batch.destinations = upload(uploads, group.name + ": destinations", std::vector<io::vec4>(n));
            batch.agents = upload(uploads, group.name + ": agents",
                                  std::vector<io::AgentState>(n, {.speed = 0, .patience = 1, .stands = 0}));
        }
        if (settings.culls) make_list(uploads, group, batch);
        batch.placements = make_table<Affine>(gpu, group.name + ": placements", n);
        for (size_t k = 0; k < (settings.keep_previous_matrices ? 2 : 1); ++k)
            batch.skins[k] = matrices("skin matrices");
        if (settings.skips_updates && group.is_paced(settings)) batch.ahead = matrices("skin matrices ahead");
        if (settings.skins_once)
            batch.skinned = storage("skinned vertices", n * std::max(group.vertex_count, 1u) * sizeof(SkinnedVertex));
        if (group.morphs) batch.morphs = storage("active morphs", n * kMorphs_bytes);
        if (group.morphs && group.controller)
            batch.voice_times = storage("times of voices", n * group.controller->voice_limit * sizeof(float));
        if (group.sockets) batch.sockets = storage("sockets", n * group.socket_count() * kMatrix_bytes);
        if (group.pose_capacity > 0)
            batch.posed = upload_table(uploads, group.name + ": instances with a pose set",
                                       as_words(std::vector<io::InstancePose>(n)));
        if (settings.keep_model_matrices)
            batch.kept_model = storage("model matrices", n * group.joint_count * kMatrix_bytes);
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
    uint64_t most_bytes = 0;  // of one that is watched
    for (const Group& group : groups) {
        any = any || group.controller || group.sockets || group.steering;
        uint64_t size_bytes = kMatrix_bytes + sizeof(io::RootState::move) + group.socket_count() * kMatrix_bytes;
        if (group.controller)
            size_bytes += group.controller->parameter_count * sizeof(float) +
                          group.controller->layer_count * sizeof(io::LayerState);
        most_bytes = std::max(most_bytes, size_bytes);
    }
    if (any) feedback.emplace(gpu, settings.event_capacity, watch_capacity_ * most_bytes);
}

// As its instances begin.
void CrowdState::make_layers(Uploads& uploads, Batch& batch) const {
    const Group& group = groups[batch.group];
    const GroupController& controller = *group.controller;
    const auto repeated = [&](const auto& one) {
        std::remove_cvref_t<decltype(one)> all;
        for (uint32_t i = 0; i < batch.instance_count; ++i) all.insert(all.end(), one.begin(), one.end());
        return all;
    };
    static_assert(sizeof(io::LayerState) == io::kLayerStateWords * sizeof(uint32_t) &&
                  sizeof(io::LayerPlay) == io::kLayerPlayWords * sizeof(uint32_t));
    batch.layers = upload_writable_table(uploads, group.name + ": layers",
                                         as_words(repeated(controller.initial_layers)));
    batch.parameters = upload_writable_table(uploads, group.name + ": parameters",
                                             as_words(repeated(controller.initial_parameters)));
    batch.voices = make_table<io::Voice>(gpu, group.name + ": voices",
                                         batch.instance_count * uint64_t{controller.voice_limit});
    if (controller.is_inertial) {
        batch.inertias = upload(uploads, group.name + ": inertial transitions",
                                std::vector<io::InstanceInertia>(batch.instance_count));
        batch.inertia_states = Buffer(gpu, group.name + ": poses of inertial transitions",
                                      batch.instance_count * uint64_t{group.joint_count} * sizeof(io::InertiaState),
                                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    }
    if (controller.model_layer_count > 0)
        batch.rotations = Buffer(gpu, group.name + ": rotations in model space",
                                 batch.instance_count * uint64_t{group.joint_count} * controller.model_layer_count *
                                     sizeof(io::ModelRotations),
                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    if (group.has_root_motion())
        batch.roots = upload(uploads, group.name + ": root motion",
                             std::vector<io::RootState>(batch.instance_count, standing_at(Affine{})));
}

// At rest, and without aims.
void CrowdState::make_procedural_state(Uploads& uploads, Batch& batch) const {
    const Group& group = groups[batch.group];
    if (group.procedural->target_count > 0)
        batch.targets = upload(uploads, group.name + ": targets",
                               std::vector<io::vec4>(batch.instance_count * size_t{group.procedural->target_count}));
    if (group.procedural->spring_count > 0)
        batch.springs = upload(
            uploads, group.name + ": springs",
            std::vector<io::SpringState>(batch.instance_count * size_t{group.procedural->spring_count}));
}

}  // namespace throng
