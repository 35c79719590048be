#include "draw/native_frame.h"

#include "base/count.h"
#include "base/failure.h"
#include "draw/native_lines.h"
#include "draw/scene.h"
#include "draw/shadow_map.h"
#include "raster/casters.h"
#include "raster/coverage.h"
#include "raster/kernels.h"

#include <algorithm>
#include <bit>
#include <chrono>

namespace throng {
namespace {

constexpr uint32_t kMaxPixels = 16'384;  // along one side: the kernels count subpixels in 24 bits
constexpr VkExtent2D kLargestPictureTile{480, 270}, kLargestMapTile{1024, 1024};
constexpr uint32_t kRowsOfJob = 8, kVerticesOfJob = 1 << 14, kLinedOfJob = 256;
constexpr uint64_t kIdCount = uint64_t{1} << 32;

static_assert(sizeof(raster::Scene) == sizeof(io::DrawScene));

// A sixteenth of the picture or map, so that threads have equal work, but no more than caches hold.
VkExtent2D tile_of(const VkExtent2D& of, const VkExtent2D& largest) {
    static constexpr uint32_t kEachWay = 4, kMinimum = 64;
    const auto side = [](uint32_t whole, uint32_t most) {
        return std::min(std::max((whole + kEachWay - 1) / kEachWay, kMinimum), most);
    };
    return {side(of.width, largest.width), side(of.height, largest.height)};
}

// Milliseconds since the last call.
class Clock {
public:
    double lap_ms() {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

std::vector<uint32_t> srgb_of_linear() {
    std::vector<uint32_t> all;
    for (uint32_t i = 0; i <= raster::kSrgbSteps; ++i) {
        const double linear = static_cast<double>(i) / raster::kSrgbSteps;
        const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
        all.push_back(static_cast<uint32_t>(std::lround(255 * encoded)));
    }
    return all;
}

const VkExtent2D& checked(const VkExtent2D& extent) {
    if (extent.width == 0 || extent.height == 0)
        throw Failure(ErrorCode::kInvalidArgument, "picture", "it is empty: ", extent.width, " x ", extent.height,
                      " pixels");
    if (extent.width > kMaxPixels || extent.height > kMaxPixels)
        throw Failure(ErrorCode::kLimit, "picture",
                      std::to_string(extent.width) + " x " + std::to_string(extent.height) +
                          " exceeds the native renderer's limit of " + std::to_string(kMaxPixels) +
                          " pixels in width and height");
    return extent;
}

NativeMemory checked_memory(uint64_t needed_bytes, std::string_view what) {
    if (needed_bytes > NativeDevice::memory_bytes())
        throw Failure(ErrorCode::kLimit, "render",
                      std::to_string(needed_bytes >> 20) + " MiB of " + std::string(what) +
                          " exceed this machine's memory of " + std::to_string(NativeDevice::memory_bytes() >> 20) +
                          " MiB");
    return NativeMemory(needed_bytes);
}

}  // namespace

NativeFrame::NativeFrame(std::shared_ptr<Gpu> gpu, VkExtent2D extent, uint32_t samples, NativeIsa isa)
    : gpu_(std::move(gpu)), extent_(checked(extent)), kernel_(raster::kernel_of(isa)), srgb_(srgb_of_linear()) {
    frame_.width = extent.width;
    frame_.height = extent.height;
    frame_.sample_count = samples;
    frame_.map_size = shadow_map_size(extent, samples);
    map_ = checked_memory(uint64_t{frame_.map_size} * frame_.map_size * sizeof(float), "shadow map");
    samples_ = checked_memory(uint64_t{extent.width} * extent.height * samples * sizeof(uint64_t), "samples");
    frame_.map = reinterpret_cast<float*>(map_.bytes());
    frame_.samples = reinterpret_cast<uint64_t*>(samples_.bytes());
    frame_.srgb = srgb_.data();
}

void NativeFrame::draw(Crowds crowds, std::span<const NativeGroups> native, const Camera& camera,
                       const DrawOptions& options, const NativePixels& pixels) {
    Clock clock;
    times_ = {};
    scene_ = make_scene(bounds_of(crowds, Outliers::kLeftOut), camera, extent_, frame_.map_size, options);
    std::memcpy(&frame_.scene, &scene_, sizeof scene_);
    frame_.pixels = pixels.bytes;
    frame_.blue_first = pixels.blue_first;
    set_drawn(crowds, native);
    list(options);
    times_.list_ms = clock.lap_ms();
    skin();
    sort_by_distance();
    times_.skin_ms = clock.lap_ms();
    if (options.shadows) {
        raster::count_casters(frame_, casters_);
        frame_.casters = casters_.data();
        draw_tiles({frame_.map_size, frame_.map_size}, kLargestMapTile, map_is_clear_, kernel_.draw_map);
    }
    times_.shadow_ms = clock.lap_ms();
    draw_tiles(extent_, kLargestPictureTile, picture_is_clear_, kernel_.draw_picture);
    times_.picture_ms = clock.lap_ms();
    resolve();
    times_.resolve_ms = clock.lap_ms();
}

// The memory of lists is kept from picture to picture.
void NativeFrame::set_drawn(Crowds crowds, std::span<const NativeGroups> native) {
    size_t count = 0;
    for (const CrowdState* crowd : crowds) count += crowd->batches.size();
    drawn_.resize(count);
    size_t b = 0;
    uint32_t first_layer = 0;
    for (size_t i = 0; i < crowds.size(); ++i) {
        for (const Batch& batch : crowds[i]->batches) {
            Drawn& drawn = drawn_[b++];
            drawn.crowd = crowds[i];
            drawn.native = native[i][batch.group];
            drawn.batch = &batch;
            drawn.first_layer = first_layer + batch.first_instance;
        }
        first_layer += crowds[i]->instance_count;
    }
}

void NativeFrame::list(const DrawOptions& options) {
    NativeView view(scene_, options.shadows);
    draws_.clear();
    posed_.clear();
    frame_.has_colors = false;
    uint64_t next_id = 0;
    for (uint32_t b = 0; b < drawn_.size(); ++b) {
        list_instances(*drawn_[b].batch, drawn_[b].list);
        view.keep_seen(drawn_[b].group(), *drawn_[b].batch, *gpu_->processor, drawn_[b].list);
        add_draws(b, next_id);
    }
    add_lines(options);
    give_ids(next_id);
    give_memory();
    divide();
}

// What is not shown is drawn as a section without triangles.
void NativeFrame::set_look(const NativeGroup& group, const NativeLook& look, raster::Draw& draw) {
    static constexpr raster::Section kNothing{};
    if (look.material == kNone) {
        draw.section = &kNothing;
        draw.picture_box[2] = draw.map_box[2] = -1;  // in no tile
        return;
    }
    draw.material = &group.material(look.material);
    draw.color[0] = look.color.x;
    draw.color[1] = look.color.y;
    draw.color[2] = look.color.z;
}

// Section by section, level by level, instance by instance, as the device draws them.
void NativeFrame::add_draws(uint32_t b, uint64_t& next_id) {
    Drawn& drawn = drawn_[b];
    const NativeMesh& mesh = drawn.mesh();
    const auto* const placements = reinterpret_cast<const Affine*>((*drawn.batch)[io::kPlacementsBuffer].mapped());
    const NativeLooks looks(drawn.group(), *drawn.batch);
    const float size = size_at_rest(drawn.group());
    frame_.has_colors = frame_.has_colors || looks;
    const NativeList& list = drawn.list;
    drawn.first_draws.assign(mesh.lod_count() * mesh.section_count(), kNone);
    for (size_t s = 0; s < mesh.section_count(); ++s)
        for (uint32_t lod = 0; lod < mesh.lod_count(); ++lod) {
            const NativeSection* const section = mesh.at(lod, s);
            if (!section) continue;
            const raster::Material* const of_all = looks ? nullptr
                                                         : &drawn.native->material(
                                                               drawn.group().section_materials[s].front());
            drawn.first_draws[lod * mesh.section_count() + s] = static_cast<uint32_t>(draws_.size());
            for (uint32_t place = list.begins[lod]; place < list.begins[lod + 1]; ++place) {
                const uint32_t instance = list.instances[place];
                raster::Draw& draw = draws_.emplace_back(raster::Draw{
                    .section = &section->section,
                    .material = of_all,
                    .first_id = static_cast<uint32_t>(next_id),
                    .layer = raster::coverage_layer(drawn.first_layer + instance, static_cast<uint32_t>(s)),
                    .is_mirrored = determinant(placements[instance]) < 0,
                    .size = placed_size(size, placements[instance])});
                if (looks) set_look(*drawn.native, looks.of(instance, static_cast<uint32_t>(s)), draw);
                next_id += rounded_up(draw.section->triangle_count, raster::kIdBlock);
            }
        }
    for (uint32_t lod = 0; lod < mesh.lod_count(); ++lod)
        for (uint32_t place = list.begins[lod]; place < list.begins[lod + 1]; ++place)
            posed_.push_back({.batch = b, .lod = lod, .place = place});
}

void NativeFrame::add_lines(const DrawOptions& options) {
    lines_.clear();
    const auto add = [&](const auto& add_of_instance) {
        NativeList list;
        for (const Drawn& drawn : drawn_) {
            list_instances(*drawn.batch, list);
            const auto count = static_cast<uint32_t>(list.instances.size());
            std::vector<std::vector<raster::Line>> parts((count + kLinedOfJob - 1) / kLinedOfJob);
            for_each_job(gpu_->processor->jobs(), static_cast<uint32_t>(parts.size()), [&](uint32_t part) {
                for (uint32_t i = part * kLinedOfJob; i < std::min((part + 1) * kLinedOfJob, count); ++i)
                    add_of_instance(drawn, drawn.posed(list.instances[i]), parts[part]);
            });
            for (const auto& part : parts) lines_.insert(lines_.end(), part.begin(), part.end());
        }
    };
    if (options.bounds)
        add([&](const Drawn&, const PosedInstance& of, std::vector<raster::Line>& lines) {
            add_box_lines(scene_, of.placement(), {of.group.posed_min, of.group.posed_max}, lines);
        });
    frame_.depth_tested_count = static_cast<uint32_t>(lines_.size());
    if (options.skeletons)
        add([&](const Drawn& drawn, const PosedInstance& of, std::vector<raster::Line>& lines) {
            add_skeleton_lines(scene_, of.placement(), drawn.native->joint_levels(), of.group.level_count,
                               reinterpret_cast<const Affine*>(of.batch[io::kModelBuffer].mapped()) +
                                   size_t{of.instance} * of.group.joint_count,
                               lines);
        });
    // The line added last lies on top of all others, so it comes first (raster::Frame::lines)
    std::reverse(lines_.begin() + frame_.depth_tested_count, lines_.end());
    frame_.lines = lines_.data();
    frame_.line_count = static_cast<uint32_t>(lines_.size());
}

void NativeFrame::give_ids(uint64_t id_count) {
    const uint64_t needed = id_count + 2 * uint64_t{lines_.size()};
    if (needed >= kIdCount)
        throw Failure(ErrorCode::kLimit, "render",
                      "the picture needs " + std::to_string(needed) +
                          " triangle numbers, more than the native renderer's limit of " +
                          std::to_string(kIdCount - 1));
    frame_.first_line_id = static_cast<uint32_t>(id_count);
    draw_of_ids_.clear();
    for (uint32_t draw = 0; draw < draws_.size(); ++draw) {
        const uint64_t end = draw + 1 < draws_.size() ? draws_[draw + 1].first_id : id_count;
        draw_of_ids_.insert(draw_of_ids_.end(), (end - draws_[draw].first_id) / raster::kIdBlock, draw);
        times_.triangles += draws_[draw].section->triangle_count;
    }
    frame_.draws = draws_.data();
    frame_.draw_count = static_cast<uint32_t>(draws_.size());
    frame_.draw_of_ids = draw_of_ids_.data();
}

void NativeFrame::give_memory() {
    frame_.max_vertices = 0;
    uint64_t block_count = 0;
    for (const raster::Draw& draw : draws_) {
        frame_.max_vertices = std::max(frame_.max_vertices, draw.section->vertex_count);
        times_.vertices += draw.section->vertex_count;
        block_count += rounded_up(draw.section->vertex_count, raster::kBlock) / raster::kBlock;
    }
    const uint64_t needed_bytes = block_count * raster::kBlockFloats * sizeof(float);
    if (needed_bytes > vertices_bytes_) {
        vertices_bytes_ = 0;
        vertices_ = NativeMemory();
        vertices_ = checked_memory(needed_bytes + needed_bytes / 4, "skinned vertices");
        vertices_bytes_ = needed_bytes + needed_bytes / 4;
    }
    auto* next = reinterpret_cast<float*>(vertices_.bytes());
    for (raster::Draw& draw : draws_) {
        draw.vertices = next;
        next += rounded_up(draw.section->vertex_count, raster::kBlock) / raster::kBlock * raster::kBlockFloats;
    }
}

// Divides the instances into jobs of about equal work.
void NativeFrame::divide() {
    jobs_.clear();
    uint32_t first = 0;
    uint64_t vertex_count = 0;
    for (uint32_t i = 0; i < posed_.size(); ++i) {
        vertex_count += drawn_[posed_[i].batch].mesh().vertex_count(posed_[i].lod);
        if (vertex_count < kVerticesOfJob && i + 1 < posed_.size()) continue;
        jobs_.push_back({first, i + 1});
        first = i + 1;
        vertex_count = 0;
    }
    times_.instances = posed_.size();
}

void NativeFrame::skin() {
    for_each_job(gpu_->processor->jobs(), static_cast<uint32_t>(jobs_.size()), [&](uint32_t job) {
        scratch_.with([&](NativeScratch& scratch) {
            for (uint32_t i = jobs_[job].first; i < jobs_[job].end; ++i) skin_instance(posed_[i], scratch);
        });
    });
}

void NativeFrame::skin_instance(const Posed& posed, NativeScratch& scratch) {
    const Drawn& drawn = drawn_[posed.batch];
    const CrowdState& crowd = *drawn.crowd;
    const Group& group = drawn.group();
    const NativeMesh& mesh = drawn.mesh();
    const PosedInstance of = drawn.posed(drawn.list.instances[posed.place]);
    const bool is_linear = crowd.skin_blend == SkinBlend::kLinear, is_morphed = !crowd.skins_once && of.is_morphed();
    const std::span<const uint32_t> entries = mesh.entries(posed.lod);
    if (entries.empty()) return;  // nothing to draw

    float* columns = nullptr;
    std::byte* similarities = nullptr;
    if (!crowd.skins_once && is_linear) {
        const float* matrices = reinterpret_cast<const float*>(of.skin(crowd.skin_format));
        if (crowd.skin_format != SkinFormat::kAffine || entries.size() < group.palette_count) {
            auto* const unpacked = scratch.items<Affine>(NativeScratch::kMatrices, entries.size());
            unpack_skin_matrices(crowd.skin_format, of, entries, unpacked);
            matrices = unpacked->row[0].data();
        }
        columns = scratch.items<float>(NativeScratch::kColumns, 16 * entries.size());
        kernel_.place(of.placement().row[0].data(), matrices, static_cast<uint32_t>(entries.size()), columns);
    } else if (!crowd.skins_once) {
        similarities = scratch.bytes(NativeScratch::kMatrices, size_t{group.palette_count} * kSimilarity_bytes);
        unpack_similarities(crowd.skin_format, of, similarities);
    }
    for (size_t s = 0; s < mesh.section_count(); ++s) {
        const NativeSection* const section = mesh.at(posed.lod, s);
        if (!section) continue;
        const uint32_t first_draw = drawn.first_draws[posed.lod * mesh.section_count() + s];
        raster::Draw& draw = draws_[first_draw + posed.place - drawn.list.begins[posed.lod]];
        if (draw.section->triangle_count == 0) continue;
        const size_t float_count = whole_blocks(section->section.vertex_count) * kBindFloats;
        const float* bind = section->section.bind;
        if (is_morphed && !section->moved.empty()) {
            auto* const morphed = scratch.items<float>(NativeScratch::kBind, float_count);
            morph_vertices(of, *section, morphed);
            bind = morphed;
        }
        if (columns) {
            kernel_.skin(frame_, columns, bind, draw);
            continue;
        }
        auto* const world = scratch.items<float>(NativeScratch::kWorld, float_count);
        if (crowd.skins_once)
            place_skinned(of, *section, world);
        else
            blend_dual_quaternions(of, *section, similarities, bind, world);
        kernel_.keep(frame_, world, draw);
    }
}

void NativeFrame::sort_by_distance() {
    distances_.clear();
    for (uint32_t draw = 0; draw < draws_.size(); ++draw)
        distances_.push_back(uint64_t{~std::bit_cast<uint32_t>(draws_[draw].nearest)} << 32 | draw);
    std::ranges::sort(distances_);
    nearest_first_.clear();
    for (const uint64_t distance : distances_) nearest_first_.push_back(static_cast<uint32_t>(distance));
    frame_.nearest_first = nearest_first_.data();
}

template <class Draw>
void NativeFrame::draw_tiles(VkExtent2D of, VkExtent2D largest, std::vector<uint8_t>& are_clear, const Draw& draw) {
    const VkExtent2D tile = tile_of(of, largest);
    const uint32_t columns = (of.width + tile.width - 1) / tile.width,
                   rows = (of.height + tile.height - 1) / tile.height;
    are_clear.resize(columns * rows, 1);
    for_each_job(gpu_->processor->jobs(), columns * rows, [&](uint32_t i) {
        const uint32_t x = i % columns * tile.width, y = i / columns * tile.height;
        const raster::Tile part{x, y, std::min(x + tile.width, of.width), std::min(y + tile.height, of.height)};
        scratch_.with([&](NativeScratch& scratch) {
            std::byte* const bytes = scratch.bytes(NativeScratch::kKernel, kernel_.scratch_bytes(frame_));
            are_clear[i] = draw(frame_, part, are_clear[i] != 0, bytes);
        });
    });
}

void NativeFrame::resolve() {
    for_each_job(gpu_->processor->jobs(), (frame_.height + kRowsOfJob - 1) / kRowsOfJob, [&](uint32_t i) {
        scratch_.with([&](NativeScratch& scratch) {
            kernel_.resolve(frame_, i * kRowsOfJob, std::min((i + 1) * kRowsOfJob, frame_.height),
                            scratch.bytes(NativeScratch::kKernel, kernel_.scratch_bytes(frame_)));
        });
    });
}

}  // namespace throng
