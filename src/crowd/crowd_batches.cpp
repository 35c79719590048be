// Makes a crowd: checks its settings and the memory they take, and makes groups and the buffers of batches.
#include "crowd/crowd_state.h"

#include "base/enumeration.h"
#include "base/failure.h"
#include "base/message_name.h"
#include "bind/skin_format.h"
#include "compile/file/character_check.h"
#include "crowd/terrain_stage.h"
#include "reference/reference.h"

#include <algorithm>

namespace throng {
namespace {

constexpr float kMaxPoseMargin = 1000;

}  // namespace

uint64_t pose_bytes(const CrowdSettings& settings) {
    uint64_t sum = 0;
    for (const CrowdGroup& group : settings.groups)
        sum += std::min(group.pose_capacity, group.instance_count) * uint64_t{group.character->rig.joint_count()} *
               sizeof(io::JointPose);
    return sum;
}

void CrowdState::check_groups(const CrowdSettings& settings) const {
    check_known(settings.skin_format, SkinFormat::kSimilarity, "skin format");
    check_known(settings.skin_blend, SkinBlend::kDualQuaternion, "skin blend");
    check_known(settings.path, UpdatePath::kDevice, "update path");
    uint64_t total = 0;
    for (const CrowdGroup& group : settings.groups) {
        if (!group.character)
            throw Failure(ErrorCode::kInvalidArgument,
                          "groups[" + std::to_string(&group - settings.groups.data()) + "]", "it has no character");
        check_has_joints(*group.character);
        check_character(*group.character, message_name(group.character->name), ErrorCode::kInvalidArgument);
        check_known(group.socket_space, SocketSpace::kWorld, message_name(group.character->name) + ": socket space");
        check_steering(group);
        check_terrain(group);
        check_carried(group);
        check_command_settings(group);
        if (const float margin = group.pose_margin.value_or(0); !(margin >= 0 && margin <= kMaxPoseMargin))
            throw Failure(ErrorCode::kInvalidArgument, message_name(group.character->name) + ": pose margin", margin,
                          " is not within 0..", kMaxPoseMargin);
        total += group.instance_count;
    }
    if (total == 0) throw Failure(ErrorCode::kInvalidArgument, "crowd", "it has no instances");
    if (total > UINT32_MAX)
        throw Failure(ErrorCode::kLimit, "crowd", std::to_string(total) + " instances; at most 4,294,967,295");
    constexpr uint32_t kMaxInFlight = 4;  // feedback is kept for as many updates
    if (settings.frames_in_flight < 1 || settings.frames_in_flight > kMaxInFlight)
        throw Failure(ErrorCode::kInvalidArgument, "frames in flight", settings.frames_in_flight, " is not within 1..",
                      kMaxInFlight);
    check_memory("matrices and state", pose_bytes(settings));
}

void CrowdState::make_groups(Uploads& uploads, const CrowdSettings& settings) {
    SharedRigs rigs(gpu);
    for (const CrowdGroup& group : settings.groups) {
        if (const std::string unsupported_reason = skin_format_unsupported_reason(skin_format, *group.character);
            !unsupported_reason.empty())
            throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": skin format",
                          unsupported_reason);
        if (const std::string unsupported_reason = skin_blend_unsupported_reason(skin_blend, *group.character);
            !unsupported_reason.empty())
            throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": skin blend",
                          unsupported_reason);
        groups.emplace_back(uploads, rigs, group, choose_path(*gpu, settings, group), settings);
        if (groups.back().varies && settings.keep_previous_matrices && !groups.back().animates_drawn_only())
            throw Failure(ErrorCode::kUnsupported, message_name(group.character->name) + ": capacity",
                          "not together with keep_previous_matrices where a group has sockets or inertial transitions, "
                          "or is updated stage by stage");
    }
    natively_ = gpu->is_native() || std::ranges::all_of(groups, &Group::native);
    if (natively_) return;
    for (Group& group : groups) group.leave_native("another group of the crowd cannot be updated natively");
}

// Refuses early what cannot fit, before gigabytes have been allocated in vain.
void CrowdState::check_memory(std::string_view what, uint64_t needed_bytes) const {
    if (needed_bytes > gpu->largest_heap_bytes())
        throw Failure(ErrorCode::kLimit, "crowd", needed_bytes >> 20, " MiB of ", what,
                      " exceed the device's memory of ", gpu->largest_heap_bytes() >> 20, " MiB");
}

