#include "crowd/cull_stage.h"

#include "base/failure.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

uint32_t workgroups_of(uint32_t instance_count) { return (instance_count + io::kCullWorkgroupSize - 1) / io::kCullWorkgroupSize; }

}  // namespace

io::CullView cull_view_of(const CrowdView* view) {
    constexpr float kMost = 1e30f;
    if (!view) return {.planes = {}, .eye = {0, 0, 0, kMost}, .shadow = {}};
    const auto& rows = view->clip_from_world;
    for (const auto& row : rows)
        if (!std::ranges::all_of(row, [](float f) { return std::isfinite(f); })) throw Failure(ErrorCode::kInvalidArgument, "view", "clip_from_world must be finite");
    const Vec3<float>&eye = view->eye, &shadow = view->shadow;
    if (!std::isfinite(length(eye)) || !std::isfinite(length(shadow))) throw Failure(ErrorCode::kInvalidArgument, "view", "eye and shadow must be finite");
    if (!(view->pixels > 0) || !(view->detail_pixels > 0)) throw Failure(ErrorCode::kInvalidArgument, "view", "pixels and detail_pixels must be above 0");
    // A point is inside where its clip coordinates are: -w <= x, y <= w and 0 <= z <= w (G. Gribb and K. Hartmann, Fast Extraction of Viewing Frustum Planes, 2001).
    const auto plane = [&](float of_w, size_t row, float of_row) {
        const auto at = [&](size_t k) { return of_w * rows[3][k] + of_row * rows[row][k]; };
        return io::vec4{at(0), at(1), at(2), at(3)};
    };
    return {.planes = {plane(1, 0, 1), plane(1, 0, -1), plane(1, 1, 1), plane(1, 1, -1), plane(0, 2, 1), plane(1, 2, -1)},
            .eye = {eye.x, eye.y, eye.z, std::min(view->pixels / view->detail_pixels, kMost)},
            .shadow = {shadow.x, shadow.y, shadow.z, 0}};
}

void make_list(const std::shared_ptr<Gpu>& gpu, const Group& group, Batch& batch) {
    batch.list = upload_writable_table(gpu, group.name + ": what is drawn", std::vector<uint32_t>(io::kFirstListed + size_t{batch.instance_count}));
    std::vector<io::DrawCommand> draws;
    for (size_t section = 0; section < group.sections.size(); ++section)
        for (size_t detail = 0; detail < io::kDetailLevels; ++detail) {
            const IndexRange range = detail <= group.details.size() ? group.detail_ranges[detail * group.sections.size() + section] : IndexRange();
            draws.push_back({.index_count = range.index_count, .instance_count = 0, .first_index = range.first_index, .vertex_offset = 0, .first_instance = 0});
        }
    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    batch.draws = upload(gpu, group.name + ": draw commands", draws, kUsage);
    batch.dispatch = upload(gpu, group.name + ": dispatch commands", std::vector<uint32_t>{0, 1, 1}, kUsage);
}

CullStage::CullStage(std::shared_ptr<Gpu> gpu, const std::vector<Group>& groups, const std::vector<Batch>& batches)
    : gpu_(std::move(gpu)), groups_(groups), batches_(batches), kernels_(gpu_), view_(upload(gpu_, "view", std::vector{cull_view_of(nullptr)})) {
    for (const Batch& batch : batches_) {
        const std::string name = groups_[batch.group].name;
        const auto storage = [&](const char* what, uint64_t size_bytes) { return Buffer(gpu_, name + what, size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT); };
        Member& member = members_.emplace_back();
        member.details = storage(": levels of detail", batch.instance_count * sizeof(uint32_t));
        member.counts = storage(": counts of what is drawn", workgroups_of(batch.instance_count) * sizeof(io::uvec4));
        member.cull = kernels_.cull.bind(CullBuffers{view_, batch.placements, member.details, member.counts});
        member.offsets = kernels_.offsets.bind(OffsetsBuffers{member.counts, batch.list, batch.dispatch, batch.draws});
        member.list = kernels_.list.bind(ListBuffers{member.details, member.counts, batch.list});
    }
}

void CullStage::record_view(VkCommandBuffer commands, const CrowdView* view) {
    const io::CullView seen = cull_view_of(view);
    record_update(*gpu_, commands, view_, 0, std::span<const io::CullView>(&seen, 1));
}

io::CullPush CullStage::push_of(const Batch& batch) const {
    const Group& group = groups_[batch.group];
    const Vec3<float> centre = (group.posed_min + group.posed_max) * 0.5f, half = (group.posed_max - group.posed_min) * 0.5f;
    std::array<float, io::kDetailLevels> errors{};
    std::ranges::transform(group.details, errors.begin() + 1, &DetailLevel::error);
    return {.centre = {centre.x, centre.y, centre.z, 0},
            .half_extent = {half.x, half.y, half.z, 0},
            .detail_errors = {errors[0], errors[1], errors[2], errors[3]},
            .instance_count = batch.instance_count,
            .detail_count = static_cast<uint32_t>(1 + group.details.size())};
}

void CullStage::record(VkCommandBuffer commands, StageTimer* timer) const {
    const auto for_each = [&](const auto& dispatch) {
        for (size_t i = 0; i < members_.size(); ++i) dispatch(members_[i], batches_[i]);
        memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite | kIndirectRead);
    };
    for_each([&](const Member& member, const Batch& batch) { kernels_.cull.dispatch_invocations(commands, member.cull, push_of(batch), batch.instance_count); });
    for_each([&](const Member& member, const Batch& batch) {
        const Group& group = groups_[batch.group];
        const io::OffsetsPush push{.workgroup_count = workgroups_of(batch.instance_count),
                                   .section_count = static_cast<uint32_t>(group.sections.size()),
                                   .instances_of_workgroup = group.fused ? group.fused->plan.scan.instances_per_workgroup : 1};
        kernels_.offsets.dispatch_workgroups(commands, member.offsets, push, 1);
    });
    for_each([&](const Member& member, const Batch& batch) { kernels_.list.dispatch_invocations(commands, member.list, push_of(batch), batch.instance_count); });
    if (timer) timer->end_stage(commands, &StageTimes::cull);
}

std::vector<DrawnInstance> CullStage::read(uint32_t batch_index) const {
    const Batch& batch = batches_[batch_index];
    const std::vector<uint32_t> list = download<uint32_t>(gpu_, batch.list);
    std::vector<DrawnInstance> drawn;
    for (uint32_t detail = 0; detail < io::kDetailLevels; ++detail) {
        const uint32_t end = detail + 1 < io::kDetailLevels ? list[io::kListBegins + detail + 1] : list[io::kListCount];
        for (uint32_t i = list[io::kListBegins + detail]; i < end; ++i) drawn.push_back({batch.first_instance + list[io::kFirstListed + i], detail});
    }
    return drawn;
}

uint64_t CullStage::size_bytes() const {
    uint64_t sum = view_.size_bytes();
    for (const Member& member : members_) sum += member.details.size_bytes() + member.counts.size_bytes();
    return sum;
}

}  // namespace throng
