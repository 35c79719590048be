#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "bind/bind.h"
#include "blend/blend.h"
#include "control/control.h"
#include "control/control_reference.h"
#include "control/playback.h"
#include "gpu/barrier.h"
#include "sample/sample.h"
#include "scan/scan_planner.h"
#include "skin/skin.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

constexpr uint64_t kMatrix_bytes = sizeof(Affine);
static_assert(sizeof(io::JointPose) == kMatrix_bytes);

// Beyond this an arena saves no dispatches that would matter, and only costs memory.
constexpr uint64_t kArenaBuffer_bytes = uint64_t{256} << 20;

uint64_t arena_limit_bytes(const Gpu& gpu) {
    return std::min({kArenaBuffer_bytes, uint64_t{gpu.properties.limits.maxStorageBufferRange}, gpu.max_allocation_bytes});
}

uint64_t align_up(uint64_t value, uint64_t alignment) { return (value + alignment - 1) / alignment * alignment; }

}  // namespace

CrowdState::CrowdState(std::shared_ptr<Gpu> gpu_in, const CrowdSettings& settings)
    : gpu(std::move(gpu_in)), control_(control_kernel(gpu)), sample_(sample_kernel(gpu)), bind_(bind_kernel(gpu)) {
    uint64_t total = 0;
    for (const CrowdGroup& group : settings.groups) {
        if (!group.character) throw Failure(ErrorCode::kInvalidArgument, "crowd", "a group has no character");
        total += group.instance_count;
    }
    if (total == 0) throw Failure(ErrorCode::kInvalidArgument, "crowd", "it has no instances");
    if (total > UINT32_MAX) throw Failure(ErrorCode::kLimit, "crowd", std::to_string(total) + " instances; at most 4,294,967,295");

    check_memory(settings);

    groups.reserve(settings.groups.size());
    const ScanLimits limits = scan_limits(*gpu);
    const ScanCosts costs = scan_costs(*gpu);
    for (const CrowdGroup& group : settings.groups) {
        const Rig& rig = group.character->rig;
        groups.emplace_back(gpu, *group.character, choose_scan(settings.scan, ScanRig(rig.parents, rig.uniform_scale), group.instance_count, limits, costs));
        blend_of(groups.back());
        make_batches(static_cast<uint32_t>(groups.size() - 1), group.instance_count, settings.keep_model_matrices);
        const auto rest = static_cast<uint32_t>(group.character->clips.size());
        const io::SlotPlayback rest_slot{.clip = rest, .loop = 0, .time_s = 0, .speed = 0};
        playbacks_.insert(playbacks_.end(), group.instance_count, {rest_slot, rest_slot, 1});
    }
    make_waves();
    bind_batches();
    placements.resize(instance_count);
    dirty_playbacks_.add(0, instance_count);
    dirty_placements_.add(0, instance_count);
    if (settings.timestamps && gpu->has_timestamps()) timer = std::make_unique<StageTimer>(gpu, static_cast<uint32_t>(waves.size()));
}

// Made when the first group needs it: not all crowds need both.
const Kernel& CrowdState::blend_of(const Group& group) {
    const bool similarity = group.scan.choice().method->format == ScanFormat::kSimilarity;
    std::optional<Kernel>& kernel = similarity ? blend_similarities_ : blend_affines_;
    if (!kernel) kernel = blend_kernel(gpu, similarity ? BlendOutput::kSimilarity : BlendOutput::kAffine);
    return *kernel;
}

// Refuses at once what cannot fit, before gigabytes are allocated on the way to failing.
void CrowdState::check_memory(const CrowdSettings& settings) const {
    uint64_t needed_bytes = 0, largest_heap_bytes = 0;
    for (const CrowdGroup& group : settings.groups) {
        const uint64_t matrices = group.character->palette.size() + 1 + (settings.keep_model_matrices ? group.character->rig.joint_count() : 0);
        needed_bytes += group.instance_count * (matrices * kMatrix_bytes + sizeof(io::InstancePlayback) + sizeof(io::InstanceCursor));
    }
    for (uint32_t heap = 0; heap < gpu->memory_properties.memoryHeapCount; ++heap)
        largest_heap_bytes = std::max<uint64_t>(largest_heap_bytes, gpu->memory_properties.memoryHeaps[heap].size);
    if (needed_bytes > largest_heap_bytes)
        throw Failure(ErrorCode::kLimit, "crowd", std::to_string(needed_bytes >> 20) + " MiB of matrices and state exceed the device's memory of " + std::to_string(largest_heap_bytes >> 20) + " MiB");
}

