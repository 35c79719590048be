#include "crowd/cull_stage.h"

#include "base/failure.h"
#include "base/finite.h"
#include "crowd/state_archive.h"
#include "gpu/barrier.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
io::CullView cull_view_of(const CrowdView* view, float full_rate_pixels) {
    constexpr float kMaximum = 1e30f;
    io::CullView seen{.eye = {0, 0, 0, kMaximum}, .ground = -kMaximum, .shared_pixels = kMaximum};
    if (!view) return seen;
    const auto& rows = view->clip_from_world;
    if (!all_finite(rows)) throw Failure(ErrorCode::kInvalidArgument, "view", "clip_from_world must be finite");
    const Vec3<float>&eye = view->eye, &shadow = view->shadow;
    if (!std::isfinite(length(eye)) || !std::isfinite(length(shadow)) || !std::isfinite(view->ground))
        throw Failure(ErrorCode::kInvalidArgument, "view", "eye, shadow and ground must be finite");
    if (!(view->shared_pose_pixels >= 0))
        throw Failure(ErrorCode::kInvalidArgument, "view", "shared_pose_pixels must not be negative");
    if (!(view->pixels > 0) || !(view->lod_pixels > 0))
        throw Failure(ErrorCode::kInvalidArgument, "view", "pixels and lod_pixels must be above 0");
    if (!std::isfinite(view->pixels) && !(std::isfinite(view->lod_pixels) && std::isfinite(view->shared_pose_pixels)))
        throw Failure(ErrorCode::kInvalidArgument, "view",
                      "if pixels is infinite, lod_pixels and shared_pose_pixels must be finite");
    if (!(full_rate_pixels >= 0 && full_rate_pixels <= kMaxFullRatePixels) || !(view->budget_ms >= 0))
        throw Failure(ErrorCode::kInvalidArgument, "view",
                      "full_rate_pixels must be from 0 to 1e30, and budget_ms must not be negative");
    // A point is inside where its clip coordinates are: -w <= x, y <= w and 0 <= z <= w (G. Gribb and K. Hartmann, Fast
    // Extraction of Viewing Frustum Planes, 2001).
    const auto plane = [&](float of_w, size_t row, float of_row) {
        const auto at = [&](size_t k) { return of_w * rows[3][k] + of_row * rows[row][k]; };
        return io::vec4{at(0), at(1), at(2), at(3)};
    };
    const std::array planes{plane(1, 0, 1),  plane(1, 0, -1), plane(1, 1, 1),
                            plane(1, 1, -1), plane(0, 2, 1),  plane(1, 2, -1)};
    std::ranges::copy(planes, seen.planes);
    for (size_t r = 0; r < 4; ++r) seen.clip_from_world[r] = {rows[r][0], rows[r][1], rows[r][2], rows[r][3]};
    seen.eye = {eye.x, eye.y, eye.z, std::min(view->pixels / view->lod_pixels, kMaximum)};
    seen.shadow = {shadow.x, shadow.y, shadow.z,
                   full_rate_pixels > 0
                       ? std::clamp(view->pixels / full_rate_pixels, std::numeric_limits<float>::min(), kMaximum)
                       : 0};
    seen.occlusion = view->occlusion;
    seen.ground = view->ground;
    seen.shared_pixels = std::min(view->pixels / view->shared_pose_pixels, kMaximum);
    return seen;
}