// As few batches as the device's limits allow.
uint64_t CrowdState::batch_count_of(const BatchPlan& plan, uint32_t count) const {
    const uint64_t limit_bytes = arena_limit_bytes(*gpu);
    // With a skin pool, only instances with a row of their own take a workgroup each, and make_skin_pool() limits these
    const uint64_t instances_per_workgroup = plan.group().skin_pool ? io::kCullWorkgroupSize : 1,
                   capacity = std::min(limit_bytes / plan.largest_bytes(),
                                       instances_per_workgroup * gpu->properties.limits.maxComputeWorkGroupCount[0]);
    if (capacity == 0)
        throw Failure(ErrorCode::kLimit, plan.group().name,
                      "one instance takes " + std::to_string(plan.largest_bytes()) +
                          " bytes, more than the device's storage-buffer range of " + std::to_string(limit_bytes));
    return (count + capacity - 1) / capacity;
}

// Cuts the group's instances into batches of nearly equal size.
void CrowdState::make_batches(Uploads& uploads, const BatchPlan& plan, uint32_t group, uint32_t count) {
    const uint64_t batch_count = batch_count_of(plan, count);
    for (uint64_t i = 0; i < batch_count; ++i) {
        const auto first = static_cast<uint32_t>(count * i / batch_count),
                   end = static_cast<uint32_t>(count * (i + 1) / batch_count);
        Batch& batch = batches.emplace_back();
        batch.group = group;
        batch.of_group = static_cast<uint32_t>(i);
        batch.first_instance = instance_count + first;
        batch.instance_count = batch.used_count = end - first;
        plan.make(uploads, batch);
    }
    instance_count += count;
}

namespace {

// The first `count` elements of a buffer, which may have been made a little larger.
template <class T>
std::span<T> in_host_memory(const Gpu& gpu, const Buffer& buffer, uint64_t count) {
    if (!gpu.is_native() || !buffer) return {};
    return {reinterpret_cast<T*>(buffer.mapped()), count};
}

}  // namespace

uint64_t CrowdState::skin_row_count(const Batch& batch) const {
    const std::optional<GroupSkinPool>& pool = groups[batch.group].skin_pool;
    return pool ? uint64_t{pool->shared_row_count} + pool->row_count(batch.instance_count) : batch.instance_count;
}

HostOutputs CrowdState::host_outputs(const Batch& batch, uint32_t of_slot) const {
    static_assert(sizeof(RootMotion) == sizeof(io::RootState) && sizeof(ShownMorph) == sizeof(io::ActiveMorph));
    const Group& group = groups[batch.group];
    const uint64_t n = batch.instance_count,
                   skin_bytes = skin_row_count(batch) * group.palette_count * skin_format_bytes(skin_format),
                   parameters = group.controller ? group.controller->parameter_count : 0,
                   targets = group.procedural ? group.procedural->target_count : 0;
    const auto bytes = [&](const Buffer& skin) { return in_host_memory<const std::byte>(*gpu, skin, skin_bytes); };
    const auto items = [&]<class T>(std::type_identity<T>, uint32_t number, uint64_t of_instance) {
        return in_host_memory<T>(*gpu, batch.shown_in(of_slot, number), n * of_instance);
    };
    // The first is the head.
    const auto of_commands = in_host_memory<InstanceCommand>(*gpu, batch[io::kInstanceCommandsBuffer],
                                                             1 + uint64_t{group.command_capacity});
    constexpr std::type_identity<const Affine> kAffines;
    constexpr std::type_identity<std::array<float, 4>> kRows;
    return {
        .skin = bytes(batch.skins[of_slot]),
        .previous_skin = keeps_previous_ ? bytes(batch.skins[batch.slot_before(of_slot)])
                                         : std::span<const std::byte>(),
        .model = items(kAffines, io::kModelBuffer, group.joint_count),
        .placement = items(kAffines, io::kPlacementsBuffer, 1),
        .socket = items(kAffines, io::kSocketsBuffer, group.socket_count()),
        .parameter = items(std::type_identity<float>(), io::kParametersBuffer, parameters),
        .root = items(std::type_identity<const RootMotion>(), io::kRootsBuffer, 1),
        .target = items(kRows, io::kTargetsBuffer, targets),
        .destination = items(kRows, io::kDestinationsBuffer, 1),
        .morph = items(std::type_identity<const ShownMorph>(), io::kActiveMorphsBuffer, group.active_morph_limit),
        .look = items(std::type_identity<const InstanceLook>(), io::kInstanceLooksBuffer, 1),
        .command_head = in_host_memory<CommandHead>(*gpu, batch[io::kInstanceCommandsBuffer], 1),
        .command = of_commands.empty() ? of_commands : of_commands.subspan(1),
        .list = in_host_memory<const uint32_t>(*gpu, batch.shown_in(of_slot, io::kListBuffer), io::kFirstListed + n),
        .skin_row = in_host_memory<const uint32_t>(*gpu, batch.shown_in(of_slot, io::kSkinRowsBuffer), n),
        .skinned = items(std::type_identity<const SkinnedVertex>(), io::kSkinnedBuffer,
                         group.sockets_only ? 0 : group.vertex_count)};
}

