#include <throng/draw.h>

#include "base/failure.h"
#include "draw/camera.h"
#include "draw/crowd_bindings.h"
#include "draw/draw_crowd.h"
#include "draw/draw_timer.h"
#include "draw/occluders.h"
#include "draw/pipeline.h"
#include "draw/scene.h"
#include "draw/targets.h"

#include <map>

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

struct RendererState {
    RendererState(std::shared_ptr<Gpu> gpu, const RendererSettings& settings);

    RenderResult render(const Crowd& crowd, const Camera& camera);
    RenderResult render_frame(Crowd& crowd, float time_step_s, const Camera& camera);
    void record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera);
    void resize(uint32_t width, uint32_t height);

    std::shared_ptr<Gpu> gpu;
    VkSampleCountFlagBits samples;
    DrawOptions options;
    Targets targets;
    ShadowMap shadow_map;
    DrawTimer timer;

private:
    // What a frame needs; making it may fail, or submit, so it comes before anything is recorded.
    struct Frame {
        const CrowdState& crowd;
        const CrowdBindings& bindings;
        const CharacterPipelines& characters;
        const LinePipelines* lines;  // where an option draws some
        io::DrawScene scene;
    };
    Frame prepare(const Crowd& crowd, const Camera& camera);
    const CharacterPipelines& pipelines_of(const CrowdState& crowd);
    const LinePipelines& lines_of(const CrowdState& crowd);
    void record_update(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera,
                       const Frame& frame);
    void bind_scene(VkCommandBuffer commands, const Frame& frame) const;
    void record_frame(VkCommandBuffer commands, const Frame& frame);
    void draw_shadows(VkCommandBuffer commands, const Frame& frame) const;
    void draw_picture(VkCommandBuffer commands, const Frame& frame) const;
    RenderResult result_of(const Frame& frame) const;

    DrawLayouts layouts_;
    MaterialSampling sampling_;
    SceneBinding scene_;
    OwnedPipeline ground_;
    std::map<VertexKind, CharacterPipelines> characters_;
    std::map<bool, LinePipelines> lines_;  // by the latter
    CrowdBindingsCache crowds_;
    std::optional<Occluders> occluders_;  // made when first needed
};

RendererState::RendererState(std::shared_ptr<Gpu> gpu_in, const RendererSettings& settings)
    : gpu(with_graphics(std::move(gpu_in))),
      samples(lower_samples(*gpu, settings.samples)),
      options(checked(settings.options)),
      targets(gpu, settings.width, settings.height, samples),
      shadow_map(gpu, settings.width, settings.height),
      timer(gpu),
      layouts_(gpu),
      sampling_(gpu),
      scene_(gpu, layouts_.scene_set.get(), shadow_map),
      ground_(make_ground_pipeline(gpu, layouts_, samples)) {}

void RendererState::resize(uint32_t width, uint32_t height) {
    Targets resized(gpu, width, height, samples);
    ShadowMap map(gpu, width, height);
    scene_ = SceneBinding(gpu, layouts_.scene_set.get(), map);
    targets = std::move(resized);
    occluders_.reset();
    shadow_map = std::move(map);
}

RenderResult RendererState::render(const Crowd& crowd, const Camera& camera) {
    const Frame frame = prepare(crowd, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        record_frame(commands, frame);
        targets.record_read_back(commands);
    });
    return result_of(frame);
}

RenderResult RendererState::render_frame(Crowd& crowd, float time_step_s, const Camera& camera) {
    const Frame frame = prepare(crowd, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        record_update(commands, crowd, time_step_s, camera, frame);
        record_frame(commands, frame);
        targets.record_read_back(commands);
    });
    return result_of(frame);
}

void RendererState::record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) {
    const Frame frame = prepare(crowd, camera);
    record_update(commands, crowd, time_step_s, camera, frame);
    record_frame(commands, frame);
}

RendererState::Frame RendererState::prepare(const Crowd& crowd, const Camera& camera) {
    const CrowdState& state = crowd.state();
    if (state.gpu != gpu) throw Failure(ErrorCode::kInvalidArgument, "render", "the crowd lives on another device");
    if (options.skeletons && !state.batches.front()[io::kModelBuffer].handle())
        throw Failure(ErrorCode::kInvalidArgument, "skeletons",
                      "the crowd keeps no model matrices; set CrowdSettings::keep_model_matrices");
    const io::DrawScene scene = make_scene(state, camera, targets.extent(), shadow_map.size(), options);
    return {state, crowds_.of(gpu, layouts_, sampling_, state), pipelines_of(state),
            options.skeletons || options.bounds ? &lines_of(state) : nullptr, scene};
}

const CharacterPipelines& RendererState::pipelines_of(const CrowdState& crowd) {
    const VertexKind kind{crowd.skin_format, crowd.skin_blend, crowd.cull != nullptr, crowd.skins_once};
    const auto found = characters_.find(kind);
    return found != characters_.end()
               ? found->second
               : characters_.emplace(kind, CharacterPipelines(gpu, layouts_, samples, kind)).first->second;
}

