#include "crowd/staged_update.h"

#include "base/count.h"
#include "bind/bind.h"
#include "bind/sockets.h"
#include "sample/sample.h"

#include <throng/transform.h>

#include <algorithm>

namespace throng {
namespace {

static_assert(sizeof(io::JointPose) == sizeof(Affine));

// A larger arena would save hardly any dispatches, and only cost memory.
constexpr uint64_t kArenaBuffer_bytes = uint64_t{256} << 20;

}  // namespace

uint64_t arena_limit_bytes(const Gpu& gpu) {
    return std::min(
        {kArenaBuffer_bytes, uint64_t{gpu.properties.limits.maxStorageBufferRange}, gpu.max_allocation_bytes});
}

void StagedUpdate::plan(BatchPlan& plan) {
    if (plan.group().fused.empty()) plan.limit(plan.group().joint_count * sizeof(Affine));
}

StagedUpdate::StagedUpdate(const StageContext& context)
    : Stage(context), procedural_(*find_stage<ProceduralStage>(context.before)) {
    for (uint32_t i = 0; i < batches_.size(); ++i)
        if (group_of(batches_[i]).fused.empty()) served_.push_back({.batch = i});
    if (served_.empty()) return;
    for (const Group& group : groups_) {
        if (!group.fused.empty() || group.is_gone()) continue;
        const BlendOutput output = group.takes_similarities() ? BlendOutput::kSimilarity : BlendOutput::kAffine;
        std::optional<Kernel>& bind = bind_[group.varies];
        if (!bind) bind = bind_kernel(gpu_, context.settings.skin_format, group.varies);
        if (group.controller) {
            const LayeredSettings settings = layered_settings(group);
            if (!layered_.contains(settings)) layered_.emplace(settings, layered_kernel(gpu_, settings));
            continue;
        }
        std::optional<Kernel>& sample = sample_[group.packed][group.varies];
        if (!sample) sample = sample_kernel(gpu_, group.packed, group.varies);
        const BlendSettings settings{
            .output = output, .pose_overrides = group.pose_capacity > 0, .varies = group.varies};
        std::optional<Kernel>& blend = blend_[group.takes_similarities()][settings.pose_overrides][group.varies];
        if (!blend) blend = blend_kernel(gpu_, settings);
    }
    make_waves();
    for (ServedBatch& served : served_) bind_batch(served);
}

void StagedUpdate::make_waves() {
    const uint64_t limit_bytes = arena_limit_bytes(*gpu_),
                   alignment = gpu_->properties.limits.minStorageBufferOffsetAlignment;
    uint64_t used_bytes = 0, largest_bytes = 0;
    for (uint32_t i = 0; i < served_.size(); ++i) {
        const Batch& batch = batches_[served_[i].batch];
        const uint64_t needs_bytes = batch.instance_count * uint64_t{group_of(batch).joint_count} * sizeof(Affine);
        if (waves_.empty() || used_bytes + needs_bytes > limit_bytes) {
            waves_.push_back({.first_served = i});
            used_bytes = 0;
        }
        ++waves_.back().served_count;
        served_[i].arena_offset_bytes = used_bytes;
        largest_bytes = std::max(largest_bytes, used_bytes + needs_bytes);
        used_bytes = rounded_up(used_bytes + needs_bytes, alignment);
    }
    const auto storage = [&](const char* what) {
        return Buffer(gpu_, what, largest_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    };
    first_poses_ = storage("first poses");
    second_poses_ = storage("second poses");
    local_ = storage("local matrices");
    model_ = storage("model matrices");
}

void StagedUpdate::bind_batch(ServedBatch& served) {
    const Batch& batch = batches_[served.batch];
    const Group& group = group_of(batch);
    const uint64_t size_bytes = batch.instance_count * uint64_t{group.joint_count} * sizeof(Affine);
    const auto slice = [&](const Buffer& buffer) { return BufferRange(buffer, served.arena_offset_bytes, size_bytes); };
    const BufferRange first = slice(first_poses_), second = slice(second_poses_), local = slice(local_);
    const BufferRange model = batch[io::kModelBuffer] ? BufferRange(batch[io::kModelBuffer]) : slice(model_);
    const BufferTable table = batch
                                  .table(group,
                                         group.controller ? batch[io::kLayersBuffer] : group[io::kVerticesBuffer])
                                  .set({{io::kFirstPosesBuffer, first},
                                        {io::kSecondPosesBuffer, second},
                                        {io::kLocalBuffer, local},
                                        {io::kModelBuffer, model},
                                        {io::kScratchBuffer, second},
                                        {io::kScanLinksBuffer, group.scan->links()}});
    if (group.procedural) served.procedural = procedural_.bind(served.batch, local);
    served.scan = group.scan->bind(table);
    for (const Buffer& skin : batch.skins)
        served.bind.push_back(bind_of(group).bind(table.with({{io::kSkinBuffer, skin}})));
    if (group.sockets) {
        if (!sockets_) sockets_ = socket_kernel(gpu_);
        served.sockets = sockets_->bind(table);
    }
    if (group.controller) {
        served.layered = layered_of(group).bind(table);
        return;
    }
    const Kernel& sample = sample_of(group);
    served.sample_first = sample.bind(table.with({{io::kSampledPosesBuffer, first}}));
    served.sample_second = sample.bind(table.with({{io::kSampledPosesBuffer, second}}));
    served.blend = blend_of(group).bind(table);
}

LayeredSettings StagedUpdate::layered_settings(const Group& group) {
    return {.packed = group.packed,
            .output = group.takes_similarities() ? BlendOutput::kSimilarity : BlendOutput::kAffine,
            .inertial = group.controller->is_inertial,
            .pose_overrides = group.pose_capacity > 0,
            .varies = group.varies,
            .in_order = group.controller->model_layer_count > 0};
}

void StagedUpdate::record_layered(VkCommandBuffer commands, const ServedBatch& served, uint32_t instance_count,
                                  const Group& group) const {
    const uint32_t active_clip_limit = group.controller->active_clip_limit;
    if (group.controller->model_layer_count > 0)
        record_layered_in_order(*gpu_, commands, layered_of(group), served.layered,
                                {.instance_count = instance_count,
                                 .joint_count = group.joint_count,
                                 .active_clip_limit = active_clip_limit},
                                scan_limits(*gpu_).loop_iterations);
    else
        layered_of(group).dispatch_workgroups(commands, served.layered,
                                              io::LayeredPush{group.joint_count, active_clip_limit}, instance_count);
}

void StagedUpdate::record(const Update& update) {
    for (const Wave& wave : waves_) record_wave(update, wave);
}

uint32_t StagedUpdate::end_count() const {
    constexpr uint32_t kStages = 5;  // sample, blend, procedural, scan, bind
    return kStages * wave_count();
}

void StagedUpdate::record_wave(const Update& update, const Wave& wave) const {
    const VkCommandBuffer commands = update.commands;
    const std::span<const ServedBatch> of_wave = std::span(served_).subspan(wave.first_served, wave.served_count);
    const auto stage = [&](const char* name, const auto& record_batch) {
        for (const ServedBatch& served : of_wave)
            record_batch(served, batches_[served.batch].used_count, group_of(batches_[served.batch]));
        separate_kernels(commands);
        update.end_stage(name);
    };
    stage("sample", [&](const ServedBatch& served, uint32_t instance_count, const Group& group) {
        if (group.controller) {
            record_layered(commands, served, instance_count, group);
            return;
        }
        sample_of(group).dispatch_workgroups(commands, served.sample_first, io::SamplePush{group.joint_count, 0},
                                             instance_count);
        sample_of(group).dispatch_workgroups(commands, served.sample_second, io::SamplePush{group.joint_count, 1},
                                             instance_count);
    });
    stage("blend", [&](const ServedBatch& served, uint32_t instance_count, const Group& group) {
        if (!group.controller)
            blend_of(group).dispatch_workgroups(commands, served.blend, io::BlendPush{group.joint_count},
                                                instance_count);
    });
    record_procedural(update, of_wave);
    stage("scan", [&](const ServedBatch& served, uint32_t instance_count, const Group& group) {
        group.scan->record(commands, served.scan, instance_count);
    });
    stage("bind", [&](const ServedBatch& served, uint32_t instance_count, const Group& group) {
        if (group.sockets)
            sockets_->dispatch_invocations(
                commands, served.sockets,
                io::SocketPush{instance_count, group.joint_count, group.socket_count(),
                               io::kSocketsGather | group.socket_flags(), batches_[served.batch].birth},
                instance_count * group.socket_count());
        bind_of(group).dispatch_workgroups(commands, served.bind[batches_[served.batch].slot],
                                           io::BindPush{group.joint_count, group.palette_count}, instance_count);
    });
}

// Rank by rank. Within a rank, the batches run without barriers between them.
void StagedUpdate::record_procedural(const Update& update, std::span<const ServedBatch> of_wave) const {
    uint32_t rank_count = 0;
    for (const ServedBatch& served : of_wave) rank_count = std::max(rank_count, procedural_.rank_count(served.batch));
    if (rank_count == 0) return;
    for (uint32_t rank = 0; rank < rank_count; ++rank) {
        for (const ServedBatch& served : of_wave)
            if (rank < procedural_.rank_count(served.batch))
                procedural_.record_rank(update.commands, served.procedural, served.batch, rank);
        separate_kernels(update.commands);
    }
    update.end_stage("procedural");
}

uint64_t StagedUpdate::size_bytes() const {
    return first_poses_.size_bytes() + second_poses_.size_bytes() + local_.size_bytes() + model_.size_bytes();
}

}  // namespace throng