OutputBlock CrowdState::output_of(const Batch& batch, uint32_t of_slot) const {
    const Group& group = groups[batch.group];
    const uint64_t n = batch.instance_count, rows = skin_row_count(batch),
                   matrices_bytes = uint64_t{group.palette_count} * skin_format_bytes(skin_format);
    const uint32_t parameters = group.controller ? group.controller->parameter_count : 0,
                   targets = group.procedural ? group.procedural->target_count : 0;
    const auto view = [](const Buffer& buffer, uint64_t count, uint64_t stride_bytes) {
        return buffer && stride_bytes > 0 ? BufferView{buffer.handle(), 0, count * stride_bytes, stride_bytes}
                                          : BufferView();
    };
    const auto output = [&](uint32_t number, uint64_t stride_bytes) {
        return view(batch.shown_in(of_slot, number), n, stride_bytes);
    };
    return {.group = batch.group,
            .first_instance = batch.first_instance,
            .instance_count = batch.instance_count,
            .palette_count = group.palette_count,
            .joint_count = group.joint_count,
            .skin = view(batch.skins[of_slot], rows, matrices_bytes),
            .previous_skin = keeps_previous_ ? view(batch.skins[batch.slot_before(of_slot)], rows, matrices_bytes)
                                             : BufferView(),
            .skin_row_count = static_cast<uint32_t>(rows),
            .skin_row = output(io::kSkinRowsBuffer, sizeof(uint32_t)),
            .model = output(io::kModelBuffer, group.joint_count * sizeof(Affine)),
            .placement = output(io::kPlacementsBuffer, sizeof(Affine)),
            .socket_count = group.socket_count(),
            .socket = output(io::kSocketsBuffer, group.socket_count() * sizeof(Affine)),
            .parameter_count = parameters,
            .parameter = output(io::kParametersBuffer, parameters * sizeof(float)),
            .root = output(io::kRootsBuffer, sizeof(RootMotion)),
            .target_count = targets,
            .target = output(io::kTargetsBuffer, targets * sizeof(io::vec4)),
            .destination = output(io::kDestinationsBuffer, sizeof(io::vec4)),
            .morph_count = group.active_morph_limit,
            .morph = output(io::kActiveMorphsBuffer, group.active_morph_limit * sizeof(ShownMorph)),
            .look = output(io::kInstanceLooksBuffer, sizeof(InstanceLook)),
            .command_capacity = group.command_capacity,
            .command = view(batch[io::kInstanceCommandsBuffer], 1 + uint64_t{group.command_capacity},
                            sizeof(InstanceCommand)),
            .list = view(batch.shown_in(of_slot, io::kListBuffer), io::kFirstListed + n, sizeof(uint32_t)),
            .draw = view(batch.shown_in(of_slot, io::kDrawsBuffer), group.sections.size() * io::kLodCount,
                         sizeof(io::DrawCommand)),
            .vertex_count = group.vertex_count,
            .skinned = output(io::kSkinnedBuffer, group.sockets_only ? 0 : group.vertex_count * sizeof(SkinnedVertex)),
            .host = host_outputs(batch, of_slot)};
}

// Keeps existing feedback, and makes room in it.
void CrowdState::make_feedback() {
    watch_capacity_ = settings_.watch_capacity;
    pose_request_capacity_ = settings_.pose_request_capacity;
    bool any = pose_request_capacity_ > 0;
    uint64_t max_bytes = 0, max_skin_bytes = 0;  // of one that is watched, or whose pose is requested
    for (const Group& group : groups) {
        any = any || group.controller || group.sockets || group.steering;
        uint64_t size_bytes = sizeof(Affine) + sizeof(io::RootState) + group.socket_count() * sizeof(Affine);
        if (group.controller)
            size_bytes += group.controller->parameter_count * sizeof(float) +
                          group.controller->layer_count * sizeof(io::LayerState);
        max_bytes = std::max(max_bytes, size_bytes);
        if (group.pose_of_skin)
            max_skin_bytes = std::max(max_skin_bytes, group.palette_count * uint64_t{skin_format_bytes(skin_format)});
    }
    if (!any) return;
    const uint64_t instance_bytes = watch_capacity_ * max_bytes + pose_request_capacity_ * max_skin_bytes;
    check_memory("feedback (event_capacity, watch_capacity, pose_request_capacity)",
                 FeedbackRing::bytes_needed(settings_.event_capacity, instance_bytes));
    if (feedback) return feedback->make_room(instance_bytes);
    feedback.emplace(gpu, settings_.event_capacity, instance_bytes);
    if (population) feedback->restart(population->update_count());
}

}  // namespace throng
