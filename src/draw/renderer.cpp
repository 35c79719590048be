#include <throng/draw.h>

#include "base/failure.h"
#include "base/enumeration.h"
#include "draw/camera.h"
#include "draw/native_renderer.h"
#include "draw/vulkan_renderer.h"

#include <algorithm>
#include <array>

namespace throng {
namespace {

void check_commands(const RendererState& state, VkCommandBuffer commands) {
    if (state.gpu->is_native())
        throw Failure(ErrorCode::kUnsupported, "command buffer",
                      "a native device has no command buffers: draw with render() or render_frame()");
    if (!commands) throw Failure(ErrorCode::kInvalidArgument, "command buffer", "it is VK_NULL_HANDLE");
}

std::vector<CrowdState*> checked(std::span<const Crowd* const> crowds) {
    std::vector<CrowdState*> states;
    for (const Crowd* crowd : crowds) {
        if (!crowd) throw Failure(ErrorCode::kInvalidArgument, "render", "a crowd is null");
        CrowdState* const state = &crowd->state();
        if (std::ranges::count(states, state) > 0)
            throw Failure(ErrorCode::kInvalidArgument, "render", "a crowd is listed twice");
        states.push_back(state);
    }
    if (states.empty()) throw Failure(ErrorCode::kInvalidArgument, "render", "the list of crowds is empty");
    return states;
}

std::unique_ptr<RendererState> make_state(const std::shared_ptr<Gpu>& gpu, const RendererSettings& settings) {
    check_known(settings.path, DrawPath::kDevice, "renderer: path");
    const std::string unsupported_reason = natively_undrawable_reason(*gpu);
    if (settings.path == DrawPath::kDevice && gpu->is_native())
        throw Failure(ErrorCode::kNoDevice, "renderer",
                      "a native device has no shaders: choose a Vulkan device (mesa-vulkan-drivers has a software "
                      "one), or the native renderer");
    const bool must_be_native = settings.path == DrawPath::kNative || gpu->is_native();
    if (must_be_native && !unsupported_reason.empty())
        throw Failure(ErrorCode::kUnsupported, "native renderer", unsupported_reason);
    if (must_be_native || (settings.path == DrawPath::kAuto && unsupported_reason.empty()))
        return std::make_unique<NativeRenderer>(gpu, settings);
    return std::make_unique<VulkanRenderer>(gpu, settings);
}

}  // namespace

Result<Renderer> Renderer::create(const Device& device, const RendererSettings& settings) {
    return as_result([&] { return Renderer(make_state(device.gpu(), settings)); }, "renderer");
}

Renderer::Renderer(std::unique_ptr<RendererState> state) : state_(std::move(state)) {}
Renderer::Renderer() noexcept = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

RendererState& Renderer::state() const {
    if (!state_)
        throw Failure(ErrorCode::kInvalidArgument, "renderer",
                      "the Renderer was not made by Renderer::create(), or has been moved from");
    return *state_;
}

Result<RenderResult> Renderer::render(std::span<const Crowd* const> crowds, const Camera& camera) {
    return as_result(
        [&] {
            const std::vector<CrowdState*> states = checked(crowds);
            for (const CrowdState* const crowd : states) crowd->check_last_has_run("render");
            return state().render(states, camera);
        },
        "render");
}

Result<RenderResult> Renderer::render_frame(std::span<Crowd* const> crowds, float time_step_s, const Camera& camera) {
    return as_result([&] { return state().render_frame(checked(crowds), time_step_s, camera); }, "render");
}

Result<void> Renderer::record(VkCommandBuffer commands, std::span<Crowd* const> crowds, float time_step_s,
                              const Camera& camera) {
    return as_result(
        [&] {
            check_commands(state(), commands);
            state().record(commands, checked(crowds), time_step_s, camera);
        },
        "render");
}

Result<void> Renderer::update(std::span<Crowd* const> crowds, float time_step_s, const Camera& camera) {
    return as_result([&] { state().update(checked(crowds), time_step_s, camera); }, "render");
}

Result<void> Renderer::record_drawing(VkCommandBuffer commands, std::span<const Crowd* const> crowds,
                                      const Camera& camera) {
    return as_result(
        [&] {
            check_commands(state(), commands);
            state().record_drawing(commands, checked(crowds), camera);
        },
        "render");
}

Result<RenderResult> Renderer::render(const Crowd& crowd, const Camera& camera) {
    return render(std::array{&crowd}, camera);
}
Result<RenderResult> Renderer::render_frame(Crowd& crowd, float time_step_s, const Camera& camera) {
    return render_frame(std::array{&crowd}, time_step_s, camera);
}
Result<void> Renderer::record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) {
    return record(commands, std::array{&crowd}, time_step_s, camera);
}
Result<void> Renderer::update(Crowd& crowd, float time_step_s, const Camera& camera) {
    return update(std::array{&crowd}, time_step_s, camera);
}
Result<void> Renderer::record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera) {
    return record_drawing(commands, std::array{&crowd}, camera);
}

VkImage Renderer::picture() const { return state_ ? state_->picture() : VK_NULL_HANDLE; }

Result<void> Renderer::prepare(const Crowd& crowd) {
    return as_result([&] { state().prepare(std::array{&crowd.state()}); }, "render");
}

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
bool Renderer::is_native() const { return state_ && state_->is_native(); }

}  // namespace throng