// As few batches as the device's limits allow, of nearly equal size.
void CrowdState::make_batches(uint32_t group_index, uint32_t count, bool keep_model) {
    const Group& group = groups[group_index];
    const uint64_t widest = std::max(group.joint_count, group.palette_count);
    const uint64_t capacity = std::min<uint64_t>(arena_limit_bytes(*gpu) / (widest * kMatrix_bytes), gpu->properties.limits.maxComputeWorkGroupCount[0]);
    if (capacity == 0)
        throw Failure(ErrorCode::kLimit, group.name, "the matrices of one instance (" + std::to_string(widest * kMatrix_bytes) +
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
        batch.playbacks = storage("playback states", n * sizeof(io::InstancePlayback));
        batch.cursors = storage("cursors", n * sizeof(io::InstanceCursor));
        batch.placements = storage("placements", n * kMatrix_bytes);
        batch.skin = storage("skin matrices", n * std::max(group.palette_count, 1u) * kMatrix_bytes);
        if (keep_model) batch.kept_model = storage("model matrices", n * group.joint_count * kMatrix_bytes);
        outputs.push_back({.group = group_index,
                           .first_instance = batch.first_instance,
                           .instance_count = batch.instance_count,
                           .palette_count = group.palette_count,
                           .joint_count = group.joint_count,
                           .skin_buffer = batch.skin.handle(),
                           .model_buffer = batch.kept_model.handle(),
                           .placement_buffer = batch.placements.handle()});
        batches.push_back(std::move(batch));
    }
    instance_count += count;
}

void CrowdState::make_waves() {
    const uint64_t limit_bytes = arena_limit_bytes(*gpu), alignment = gpu->properties.limits.minStorageBufferOffsetAlignment;
    uint64_t used_bytes = 0, largest_bytes = 0;
    for (uint32_t i = 0; i < batches.size(); ++i) {
        const uint64_t needs_bytes = batches[i].instance_count * uint64_t{groups[batches[i].group].joint_count} * kMatrix_bytes;
        if (waves.empty() || used_bytes + needs_bytes > limit_bytes) {
            waves.push_back({.first_batch = i});
            used_bytes = 0;
        }
        ++waves.back().batch_count;
        arena_offsets_bytes_.push_back(used_bytes);
        largest_bytes = std::max(largest_bytes, used_bytes + needs_bytes);
        used_bytes = align_up(used_bytes + needs_bytes, alignment);
    }
    const auto storage = [&](const char* what) { return Buffer(gpu, what, largest_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT); };
    arena_ = {storage("first poses"), storage("second poses"), storage("local matrices"), storage("model matrices")};
}

