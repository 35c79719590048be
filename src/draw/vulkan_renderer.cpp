#include "draw/vulkan_renderer.h"

#include "base/failure.h"
#include "draw/shadow_map.h"

#include <algorithm>

namespace throng {
namespace {

constexpr Access kDrawRead{
    VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
    VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};

std::shared_ptr<Gpu> with_graphics(std::shared_ptr<Gpu> gpu) {
    if (!gpu->has_graphics())
        throw Failure(ErrorCode::kNoDevice, "renderer",
                      "queue family " + std::to_string(gpu->queue_family) + " of " + gpu->info.name +
                          " does not support graphics");
    return gpu;
}

VkSampleCountFlagBits lower_samples(const Gpu& gpu, uint32_t wanted) {
    const VkSampleCountFlags available = gpu.properties.limits.framebufferColorSampleCounts &
                                         gpu.properties.limits.framebufferDepthSampleCounts;
    for (uint32_t samples = VK_SAMPLE_COUNT_64_BIT; samples > 1; samples /= 2)
        if (samples <= wanted && (available & samples)) return static_cast<VkSampleCountFlagBits>(samples);
    return VK_SAMPLE_COUNT_1_BIT;
}

bool culls(const CrowdState* crowd) { return crowd->cull != nullptr; }

}  // namespace

VulkanRenderer::VulkanRenderer(std::shared_ptr<Gpu> gpu_in, const RendererSettings& settings)
    : RendererState(with_graphics(std::move(gpu_in)), settings.options),
      samples_(lower_samples(*gpu, settings.samples)),
      blue_first_(settings.blue_first),
      targets_(gpu, {settings.width, settings.height}, samples_, blue_first_),
      shadow_map_(make_shadow_map(gpu, targets_.extent(), samples_)),
      stamps_(gpu, 4),  // around the occluders, and around the rest
      layout_(make_draw_layout(gpu)),
      pipelines_{gpu, layout_.get(), samples_, color_format(blue_first_)},
      sampling_(gpu),
      uploads_(gpu),
      scene_(gpu, layout_, shadow_map_),
      ground_(make_ground_pipeline(pipelines_)) {}

void VulkanRenderer::resize(VkExtent2D extent) {
    Targets resized(gpu, extent, samples_, blue_first_);
    DepthPass map = make_shadow_map(gpu, extent, samples_);
    scene_ = SceneBinding(gpu, layout_, map);
    targets_ = std::move(resized);
    occluders_.reset();
    shadow_map_ = std::move(map);
}

RenderResult VulkanRenderer::render(Crowds crowds, const Camera& camera) {
    Frame frame = frame_of(crowds, camera, Upload::kAtOnce);
    targets_.make_read_back();
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        record_frame(commands, frame);
        targets_.record_read_back(commands);
    });
    return result_of(frame);
}

RenderResult VulkanRenderer::render_frame(Crowds crowds, float time_step_s, const Camera& camera) {
    Frame frame = frame_of(crowds, camera, Upload::kAtOnce);
    std::vector<CrowdState*> native, others;
    for (CrowdState* crowd : crowds) (crowd->updates_natively(options.occlusion) ? native : others).push_back(crowd);
    CrowdView view = view_of(frame.bounds, camera);
    view.occlusion = makes_room_for_occlusion(others);
    targets_.make_read_back();
    for (CrowdState* crowd : native) crowd->update(time_step_s, crowd->cull ? &view : nullptr);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        record_all(commands, others, time_step_s, view, frame);
        targets_.record_read_back(commands);
    });
    return result_of(frame);
}

void VulkanRenderer::record(VkCommandBuffer commands, Crowds crowds, float time_step_s, const Camera& camera) {
    Frame frame = frame_of(crowds, camera, Upload::kInFrame);
    CrowdView view = view_of(frame.bounds, camera);
    view.occlusion = makes_room_for_occlusion(crowds);
    record_all(commands, crowds, time_step_s, view, frame);
}

void VulkanRenderer::prepare(Crowds crowds) {
    accept(crowds, true);
    for (const CrowdState* crowd : crowds) drawing_of(*crowd, Upload::kInFrame);
}

CrowdDrawing VulkanRenderer::drawing_of(const CrowdState& crowd, Upload upload) {
    CharacterKind kind{crowd.skin_format, crowd.skin_blend, crowd.cull != nullptr, crowd.skins_once};
    for (const Group& group : crowd.groups)
        for (const AssetMaterial& material : group.materials)
            kind.has_blends = kind.has_blends || material.alpha_mode == AlphaMode::kBlend;
    const auto pipelines_of = [&](bool has_looks) {
        kind.has_looks = has_looks;
        return &characters_.try_emplace(kind, pipelines_, kind).first->second;
    };
    const CharacterPipelines& characters = *pipelines_of(false);
    const CharacterPipelines* const with_looks = crowd.looks ? pipelines_of(true) : nullptr;
    const LinePipelines* lines = nullptr;
    if (options.skeletons || options.bounds)
        lines = &lines_.try_emplace(kind.listed, pipelines_, kind.listed).first->second;
    return {crowd, bindings_of(crowd, upload), layout_, characters, with_looks, lines};
}

std::vector<const GroupBindings*> VulkanRenderer::bindings_of(const CrowdState& crowd, Upload upload) {
    return groups_.of(crowd, [&](std::span<const uint32_t> new_groups) {
        auto uploads = std::make_unique<Uploads>(
            gpu, upload == Upload::kAtOnce ? Uploads::kMaxStaged_bytes : Uploads::kUnlimited_bytes);
        uint64_t room_bytes = kTexturesLimit_bytes;
        std::vector<std::unique_ptr<const GroupBindings>> made;
        for (const uint32_t group : new_groups)
            made.push_back(std::make_unique<const GroupBindings>(*uploads, layout_, sampling_, crowd, group, room_bytes,
                                                                 textures_));
        if (upload == Upload::kAtOnce)
            uploads->finish();
        else
            uploads_.add(std::move(uploads));
        return made;
    });
}