void CullStage::plan(BatchPlan& plan) {
    const Group& group = plan.group();
    constexpr uint64_t kWord_bytes = sizeof(uint32_t);
    const auto words = [](uint64_t first, uint64_t of_instance) {
        return [=](Uploads& uploads, const std::string& what, uint64_t n) {
            return fill_table(uploads, what, std::vector<uint32_t>(1), first + of_instance * n);
        };
    };
    plan.add(io::kListBuffer, kWord_bytes, words(io::kFirstListed, 1));
    plan.add(io::kWorkBuffer, io::kMaxWorkOfInstance * kWord_bytes, words(io::kFirstWork, io::kMaxWorkOfInstance));
    plan.add_filled(io::kStatesBuffer, std::vector<uint32_t>(1));
    plan.add_storage(io::kVerdictsBuffer, kWord_bytes);
    plan.add(io::kCountsBuffer, kWord_bytes, [](Uploads& uploads, const std::string& what, uint64_t n) {
        return Buffer(uploads.gpu(), what,
                      cull_workgroups_of(static_cast<uint32_t>(n)) * uint64_t{io::kCounters} * sizeof(uint32_t),
                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    });
    constexpr uint64_t kCell_bytes = 1;  // half a byte per instance, rounded up
    plan.add(io::kCellsBuffer, kCell_bytes, [](Uploads& uploads, const std::string& what, uint64_t n) {
        return fill(uploads, what, std::vector<io::Cell>(1), cell_count(static_cast<uint32_t>(n)));
    });
    std::vector<io::DrawCommand> draws;
    for (size_t section = 0; section < group.sections.size(); ++section)
        for (uint32_t lod = 0; lod < io::kLodCount; ++lod) {
            const SectionLod of = lod <= group.lods.size() ? group.section_lod(section, lod) : SectionLod();
            draws.push_back({.index_count = of.index_count,
                             .instance_count = 0,
                             .first_index = of.first_index,
                             .vertex_offset = group.sections[section].first_vertex,
                             .first_instance = 0});
        }
    constexpr VkBufferUsageFlags kUsage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    const auto commands = [](auto all) {
        return [all = std::move(all)](Uploads& uploads, const std::string& what, uint64_t) {
            return upload(uploads, what, all, kUsage);
        };
    };
    plan.add(io::kDrawsBuffer, 0, commands(std::move(draws)));
    plan.add(io::kDispatchesBuffer, 0,
             commands(std::vector<VkDispatchIndirectCommand>(io::kWorkSections + 1, {0, 1, 1})));
}

CullStage::CullStage(const StageContext& context)
    : Stage(context),
      keeps_previous_(context.settings.keep_previous_matrices),
      may_skip_(context.settings.culling->skips_updates),
      kernels_(gpu_),
      view_(upload_table(context.uploads, "view", std::vector{cull_view_of(nullptr, 0)})) {
    for (size_t i = 0; i < batches_.size(); ++i) {
        ServedBatch& served = served_.emplace_back();
        served.cells = kernels_.cells.bind(table_of(i));
        served.cull = kernels_.cull.bind(table_of(i));
        served.offsets = kernels_.offsets.bind(table_of(i));
        served.list = kernels_.list.bind(table_of(i));
    }
}

BufferTable CullStage::table_of(size_t index) const {
    const Batch& batch = batches_[index];
    return batch.table(group_of(batch), batch[io::kVerdictsBuffer]).set({{io::kViewBuffer, view_}});
}

void CullStage::begin(const Update& update) {
    io::CullView seen = update.view;
    seen.update_number = update_number_++;
    was_half_done_ = is_half_done_;
    is_half_done_ = seen.occlusion != 0;
    record_update(*gpu_, update.commands, view_, 0, std::span<const io::CullView>(&seen, 1));
}

void CullStage::discard() {
    --update_number_;
    is_half_done_ = was_half_done_;
    for (ServedBatch& served : served_) served.has_cells = false;
}

void CullStage::exchange(StateArchive& archive) {
    archive.value(update_number_);
    if (!archive.reads()) return;
    is_half_done_ = false;
    for (ServedBatch& served : served_) served.has_cells = false;
}

// Stays below 2^24, so that a float holds it exactly. It may wrap: by then no cell is left from so long ago.
float CullStage::version_of(const Batch& batch) const {
    constexpr uint32_t kNumbers = 1u << 24;
    return group_of(batch).moves_placements() ? 0 : static_cast<float>(1 + batch.move_count % (kNumbers - 1));
}

io::CullPush CullStage::push_of(const Batch& batch) const {
    const Group& group = group_of(batch);
    const Vec3<float> centre = (group.posed_min + group.posed_max) * 0.5f,
                      half = (group.posed_max - group.posed_min) * 0.5f;
    std::array<float, io::kLodCount> errors{};
    std::ranges::transform(group.lods, errors.begin() + 1, &Lod::error);
    const bool is_listed = group.animates_drawn_only();
    return {.centre = {centre.x, centre.y, centre.z, 0},
            .half_extent = {half.x, half.y, half.z, 0},
            .lod_errors = {errors[0], errors[1], errors[2], errors[3]},
            .instance_count = batch.used_count,
            .lod_count = static_cast<uint32_t>(1 + group.lods.size()),
            .joint_set_count = std::max(1u, static_cast<uint32_t>(group.fused.size())),
            .keeps_previous = is_listed && keeps_previous_,
            .may_skip = is_listed && may_skip_,
            .own_row_count = group.skin_pool ? group.skin_pool->row_count(batch.instance_count) : 0,
            .first_own_row = group.skin_pool ? group.skin_pool->shared_row_count : 0,
            .joint_count = group.joint_count,
            .active_clip_limit = group.controller ? group.controller->active_clip_limit : 0,
            .pose_spread = group.skin_pool ? group.skin_pool->pose_spread : 0,
            .cells_of_workgroup = cells_of_workgroup(batch.used_count),
            .placements_version = version_of(batch),
            .birth = batch.birth,
            .animates_unlisted = batch.birth != 0 && !is_listed,
            .unused0 = 0,
            .unused1 = 0};
}

template <class Dispatch>
void CullStage::for_each_batch(VkCommandBuffer commands, const Dispatch& dispatch) const {
    for (size_t i = 0; i < served_.size(); ++i) dispatch(i);
    memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite, kShaderRead | kShaderWrite | kIndirectRead);
}

// Makes cells as soon as placements stand still: an application that moves some in each update pays nothing for cells
// that would never be used again.
void CullStage::record_cells(const Update& update) {
    bool any = false;
    for (size_t i = 0; i < served_.size(); ++i) {
        const Batch& batch = batches_[i];
        const bool had_cells = served_[i].has_cells;
        served_[i].has_cells = !batch.is_moved && !group_of(batch).moves_placements();
        if (had_cells || !served_[i].has_cells) continue;
        kernels_.cells.dispatch_invocations(update.commands, served_[i].cells, push_of(batch),
                                            cell_count(batch.used_count));
        any = true;
    }
    if (any) separate_kernels(update.commands);
}