void CrowdState::bind_batches() {
    for (size_t i = 0; i < batches.size(); ++i) {
        Batch& batch = batches[i];
        const Group& group = groups[batch.group];
        const uint64_t size_bytes = batch.instance_count * uint64_t{group.joint_count} * kMatrix_bytes;
        const auto slice = [&](const Buffer& buffer) { return BufferRange(buffer.handle(), arena_offsets_bytes_[i], size_bytes); };
        const BufferRange first = slice(arena_.first_poses), second = slice(arena_.second_poses), local = slice(arena_.local);
        const BufferRange model = batch.kept_model.handle() ? BufferRange(batch.kept_model) : slice(arena_.model);
        batch.control = control_.bind(ControlBuffers{batch.playbacks, group.axes, group.times, batch.cursors});
        batch.sample_first = sample_.bind(SampleBuffers{batch.cursors, group.tracks, group.keys, first});
        batch.sample_second = sample_.bind(SampleBuffers{batch.cursors, group.tracks, group.keys, second});
        batch.blend = blend_of(group).bind(BlendBuffers{batch.cursors, first, second, local});
        batch.scan = group.scan.bind({.local = local, .links = group.scan.links(), .model = model, .scratch = second});
        batch.bind = bind_.bind(BindBuffers{model, group.palette_joints, group.joint_from_bind, batch.skin});
    }
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
        const auto& durations_s = groups[batch_of(first_instance + i).group].clip_durations_s;
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
    std::copy(checked.begin(), checked.end(), playbacks_.begin() + first_instance);
    dirty_playbacks_.add(first_instance, static_cast<uint32_t>(playback.size()));
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

// The changes travel inside the command buffer, so that no staging memory has to outlive the call.
void CrowdState::upload_changes(VkCommandBuffer commands) {
    constexpr uint64_t kUpdateLimit_bytes = 65536;  // of vkCmdUpdateBuffer
    const auto upload_ranges = [&](DirtyRanges& dirty, const auto& values, Buffer Batch::*buffer) {
        constexpr uint64_t kItem_bytes = sizeof(values[0]), kItems = kUpdateLimit_bytes / kItem_bytes;
        for (auto [first, count] : dirty.take()) {
            while (count > 0) {
                const Batch& batch = batch_of(first);
                const uint64_t end = std::min<uint64_t>({first + uint64_t{count}, batch.first_instance + uint64_t{batch.instance_count}, first + kItems});
                const auto n = static_cast<uint32_t>(end - first);
                gpu->vk.vkCmdUpdateBuffer(commands, (batch.*buffer).handle(), (first - batch.first_instance) * kItem_bytes, n * kItem_bytes, &values[first]);
                first += n;
                count -= n;
            }
        }
    };
    upload_ranges(dirty_playbacks_, playbacks_, &Batch::playbacks);
    upload_ranges(dirty_placements_, placements, &Batch::placements);
}

void CrowdState::record(VkCommandBuffer commands, float time_step_s) {
    if (!std::isfinite(time_step_s)) throw Failure(ErrorCode::kInvalidArgument, "time step", "must be finite");
    constexpr Access kConsumers = kShaderRead | kVertexRead | kTransferRead;
    // Whoever reads the last update's results must be done.
    memory_barrier(*gpu, commands, kConsumers | kShaderWrite | kTransferWrite, kShaderRead | kShaderWrite | kTransferWrite);
    upload_changes(commands);
    memory_barrier(*gpu, commands, kTransferWrite, kShaderRead | kShaderWrite | kVertexRead);
    if (timer) timer->begin(commands);
    for (const Wave& wave : waves) record_wave(commands, wave, time_step_s);
    memory_barrier(*gpu, commands, kShaderWrite, kConsumers);
}

// The pipeline: control, sample, blend, scan, bind.
void CrowdState::record_wave(VkCommandBuffer commands, const Wave& wave, float time_step_s) {
    const std::span<const Batch> members = std::span(batches).subspan(wave.first_batch, wave.batch_count);
    const auto stage = [&](const auto& record_batch) {
        for (const Batch& batch : members) record_batch(batch, groups[batch.group]);
        memory_barrier(*gpu, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite);
        if (timer) timer->end_stage(commands);
    };
    if (timer) timer->begin_wave(commands);
    stage([&](const Batch& batch, const Group& group) {
        control_.dispatch_invocations(commands, batch.control, io::ControlPush{batch.instance_count, group.joint_count, time_step_s}, batch.instance_count);
    });
    stage([&](const Batch& batch, const Group& group) {
        sample_.dispatch_workgroups(commands, batch.sample_first, io::SamplePush{group.joint_count, 0}, batch.instance_count);
        sample_.dispatch_workgroups(commands, batch.sample_second, io::SamplePush{group.joint_count, 1}, batch.instance_count);
    });
    stage([&](const Batch& batch, const Group& group) {
        blend_of(group).dispatch_workgroups(commands, batch.blend, io::BlendPush{group.joint_count}, batch.instance_count);
    });
    stage([&](const Batch& batch, const Group& group) { group.scan.record(commands, batch.scan, batch.instance_count); });
    stage([&](const Batch& batch, const Group& group) {
        bind_.dispatch_workgroups(commands, batch.bind, io::BindPush{group.joint_count, group.palette_count}, batch.instance_count);
    });
}

std::vector<Affine> CrowdState::read_matrices(uint32_t instance, bool model) const {
    check_range(instance, 1, "read-back");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (model && !batch.kept_model.handle())
        throw Failure(ErrorCode::kInvalidArgument, "read-back", "model matrices are kept only with CrowdSettings::keep_model_matrices");
    const uint64_t size_bytes = uint64_t{model ? group.joint_count : group.palette_count} * kMatrix_bytes;
    return download<Affine>(gpu, BufferRange(model ? batch.kept_model.handle() : batch.skin.handle(), (instance - batch.first_instance) * size_bytes, size_bytes));
}

std::vector<Vec3<float>> CrowdState::read_positions(uint32_t instance) {
    check_range(instance, 1, "read-back");
    const Batch& batch = batch_of(instance);
    const Group& group = groups[batch.group];
    if (group.vertex_count == 0) return {};
    if (!skin_) skin_ = skin_kernel(gpu);
    const Buffer positions(gpu, group.name + ": skinned positions", group.vertex_count * uint64_t{sizeof(io::vec4)}, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const Bindings bindings = skin_->bind(SkinBuffers{group.vertices, group.influences, batch.skin, positions});
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite, kShaderRead);
        for (const MeshSection& section : group.sections)
            skin_->dispatch_invocations(commands, bindings,
                                      io::SkinPush{.first_vertex = section.first_vertex,
                                                   .vertex_count = section.vertex_count,
                                                   .first_influences = section.first_influences,
                                                   .influence_sets = section.influence_sets,
                                                   .first_palette_entry = (instance - batch.first_instance) * group.palette_count},
                                      section.vertex_count);
    });
    std::vector<Vec3<float>> out;
    for (const io::vec4& p : download<io::vec4>(gpu, positions)) out.push_back({p.x, p.y, p.z});
    return out;
}

uint64_t CrowdState::size_bytes() const {
    uint64_t sum = 0;
    for (const Group& group : groups) sum += group.size_bytes();
    for (const Batch& batch : batches)
        for (const Buffer* buffer : {&batch.playbacks, &batch.cursors, &batch.placements, &batch.skin, &batch.kept_model}) sum += buffer->size_bytes();
    for (const Buffer* buffer : {&arena_.first_poses, &arena_.second_poses, &arena_.local, &arena_.model}) sum += buffer->size_bytes();
    return sum;
}

}  // namespace throng
