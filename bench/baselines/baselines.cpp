#include "bench/baselines/baselines.h"

#include "bench/value_of.h"
#include "bench/baselines/baselines_io.h"
#include "control/control.h"
#include "control/control_reference.h"
#include "gpu/barrier.h"
#include "gpu/upload.h"
#include "skin/skin_reference.h"

#include <algorithm>
#include <cstring>

namespace throng::bench {
namespace {

io::ClipPlay clip_play_of(const Character& baked, const ClipPlayback& from) {
    if (from.clip == kNone)
        return {.clip = static_cast<uint32_t>(baked.clips.size()), .loop = 0, .time_s = 0, .speed = 0};
    const double time_s = local_time_reference(from.time_s, baked.clips[from.clip].duration_s, from.loop);
    return {.clip = from.clip, .loop = from.loop ? 1u : 0u, .time_s = static_cast<float>(time_s), .speed = from.speed};
}

// Read by `baked` as storage buffers, by `flattened` as tables (gpu/table.glsl).
template <class T>
Buffer upload_rows(const std::shared_ptr<Gpu>& gpu, std::string_view what, const std::vector<T>& data) {
    Buffer rows = upload(gpu, what, data,
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT);
    rows.allow_texels(texel_bytes_of<T>());
    return rows;
}

}  // namespace

std::span<const Baseline> baselines() {
    static const Baseline rows[] = {baked(), flattened()};
    return rows;
}

BaselineCrowd::BaselineCrowd(std::shared_ptr<Gpu> gpu, const Baseline& baseline, const Character& baked,
                             std::span<const Playback> playbacks)
    : gpu_(std::move(gpu)),
      palette_count_(static_cast<uint32_t>(baked.palette.size())),
      tracks_per_clip_(static_cast<uint32_t>(baked.tracks.size() / (baked.clips.size() + 1))),
      control_(control_kernel(gpu_)),
      kernel_(gpu_,
              {.name = baseline.name, .spirv = gpu_->uses_software_kernels() ? baseline.software : baseline.plain}),
      clock_(gpu_) {
    std::vector<io::ClipTimeline> timelines;
    for (const Clip& clip : baked.clips)
        timelines.push_back({clip.first_time, clip.row_count, clip.row_stride, clip.first_row, clip.duration_s});
    // The rest pose
    timelines.push_back({.first_time = 0, .row_count = 1, .row_stride = 0, .first_row = 0, .duration_s = 0});
    std::vector<uint32_t> joints;
    std::vector<Affine> binds;
    for (const PaletteEntry& entry : baked.palette) {
        joints.push_back(entry.joint);
        binds.push_back(entry.joint_from_bind);
    }
    timelines_ = upload_table(gpu_, "clip timelines", as_words(timelines));
    times_ = upload_table(gpu_, "key times", baked.times_s);
    tracks_ = upload_rows(gpu_, "tracks", baked.tracks);
    keys_ = upload_rows(gpu_, baked.name + ": keys", baked.keys);
    palette_joints_ = upload(gpu_, "palette joints", joints);
    joint_from_bind_ = upload(gpu_, "inverse binds", binds);

    const VkPhysicalDeviceLimits& limits = gpu_->properties.limits;
    const uint64_t instance_bytes = std::max(palette_count_, 1u) * uint64_t{sizeof(Affine)};
    const uint64_t capacity = std::min<uint64_t>(
        std::min<uint64_t>(limits.maxStorageBufferRange, gpu_->max_allocation_bytes) / instance_bytes,
        limits.maxComputeWorkGroupCount[0]);
    for (size_t first = 0; first < playbacks.size(); first += capacity) {
        const auto members = playbacks.subspan(first, std::min<size_t>(capacity, playbacks.size() - first));
        std::vector<io::InstancePlayback> states;
        for (const Playback& playback : members)
            states.push_back(
                {clip_play_of(baked, playback.first), clip_play_of(baked, playback.second), playback.weight});
        Batch batch{.first_instance = static_cast<uint32_t>(first),
                    .instance_count = static_cast<uint32_t>(members.size())};
        batch.playbacks = upload(gpu_, "playback states", states);
        batch.cursors = Buffer(gpu_, "cursors", members.size() * sizeof(io::InstanceCursor),
                               VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        batch.skin = Buffer(gpu_, "skin matrices", members.size() * instance_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        batch.control_bindings = control_.bind(BufferTable{{io::kPlaybacksBuffer, batch.playbacks},
                                                           {io::kTimelineBuffer, timelines_},
                                                           {io::kTimesBuffer, times_},
                                                           {io::kBirthsBuffer, times_},
                                                           {io::kCursorsBuffer, batch.cursors}});
        batch.baseline_bindings = kernel_.bind({{io::kCursorsBuffer, batch.cursors},
                                                {io::kTracksBuffer, tracks_},
                                                {io::kKeysBuffer, keys_},
                                                {io::kPaletteJointsBuffer, palette_joints_},
                                                {io::kJointFromBindBuffer, joint_from_bind_},
                                                {io::kSkinBuffer, batch.skin}});
        batches_.push_back(std::move(batch));
    }
}

Reading BaselineCrowd::update(float time_step_s) const {
    return clock_.read([&](VkCommandBuffer commands) { record(commands, time_step_s); });
}

void BaselineCrowd::record(VkCommandBuffer commands, float time_step_s) const {
    for (const Batch& batch : batches_)
        control_.dispatch_invocations(commands, batch.control_bindings,
                                      io::ControlPush{batch.instance_count, tracks_per_clip_, time_step_s, 0},
                                      batch.instance_count);
    memory_barrier(*gpu_, commands, kShaderWrite, kShaderRead);
    for (const Batch& batch : batches_)
        kernel_.dispatch_workgroups(commands, batch.baseline_bindings, io::BaselinePush{palette_count_},
                                    batch.instance_count);
}

std::vector<Affine> BaselineCrowd::read_skin_matrices(uint32_t instance) const {
    const auto batch = std::find_if(batches_.begin(), batches_.end(),
                                    [&](const Batch& b) { return instance - b.first_instance < b.instance_count; });
    if (batch == batches_.end())
        throw Failure(ErrorCode::kInvalidArgument, "read-back", "no instance " + std::to_string(instance));
    const uint64_t size_bytes = uint64_t{palette_count_} * sizeof(Affine);
    return download<Affine>(
        gpu_, BufferRange(batch->skin.handle(), (instance - batch->first_instance) * size_bytes, size_bytes));
}

std::vector<double> displacements(const Character& character, const Playback& playback,
                                  std::span<const AffineT<double>> model_from_bind) {
    const ReferencePose pose = value_of(reference_pose(character, playback));
    const std::vector<Vec3<double>> wanted = skin_reference(character, pose.model_from_bind),
                                    got = skin_reference(character, model_from_bind);
    std::vector<double> out;
    for (size_t vertex = 0; vertex < wanted.size(); ++vertex) out.push_back(length(got[vertex] - wanted[vertex]));
    return out;
}

}  // namespace throng::bench
