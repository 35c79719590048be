// What comes back from the device.
#include "crowd/crowd_state.h"

#include "base/failure.h"
#include "bind/skin_format.h"
#include "crowd/skin_stage.h"
#include "cull/cull_io.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <set>

namespace throng {
void CrowdState::watch(const Instances& instances) {
    if (!feedback)
        throw Failure(ErrorCode::kInvalidArgument, "watch",
                      "no group has a controller, sockets or steering, and CrowdSettings::pose_request_capacity is 0: "
                      "there is no feedback");
    if (instances.size() > watch_capacity_)
        throw Failure(ErrorCode::kLimit, "watch",
                      std::to_string(instances.size()) + " instances; CrowdSettings::watch_capacity is " +
                          std::to_string(watch_capacity_));
    check_alive(instances, "watch");
    watched_.clear();
    for (uint32_t i = 0; i < instances.size(); ++i) watched_.push_back({.instance = instances.number(i), .place = i});
    std::ranges::sort(watched_, {}, &Watched::instance);
}

WatchedBatch CrowdState::watched_in(const Batch& batch) const {
    const Group& group = groups[batch.group];
    const auto part = [&](uint32_t number, uint64_t instance_bytes) {
        const Buffer& buffer = batch[number];
        return buffer ? WatchedBatch::Part{buffer, instance_bytes} : WatchedBatch::Part{};
    };
    WatchedBatch watched{.placements = part(io::kPlacementsBuffer, sizeof(Affine)),
                         .roots = part(io::kRootsBuffer, sizeof(io::RootState)),
                         .sockets = part(io::kSocketsBuffer, group.socket_count() * sizeof(Affine)),
                         .parameters = {},
                         .layers = {},
                         .layer_kinds = {},
                         .clip_count = static_cast<uint32_t>(group.clip_durations_s.size())};
    if (!group.controller) return watched;
    watched.parameters = part(io::kParametersBuffer, group.controller->parameter_count * sizeof(float));
    watched.layers = part(io::kLayersBuffer, group.controller->layer_count * sizeof(io::LayerState));
    watched.layer_kinds = group.controller->layer_kinds;
    return watched;
}

// Fills watched_runs_.
void CrowdState::find_watched_runs() {
    auto& [of_batches, runs] = watched_runs_;
    of_batches.clear();
    runs.clear();
    const Batch* batch = nullptr;
    for (size_t at = 0; at < watched_.size();) {
        const uint32_t first = watched_[at].instance;
        if (!batch || !batch->has(first)) {
            batch = &batch_of(first);
            of_batches.push_back(watched_in(*batch));
        }
        uint32_t count = 1;
        while (++at < watched_.size() && watched_[at].instance == first + count && batch->has(first + count)) ++count;
        runs.push_back({.batch = static_cast<uint32_t>(of_batches.size() - 1),
                        .first = first - batch->first_instance,
                        .count = count});
    }
}

void CrowdState::request_poses(const Instances& instances) {
    check_alive(instances, "pose request");
    if (instances.size() > pose_request_capacity_ - std::min<size_t>(pose_requests_.size(), pose_request_capacity_))
        throw Failure(ErrorCode::kLimit, "pose request", pose_requests_.size() + instances.size(),
                      " poses of one update; CrowdSettings::pose_request_capacity is ", pose_request_capacity_);
    for (uint32_t i = 0; i < instances.size(); ++i) {
        const Group& group = group_of(instances.number(i));
        if (group.sockets_only)
            throw Failure(ErrorCode::kInvalidArgument, "pose request", group.name, " has CrowdGroup::sockets_only");
        if (!group.pose_of_skin)
            throw Failure(ErrorCode::kInvalidArgument, "pose request", group.name, " has no CrowdGroup::pose_capacity");
    }
    for (uint32_t i = 0; i < instances.size(); ++i) pose_requests_.push_back(instances.number(i));
}

// If a discarded record() has put requests back, there may be more than there is room for: the rest wait.
std::vector<RequestedPose> CrowdState::take_pose_requests() {
    const auto end = pose_requests_.begin() + std::min<ptrdiff_t>(std::ssize(pose_requests_), pose_request_capacity_);
    recorded_pose_requests_.assign(pose_requests_.begin(), end);
    pose_requests_.erase(pose_requests_.begin(), end);
    std::vector<RequestedPose> taken;
    for (const uint32_t instance : recorded_pose_requests_) {
        const InBatch of = at(instance);
        const Group& group = group_of(instance);
        const uint64_t size_bytes = uint64_t{group.palette_count} * skin_format_bytes(skin_format);
        taken.push_back({.instance = instance,
                         .skin = {batches[of.batch].skin(), of.instance * size_bytes, size_bytes},
                         .skin_format = skin_format,
                         .pose_of_skin = group.pose_of_skin.get()});
    }
    return taken;
}

std::vector<Feedback> CrowdState::take_feedback() {
    if (!feedback) return {};
    std::vector<Feedback> taken = feedback->take();
    for (Feedback& one : taken) {
        const auto set_generation = [&](auto& of) {
            of.instance.generation = population->generation_at(of.instance.instance, one.update);
        };
        std::ranges::for_each(one.events, set_generation);
        std::ranges::for_each(one.watched, set_generation);
        std::ranges::for_each(one.poses, set_generation);
    }
    return taken;
}

// In a group that shaders populate, the handle stands for whichever instance has the number, if any.
void CrowdState::check_readable(const InstanceHandle& handle) const {
    check_in_group(handle, "read-back");
    if (!group_of(handle.instance).shaders_populate) check_alive(handle, "read-back");
    if (!batch_of(handle.instance).has_outputs)
        throw Failure(ErrorCode::kInvalidArgument, "read-back", "no update has written results of ",
                      group_of(handle.instance).name, " yet: call update(0)");
    check_last_has_run("read-back");
}

std::vector<Affine> CrowdState::read_matrices(const InstanceHandle& handle, bool model) {
    finish_uploads();
    check_readable(handle);
    const Batch& batch = batch_of(handle.instance);
    const Group& group = groups[batch.group];
    if (group.sockets_only)
        throw Failure(ErrorCode::kInvalidArgument, "read-back", group.name + " has CrowdGroup::sockets_only");
    if (model && !batch[io::kModelBuffer])
        throw Failure(ErrorCode::kInvalidArgument, "read-back",
                      "model matrices are kept only with CrowdSettings::keep_model_matrices");
    const uint64_t size_bytes = model ? group.joint_count * sizeof(Affine)
                                      : uint64_t{group.palette_count} * skin_format_bytes(skin_format);
    const uint32_t of_batch = handle.instance - batch.first_instance;
    const uint64_t row = model ? of_batch : read_skin_row(group, batch, of_batch);
    const BufferRange range(model ? batch[io::kModelBuffer] : batch.skin(), row * size_bytes, size_bytes);
    return unpack_skin(model ? SkinFormat::kAffine : skin_format, download<std::byte>(gpu, range));
}

std::vector<Vec3<float>> CrowdState::read_positions(const InstanceHandle& handle) {
    finish_uploads();
    check_readable(handle);
    const Batch& batch = batch_of(handle.instance);
    const Group& group = groups[batch.group];
    if (group.sockets_only)
        throw Failure(ErrorCode::kInvalidArgument, "read-back", group.name + " has CrowdGroup::sockets_only");
    if (group.vertex_count == 0) return {};
    read_skin_row(group, batch, handle.instance - batch.first_instance);  // throws if the instance is not drawn
    if (!skin_kernel_) skin_kernel_ = skin_kernel(gpu, skin_format, skin_blend, SkinScope::kAllVertices);
    const Buffer skinned(gpu, group.name + ": skinned vertices", group.vertex_count * sizeof(SkinnedVertex),
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const Bindings bindings = skin_kernel_->bind(skin_buffers(group, batch, batch.skin(), skinned));
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu, commands, kShaderWrite, kShaderRead);
        io::SkinPush push = skin_push(group);
        push.first_instance = handle.instance - batch.first_instance;
        push.influence_offset = joint_set_of(batch, push.first_instance) * group.influence_count;
        skin_kernel_->dispatch_workgroups(commands, bindings, push, 1);
    });
    std::vector<Vec3<float>> positions;
    for (const SkinnedVertex& vertex : download<SkinnedVertex>(gpu, skinned)) positions.push_back(vertex.position);
    return positions;
}

