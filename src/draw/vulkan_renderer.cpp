#include "draw/vulkan_renderer.h"

#include "base/failure.h"
#include "draw/shadow_map.h"

namespace throng {
namespace {

constexpr Access kDrawRead{
    VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
    VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};

std::shared_ptr<Gpu> with_graphics(std::shared_ptr<Gpu> gpu) {
    if (!gpu->has_graphics())
        throw Failure(
            ErrorCode::kNoDevice, "renderer",
            "queue family " + std::to_string(gpu->queue_family) + " of " + gpu->info.name + " has no graphics");
    return gpu;
}

VkSampleCountFlagBits lower_samples(const Gpu& gpu, uint32_t wanted) {
    const VkSampleCountFlags available = gpu.properties.limits.framebufferColorSampleCounts &
                                         gpu.properties.limits.framebufferDepthSampleCounts;
    for (uint32_t samples = VK_SAMPLE_COUNT_64_BIT; samples > 1; samples /= 2)
        if (samples <= wanted && (available & samples)) return static_cast<VkSampleCountFlagBits>(samples);
    return VK_SAMPLE_COUNT_1_BIT;
}

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

RenderResult VulkanRenderer::render(const Crowd& crowd, const Camera& camera) {
    Frame frame = frame_of(crowd, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        crowd.state().record_uploads(commands);
        record_frame(commands, frame);
        targets_.record_read_back(commands);
    });
    return result_of(frame);
}

RenderResult VulkanRenderer::render_frame(Crowd& crowd, float time_step_s, const Camera& camera) {
    Frame frame = frame_of(crowd, camera);
    const bool is_native = crowd.state().is_native(options.occlusion);
    if (is_native) update(crowd, time_step_s, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        if (!is_native) record_update(commands, crowd, time_step_s, camera, frame);
        record_frame(commands, frame);
        targets_.record_read_back(commands);
    });
    return result_of(frame);
}

void VulkanRenderer::record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) {
    Frame frame = frame_of(crowd, camera);
    record_update(commands, crowd, time_step_s, camera, frame);
    record_frame(commands, frame);
}

void VulkanRenderer::prepare(const Crowd& crowd) { drawing_of(crowd); }

CrowdDrawing VulkanRenderer::drawing_of(const Crowd& crowd) {
    accept(crowd);
    const CrowdState& state = crowd.state();
    VertexKind kind{state.skin_format, state.skin_blend, state.cull != nullptr, state.skins_once};
    const auto pipelines_of = [&](bool has_looks) {
        kind.has_looks = has_looks;
        return &characters_.try_emplace(kind, pipelines_, kind).first->second;
    };
    const CharacterPipelines& characters = *pipelines_of(false);
    const CharacterPipelines* const with_looks = state.looks ? pipelines_of(true) : nullptr;
    const LinePipelines* lines = nullptr;
    if (options.skeletons || options.bounds)
        lines = &lines_.try_emplace(kind.listed, pipelines_, kind.listed).first->second;
    const CrowdBindings& bindings = crowds_.of(
        state, [&] { return std::make_unique<const CrowdBindings>(layout_, sampling_, state); });
    return {state, bindings, layout_, characters, with_looks, lines};
}

VulkanRenderer::Frame VulkanRenderer::frame_of(const Crowd& crowd, const Camera& camera) {
    const CrowdDrawing drawing = drawing_of(crowd);
    return {drawing, make_scene(crowd.state(), camera, targets_.extent(), shadow_map_.extent().width, options)};
}

void VulkanRenderer::record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera) {
    Frame frame = frame_of(crowd, camera);
    crowd.state().record_uploads(commands);
    record_frame(commands, frame);
}

void VulkanRenderer::record_update(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera,
                                   Frame& frame) {
    CrowdState& state = crowd.state();
    if (!state.cull) return state.record(commands, time_step_s, nullptr);
    CrowdView view = view_of(crowd, camera);
    view.occlusion = options.occlusion && (gpu->properties.limits.sampledImageDepthSampleCounts & samples_);
    state.record(commands, time_step_s, &view);
    if (!view.occlusion) return;
    if (!occluders_) occluders_.emplace(gpu, targets_.extent(), samples_);
    begin_draw(commands, frame);
    occluders_->begin(commands);
    frame.drawing.draw(commands, DrawPass::kOccluders);
    occluders_->end(commands);
    stamps_.write(commands);
    state.record_disoccluded(commands, occluders_->depths());
}

// Binds the scene; what the crowd's update has written becomes visible to draws. Their time begins.
void VulkanRenderer::begin_draw(VkCommandBuffer commands, Frame& frame) {
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
    if (options.shadows) frame.drawing.draw(commands, DrawPass::kShadow);
    shadow_map_.end(commands);
    draw_picture(commands, frame.drawing);
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
void VulkanRenderer::draw_picture(VkCommandBuffer commands, const CrowdDrawing& drawing) const {
    targets_.begin(commands);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, ground_.get());
    gpu->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    drawing.draw(commands, DrawPass::kPicture);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    if (options.bounds) drawing.draw_bounds(commands);
    if (options.skeletons) drawing.draw_skeletons(commands);
    targets_.end(commands);
}

RenderResult VulkanRenderer::result_of(const Frame& frame) const {
    return {.picture = targets_.read_back(), .draw_ms = draw_ms(), .warnings = frame.drawing.bindings.warnings};
}

}  // namespace throng