void CullStage::record(const Update& update) {
    record_cells(update);
    for_each_batch(update.commands, [&](size_t i) {
        kernels_.cull.dispatch_workgroups(update.commands, served_[i].cull, push_of(batches_[i]),
                                          cull_workgroups_of(batches_[i].used_count));
    });
    record_lists(update, false);
}

void CullStage::record_lists(const Update& update, bool is_second_half) const {
    for_each_batch(update.commands, [&](size_t i) {
        const Batch& batch = batches_[i];
        const Group& group = group_of(batch);
        io::OffsetsPush push{.workgroup_count = cull_workgroups_of(batch.used_count),
                             .section_count = static_cast<uint32_t>(group.sections.size()),
                             .own_row_count = push_of(batch).own_row_count,
                             .is_second_half = is_second_half,
                             .instances_of_workgroup = {1, 1, 1, 1}};
        const std::array of_sets{&io::uvec4::x, &io::uvec4::y, &io::uvec4::z, &io::uvec4::w};
        for (size_t set = 0; set < group.fused.size(); ++set)
            push.instances_of_workgroup.*of_sets[set] = group.fused[set].plan.scan.instances_per_workgroup;
        kernels_.offsets.dispatch_workgroups(update.commands, served_[i].offsets, push, 1);
    });
    for_each_batch(update.commands, [&](size_t i) {
        kernels_.list.dispatch_workgroups(update.commands, served_[i].list, push_of(batches_[i]),
                                          cull_workgroups_of(batches_[i].used_count));
    });
    update.end_stage("cull");
}

void CullStage::record_disoccluded(const Update& update, const DepthImage& depths) {
    if (!is_half_done_)
        throw Failure(ErrorCode::kInvalidArgument, "disoccluded",
                      "the last record() was not for a view with occlusion, or has had its record_disoccluded()");
    if (!depths.image || depths.width == 0 || depths.height == 0)
        throw Failure(ErrorCode::kInvalidArgument, "disoccluded", "the depth image is missing or empty");
    const Reveal& reveal = reveal_for(depths);
    is_half_done_ = false;
    if (update.timer) update.timer->leave_out(update.commands);
    reveal.pyramid.record(update.commands, kernels_.pyramid, depths);
    for_each_batch(update.commands, [&](size_t i) {
        const io::RevealPush push{.cull = push_of(batches_[i]),
                                  .width = depths.width,
                                  .height = depths.height,
                                  .sign = depths.reversed ? 1.0f : -1.0f};
        kernels_.reveal.dispatch_workgroups(update.commands, reveal.bindings[i], push,
                                            cull_workgroups_of(batches_[i].used_count));
    });
    record_lists(update, true);
}

const CullStage::Reveal& CullStage::reveal_for(const DepthImage& depths) {
    if (!reveals_.empty() && reveals_.back().pyramid.has_room_for(depths)) return reveals_.back();
    const bool may_double = 2 * sizeof(float) * depths.width * depths.height <=
                            gpu_->properties.limits.maxStorageBufferRange;
    Reveal made{
        DepthPyramid(gpu_, kernels_.pyramid, depths.width, (!reveals_.empty() && may_double ? 2 : 1) * depths.height),
        {}};
    for (size_t i = 0; i < served_.size(); ++i)
        made.bindings.push_back(
            kernels_.reveal.bind(table_of(i).set({{io::kCoarserDepthsBuffer, made.pyramid.levels()}})));
    reveals_.push_back(std::move(made));
    return reveals_.back();
}

std::vector<DrawnInstance> CullStage::read(uint32_t batch_index) const {
    const Batch& batch = batches_[batch_index];
    const std::vector<uint32_t> list = download<uint32_t>(gpu_, batch[io::kListBuffer]);
    const std::optional<GroupSkinPool>& pool = group_of(batch).skin_pool;
    const std::vector<uint32_t> rows = pool ? download<uint32_t>(gpu_, batch[io::kSkinRowsBuffer])
                                            : std::vector<uint32_t>();
    std::vector<DrawnInstance> drawn;
    for (uint32_t lod = 0; lod < io::kLodCount; ++lod) {
        const uint32_t end = lod + 1 < io::kLodCount ? list[io::kListBegins + lod + 1] : list[io::kListCount];
        for (uint32_t i = list[io::kListBegins + lod]; i < end; ++i) {
            const uint32_t instance = list[io::kFirstListed + i], row = pool ? rows[instance] : instance;
            drawn.push_back({.instance = batch.first_instance + instance,
                             .lod = lod,
                             .skin_row = row,
                             .shares_pose = pool && row < pool->shared_row_count});
        }
    }
    return drawn;
}

uint64_t CullStage::size_bytes() const {
    uint64_t sum = view_.size_bytes();
    for (const Reveal& reveal : reveals_) sum += reveal.pyramid.size_bytes();
    return sum;
}

}  // namespace throng