// `words` has one word for each instance.
uint32_t CrowdState::read_word(const Buffer& words, uint32_t instance) const {
    return download<uint32_t>(gpu, BufferRange(words, instance * sizeof(uint32_t), sizeof(uint32_t)))[0];
}

uint32_t CrowdState::read_skin_row(const Group& group, const Batch& batch, uint32_t instance) const {
    if (!group.skin_pool) return instance;
    if ((read_word(batch[io::kStatesBuffer], instance) & io::kStateDrawn) == 0)
        throw Failure(ErrorCode::kInvalidArgument, "read-back",
                      "instance " + std::to_string(batch.first_instance + instance) +
                          " was not drawn in the last update, and " + group.name + " has a skin pool");
    return read_word(batch[io::kSkinRowsBuffer], instance);
}

// The set of joints that an instance's skin matrices were written for; the finest, where it has not been drawn.
uint32_t CrowdState::joint_set_of(const Batch& batch, uint32_t instance) const {
    return batch[io::kStatesBuffer] ? read_word(batch[io::kStatesBuffer], instance) >> io::kStateSetShift : 0;
}

std::vector<DrawnInstance> CrowdState::read_drawn() {
    finish_uploads();
    if (!cull) throw Failure(ErrorCode::kInvalidArgument, "read-back", "CrowdSettings::culling is not set");
    check_last_has_run("read-back");
    std::vector<DrawnInstance> drawn;
    for (uint32_t batch = 0; batch < batches.size(); ++batch) {
        const std::vector<DrawnInstance> of_batch = cull->read(batch);
        drawn.insert(drawn.end(), of_batch.begin(), of_batch.end());
    }
    return drawn;
}

uint64_t CrowdState::size_bytes() const {
    uint64_t sum = feedback ? feedback->size_bytes() : 0;
    for (const auto& stage : stages) sum += stage->size_bytes();
    for (const Retired& retired : retired_) sum += retired.size_bytes();
    std::set<const NativeRig*> rigs;
    for (const Group& group : groups) {
        sum += group.size_bytes();
        for (const FusedJoints& joints : group.fused)
            if (joints.native && rigs.insert(joints.native.get()).second) sum += joints.native->size_bytes();
    }
    for (const Batch& batch : batches) sum += batch.size_bytes();
    return sum;
}

}  // namespace throng
