#include <throng/draw.h>

#include "base/failure.h"
#include "draw/camera.h"
#include "draw/draw_crowd.h"
#include "draw/occluders.h"
#include "draw/scene.h"
#include "draw/shadow_map.h"
#include "draw/targets.h"
#include "gpu/timestamps.h"

#include <map>

namespace throng {
namespace {

constexpr Access kDrawRead{
    VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
    VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};

std::shared_ptr<Gpu> with_graphics(std::shared_ptr<Gpu> gpu) {
    if (gpu->is_native())
        throw Failure(ErrorCode::kNoDevice, "renderer",
                      "the native device draws nothing: it needs Vulkan (mesa-vulkan-drivers has a software device)");
    if (!gpu->has_graphics())
        throw Failure(
            ErrorCode::kNoDevice, "renderer",
            "queue family " + std::to_string(gpu->queue_family) + " of " + gpu->info.name + " has no graphics");
    return gpu;
}

void check_commands(VkCommandBuffer commands) {
    if (!commands) throw Failure(ErrorCode::kInvalidArgument, "command buffer", "there is none");
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
    void update(Crowd& crowd, float time_step_s, const Camera& camera) const;
    void record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera);
    void resize(VkExtent2D extent);
    double draw_ms() const;

    std::shared_ptr<Gpu> gpu;
    VkSampleCountFlagBits samples;
    DrawOptions options;
    Targets targets;

private:
    // What a frame needs; making it may fail, or submit, so it comes before anything is recorded.
    struct Frame {
        CrowdDrawing drawing;
        io::DrawScene scene;
        bool has_begun = false;  // its time is being taken
    };
    Frame prepare(const Crowd& crowd, const Camera& camera);
    CrowdView view_of(const Crowd& crowd, const Camera& camera) const;
    void record_update(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera, Frame& frame);
    void begin_draw(VkCommandBuffer commands, Frame& frame);
    void record_frame(VkCommandBuffer commands, Frame& frame);
    void draw_picture(VkCommandBuffer commands, const CrowdDrawing& drawing) const;
    RenderResult result_of(const Frame& frame) const;

    DepthPass shadow_map_;
    Timestamps stamps_;
    ShaderLayout layout_;
    PipelineSettings pipelines_;
    MaterialSampling sampling_;
    SceneBinding scene_;
    OwnedPipeline ground_;
    std::map<VertexKind, CharacterPipelines> characters_;
    std::map<bool, LinePipelines> lines_;  // by whether instances are listed
    CrowdBindingsCache crowds_;
    std::optional<Occluders> occluders_;  // made when first needed
};

RendererState::RendererState(std::shared_ptr<Gpu> gpu_in, const RendererSettings& settings)
    : gpu(with_graphics(std::move(gpu_in))),
      samples(lower_samples(*gpu, settings.samples)),
      options(checked(settings.options)),
      targets(gpu, {settings.width, settings.height}, samples),
      shadow_map_(make_shadow_map(gpu, targets.extent())),
      stamps_(gpu, 4),  // around the occluders, and around the rest
      layout_(make_draw_layout(gpu)),
      pipelines_{gpu, layout_.get(), samples},
      sampling_(gpu),
      scene_(gpu, layout_, shadow_map_),
      ground_(make_ground_pipeline(pipelines_)) {}

void RendererState::resize(VkExtent2D extent) {
    Targets resized(gpu, extent, samples);
    DepthPass map = make_shadow_map(gpu, extent);
    scene_ = SceneBinding(gpu, layout_, map);
    targets = std::move(resized);
    occluders_.reset();
    shadow_map_ = std::move(map);
}

RenderResult RendererState::render(const Crowd& crowd, const Camera& camera) {
    Frame frame = prepare(crowd, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        record_frame(commands, frame);
        targets.record_read_back(commands);
    });
    return result_of(frame);
}

RenderResult RendererState::render_frame(Crowd& crowd, float time_step_s, const Camera& camera) {
    Frame frame = prepare(crowd, camera);
    const bool is_native = crowd.state().is_native(options.occlusion);
    if (is_native) update(crowd, time_step_s, camera);
    gpu->submit_and_wait([&](VkCommandBuffer commands) {
        if (!is_native) record_update(commands, crowd, time_step_s, camera, frame);
        record_frame(commands, frame);
        targets.record_read_back(commands);
    });
    return result_of(frame);
}

void RendererState::record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) {
    Frame frame = prepare(crowd, camera);
    record_update(commands, crowd, time_step_s, camera, frame);
    record_frame(commands, frame);
}