const LinePipelines& RendererState::lines_of(const CrowdState& crowd) {
    const bool listed = crowd.cull != nullptr;
    const auto found = lines_.find(listed);
    return found != lines_.end() ? found->second
                                 : lines_.emplace(listed, LinePipelines(gpu, layouts_, samples, listed)).first->second;
}

void RendererState::record_update(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera,
                                  const Frame& frame) {
    CrowdState& state = crowd.state();
    if (!state.cull) return state.record(commands, time_step_s, nullptr);
    CrowdView view = crowd_view_of(camera, targets.width(), targets.height(), world_bounds(crowd), options);
    view.occlusion = options.occlusion && (gpu->properties.limits.sampledImageDepthSampleCounts & samples);
    state.record(commands, time_step_s, &view);
    if (!view.occlusion) return;
    if (!occluders_) occluders_.emplace(gpu, targets.width(), targets.height(), samples);
    bind_scene(commands, frame);
    timer.begin_occluders(commands);
    occluders_->begin(commands);
    draw_crowd(commands, frame.crowd, frame.bindings, layouts_.layout.get(), frame.characters, DrawPass::kOccluders);
    occluders_->end(commands);
    timer.end_occluders(commands);
    state.record_disoccluded(commands, occluders_->depths());
}

// And what the crowd's update has written becomes visible to draws.
void RendererState::bind_scene(VkCommandBuffer commands, const Frame& frame) const {
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kDrawRead);
    scene_.record(commands, frame.scene);
    const VkDescriptorSet scene_set = scene_.set();
    gpu->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layouts_.layout.get(), 0, 1, &scene_set,
                                    0, nullptr);
}

void RendererState::record_frame(VkCommandBuffer commands, const Frame& frame) {
    bind_scene(commands, frame);
    timer.begin(commands);
    draw_shadows(commands, frame);
    draw_picture(commands, frame);
    timer.end(commands);
}

// Without shadows the map is empty: the scene says not to look at it.
void RendererState::draw_shadows(VkCommandBuffer commands, const Frame& frame) const {
    shadow_map.begin(commands);
    if (options.shadows)
        draw_crowd(commands, frame.crowd, frame.bindings, layouts_.layout.get(), frame.characters, DrawPass::kShadow);
    shadow_map.end(commands);
}

// Ground, characters over it, lines over both.
void RendererState::draw_picture(VkCommandBuffer commands, const Frame& frame) const {
    const VkPipelineLayout layout = layouts_.layout.get();
    targets.begin(commands);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, ground_.get());
    gpu->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    draw_crowd(commands, frame.crowd, frame.bindings, layout, frame.characters, DrawPass::kPicture);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    if (options.bounds) draw_bounds(commands, frame.crowd, frame.bindings, layout, *frame.lines);
    if (options.skeletons) draw_skeletons(commands, frame.crowd, frame.bindings, layout, *frame.lines);
    targets.end(commands);
}

RenderResult RendererState::result_of(const Frame& frame) const {
    return {.picture = targets.read_back(), .draw_ms = timer.read_ms(), .warnings = frame.bindings.warnings};
}

Result<Renderer> Renderer::create(const Device& device, const RendererSettings& settings) {
    return as_result([&] { return Renderer(std::make_unique<RendererState>(device.gpu(), settings)); }, "renderer");
}

Renderer::Renderer(std::unique_ptr<RendererState> state) : state_(std::move(state)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

RendererState& Renderer::state() const {
    if (!state_) throw Failure(ErrorCode::kInvalidArgument, "renderer", "it has been moved from");
    return *state_;
}

Result<RenderResult> Renderer::render(const Crowd& crowd, const Camera& camera) {
    return as_result([&] { return state().render(crowd, camera); }, "render");
}

Result<RenderResult> Renderer::render_frame(Crowd& crowd, float time_step_s, const Camera& camera) {
    return as_result([&] { return state().render_frame(crowd, time_step_s, camera); }, "render");
}

Result<void> Renderer::record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) {
    return as_result([&] { state().record(commands, crowd, time_step_s, camera); }, "render");
}

VkImage Renderer::picture() const { return state_ ? state_->targets.picture() : VK_NULL_HANDLE; }

Result<void> Renderer::resize(uint32_t width, uint32_t height) {
    return as_result([&] { state().resize(width, height); }, "resize");
}

Result<void> Renderer::set_options(const DrawOptions& options) {
    return as_result([&] { state().options = checked(options); });
}

const DrawOptions& Renderer::options() const {
    static const DrawOptions none;
    return state_ ? state_->options : none;
}

double Renderer::draw_ms() const { return state_ ? state_->timer.read_ms() : 0; }

}  // namespace throng