VulkanRenderer::Frame VulkanRenderer::frame_of(Crowds crowds, const Camera& camera, Upload upload) {
    accept(crowds, upload == Upload::kAtOnce);
    Frame frame;
    uint32_t first_layer = 0;
    for (const CrowdState* crowd : crowds) {
        CrowdDrawing& drawing = frame.drawings.emplace_back(drawing_of(*crowd, upload));
        drawing.first_layer = first_layer;
        drawing.find_mirrors();
        first_layer += crowd->instance_count;
    }
    frame.bounds = bounds_of(crowds, Outliers::kLeftOut);
    frame.scene = make_scene(frame.bounds, camera, targets_.extent(), shadow_map_.extent().width, options);
    return frame;
}

void VulkanRenderer::record_drawing(VkCommandBuffer commands, Crowds crowds, const Camera& camera) {
    Frame frame = frame_of(crowds, camera, Upload::kInFrame);
    record_frame(commands, frame);
}

bool VulkanRenderer::makes_room_for_occlusion(Crowds crowds) {
    const bool tests_occlusion = options.occlusion && std::ranges::any_of(crowds, culls) &&
                                 (gpu->properties.limits.sampledImageDepthSampleCounts & samples_);
    if (!tests_occlusion) return false;
    if (!occluders_) occluders_.emplace(gpu, targets_.extent(), samples_);
    for (CrowdState* crowd : crowds)
        if (culls(crowd)) crowd->cull->make_room_for(occluders_->depths());
    return true;
}

void VulkanRenderer::record_all(VkCommandBuffer commands, Crowds crowds, float time_step_s, const CrowdView& view,
                                Frame& frame) {
    size_t recorded_count = 0;
    try {
        for (; recorded_count < crowds.size(); ++recorded_count) {
            CrowdState& crowd = *crowds[recorded_count];
            crowd.record(commands, time_step_s, culls(&crowd) ? &view : nullptr);
        }
        if (view.occlusion) record_occlusion(commands, crowds, frame);
        record_frame(commands, frame);
    } catch (...) {  // no crowd's time advances, except that of the one that failed, if it had begun
        for (CrowdState* crowd : crowds.first(recorded_count)) crowd->discard_last_record();
        throw;
    }
}

// Draws what each crowd has listed so far (what was visible in its last update and is in view), then lists the rest of
// what these depths do not hide.
void VulkanRenderer::record_occlusion(VkCommandBuffer commands, Crowds crowds, Frame& frame) {
    begin_draw(commands, frame);
    occluders_->begin(commands);
    for (const CrowdDrawing& drawing : frame.drawings) drawing.draw(commands, DrawPass::kOccluders);
    occluders_->end(commands);
    stamps_.write(commands);
    for (CrowdState* crowd : crowds)
        if (culls(crowd)) crowd->record_disoccluded(commands, occluders_->depths());
}

// Binds the scene, makes what the crowds' updates have written visible to draws, and starts timing them.
void VulkanRenderer::begin_draw(VkCommandBuffer commands, Frame& frame) {
    if (!frame.has_begun) uploads_.record(commands);
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kDrawRead);
    scene_.record(commands, frame.scene);
    const VkDescriptorSet scene_set = scene_.set();
    gpu->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), kSceneSet, 1, &scene_set,
                                    0, nullptr);
    if (!std::exchange(frame.has_begun, true)) stamps_.begin(commands);
    stamps_.write(commands);
}

void VulkanRenderer::record_frame(VkCommandBuffer commands, Frame& frame) {
    begin_draw(commands, frame);
    // Without shadows the map is empty: the scene says not to look at it.
    shadow_map_.begin(commands);
    if (options.shadows)
        for (const CrowdDrawing& drawing : frame.drawings) drawing.draw(commands, DrawPass::kShadow);
    shadow_map_.end(commands);
    draw_picture(commands, frame.drawings);
    stamps_.write(commands);
    stamps_.publish(commands);
}

// The time of the newest frame that has finished: from each stamp at which drawing begins to the next, where it ends.
double VulkanRenderer::draw_ms() const {
    double sum_ms = 0;
    if (const std::optional<Timestamps::Frame> frame = stamps_.newest())
        for (size_t i = 1; i < frame->ms.size(); i += 2) sum_ms += frame->ms[i] - frame->ms[i - 1];
    return sum_ms;
}

// Ground, characters over it, lines over both.
void VulkanRenderer::draw_picture(VkCommandBuffer commands, const std::vector<CrowdDrawing>& drawings) const {
    targets_.begin(commands);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, ground_.get());
    gpu->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    for (const CrowdDrawing& drawing : drawings) drawing.draw(commands, DrawPass::kPicture);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    for (const CrowdDrawing& drawing : drawings)
        if (options.bounds) drawing.draw_bounds(commands);
    for (const CrowdDrawing& drawing : drawings)
        if (options.skeletons) drawing.draw_skeletons(commands);
    targets_.end(commands);
}

RenderResult VulkanRenderer::result_of(const Frame& frame) const {
    RenderResult result{.picture = targets_.read_back(), .draw_ms = draw_ms(), .warnings = {}};
    for (const CrowdDrawing& drawing : frame.drawings)
        for (const GroupBindings* const group : drawing.groups)
            if (group) result.warnings.insert(result.warnings.end(), group->warnings.begin(), group->warnings.end());
    return result;
}

}  // namespace throng