RendererState::Frame RendererState::prepare(const Crowd& crowd, const Camera& camera) {
    const CrowdState& state = crowd.state();
    if (state.gpu != gpu) throw Failure(ErrorCode::kInvalidArgument, "render", "the crowd lives on another device");
    for (const Group& group : state.groups)
        if (group.sockets_only)
            throw Failure(ErrorCode::kInvalidArgument, "render", group.name + " has sockets only, and nothing to draw");
    if (options.skeletons && !state.batches.front()[io::kModelBuffer])
        throw Failure(ErrorCode::kInvalidArgument, "skeletons",
                      "the crowd keeps no model matrices; set CrowdSettings::keep_model_matrices");
    const io::DrawScene scene = make_scene(state, camera, targets.extent(), shadow_map_.extent().width, options);
    const VertexKind kind{state.skin_format, state.skin_blend, state.cull != nullptr, state.skins_once};
    const CharacterPipelines& characters = characters_.try_emplace(kind, pipelines_, kind).first->second;
    const LinePipelines* lines = nullptr;
    if (options.skeletons || options.bounds)
        lines = &lines_.try_emplace(kind.listed, pipelines_, kind.listed).first->second;
    return {{state, crowds_.of(layout_, sampling_, state), layout_, characters, lines}, scene};
}

CrowdView RendererState::view_of(const Crowd& crowd, const Camera& camera) const {
    const auto [width, height] = targets.extent();
    CrowdView view = crowd_view_of(camera, width, height, world_bounds(crowd), options);
    view.occlusion = options.occlusion && (gpu->properties.limits.sampledImageDepthSampleCounts & samples);
    return view;
}

void RendererState::update(Crowd& crowd, float time_step_s, const Camera& camera) const {
    CrowdState& state = crowd.state();
    if (!state.cull) return state.update(time_step_s, nullptr);
    CrowdView view = view_of(crowd, camera);
    view.occlusion = false;
    state.update(time_step_s, &view);
}

void RendererState::record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera) {
    Frame frame = prepare(crowd, camera);
    record_frame(commands, frame);
}

void RendererState::record_update(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera,
                                  Frame& frame) {
    CrowdState& state = crowd.state();
    if (!state.cull) return state.record(commands, time_step_s, nullptr);
    const CrowdView view = view_of(crowd, camera);
    state.record(commands, time_step_s, &view);
    if (!view.occlusion) return;
    if (!occluders_) occluders_.emplace(gpu, targets.extent(), samples);
    begin_draw(commands, frame);
    occluders_->begin(commands);
    frame.drawing.draw(commands, DrawPass::kOccluders);
    occluders_->end(commands);
    stamps_.write(commands);
    state.record_disoccluded(commands, occluders_->depths());
}

// Binds the scene; what the crowd's update has written becomes visible to draws. Their time begins.
void RendererState::begin_draw(VkCommandBuffer commands, Frame& frame) {
    memory_barrier(*gpu, commands, kShaderWrite | kTransferWrite, kDrawRead);
    scene_.record(commands, frame.scene);
    const VkDescriptorSet scene_set = scene_.set();
    gpu->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), kSceneSet, 1, &scene_set,
                                    0, nullptr);
    if (!std::exchange(frame.has_begun, true)) stamps_.begin(commands);
    stamps_.write(commands);
}

void RendererState::record_frame(VkCommandBuffer commands, Frame& frame) {
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
double RendererState::draw_ms() const {
    double sum_ms = 0;
    if (const std::optional<Timestamps::Frame> frame = stamps_.newest())
        for (size_t i = 1; i < frame->ms.size(); i += 2) sum_ms += frame->ms[i] - frame->ms[i - 1];
    return sum_ms;
}

// Ground, characters over it, lines over both.
void RendererState::draw_picture(VkCommandBuffer commands, const CrowdDrawing& drawing) const {
    targets.begin(commands);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, ground_.get());
    gpu->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    drawing.draw(commands, DrawPass::kPicture);
    gpu->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    if (options.bounds) drawing.draw_bounds(commands);
    if (options.skeletons) drawing.draw_skeletons(commands);
    targets.end(commands);
}

RenderResult RendererState::result_of(const Frame& frame) const {
    return {.picture = targets.read_back(), .draw_ms = draw_ms(), .warnings = frame.drawing.bindings.warnings};
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
    return as_result(
        [&] {
            check_commands(commands);
            state().record(commands, crowd, time_step_s, camera);
        },
        "render");
}

Result<void> Renderer::update(Crowd& crowd, float time_step_s, const Camera& camera) {
    return as_result([&] { state().update(crowd, time_step_s, camera); }, "render");
}

Result<void> Renderer::record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera) {
    return as_result(
        [&] {
            check_commands(commands);
            state().record_drawing(commands, crowd, camera);
        },
        "render");
}

VkImage Renderer::picture() const { return state_ ? state_->targets.picture() : VK_NULL_HANDLE; }

Result<void> Renderer::resize(uint32_t width, uint32_t height) {
    return as_result([&] { state().resize({width, height}); }, "resize");
}

Result<void> Renderer::set_options(const DrawOptions& options) {
    return as_result([&] { state().options = checked(options); });
}

const DrawOptions& Renderer::options() const {
    static const DrawOptions none;
    return state_ ? state_->options : none;
}

double Renderer::draw_ms() const { return state_ ? state_->draw_ms() : 0; }

}  // namespace throng
