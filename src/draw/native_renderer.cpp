#include "draw/native_renderer.h"

#include "base/failure.h"
#include "draw/camera.h"
#include "draw/vulkan_renderer.h"

#include <algorithm>

namespace throng {
namespace {

std::unique_ptr<NativeFrame> make_frame(const std::shared_ptr<Gpu>& gpu, const RendererSettings& settings,
                                        NativeIsa isa) {
    constexpr uint32_t kSamples = 4;
    return std::make_unique<NativeFrame>(gpu, VkExtent2D{settings.width, settings.height},
                                         settings.samples < kSamples ? 1 : kSamples, isa);
}

std::unique_ptr<StagedPicture> make_staged(const std::shared_ptr<Gpu>& gpu, const RendererSettings& settings) {
    if (gpu->is_native()) return nullptr;
    return std::make_unique<StagedPicture>(gpu, VkExtent2D{settings.width, settings.height}, settings.blue_first);
}

}  // namespace

std::string natively_undrawable_reason(const Gpu& gpu) {
    if (!gpu.processor)
        return gpu.info.name + " is a GPU; the native renderer works only on native and software devices";
    if (native_isas().empty()) return "the native engine does not support this processor";
    return {};
}

NativeRenderer::NativeRenderer(std::shared_ptr<Gpu> gpu_in, const RendererSettings& settings, NativeIsa isa)
    : RendererState(std::move(gpu_in), settings.options),
      settings_(settings),
      isa_(isa),
      frame_(make_frame(gpu, settings, isa)),
      staged_(make_staged(gpu, settings)) {}

void NativeRenderer::resize(VkExtent2D extent) {
    RendererSettings resized = settings_;
    resized.width = extent.width;
    resized.height = extent.height;
    auto frame = make_frame(gpu, resized, isa_);
    auto staged = make_staged(gpu, resized);
    if (device_) device_->resize(extent);
    frame_ = std::move(frame);
    staged_ = std::move(staged);
    settings_ = resized;
}

std::vector<NativeGroups> NativeRenderer::kept_of(Crowds crowds) {
    std::vector<NativeGroups> all;
    for (CrowdState* crowd : crowds) {
        crowd->finish_uploads();
        all.push_back(groups_.of(*crowd, [&](std::span<const uint32_t> new_groups) {
            crowd->check_last_has_run("render");  // meshes are copied here once, from buffers that must be filled
            uint64_t room_bytes = kTexturesLimit_bytes;
            std::vector<std::unique_ptr<const NativeGroup>> made;
            for (const uint32_t group : new_groups)
                made.push_back(std::make_unique<const NativeGroup>(*crowd, crowd->groups[group], room_bytes));
            return made;
        }));
    }
    return all;
}

void NativeRenderer::prepare(Crowds crowds) {
    accept(crowds, true);
    // If a crowd still waits for recorded commands, the first picture makes the groups, after the commands have run
    if (std::ranges::none_of(crowds, [](const CrowdState* crowd) { return crowd->awaits_commands(); })) kept_of(crowds);
}

RenderResult NativeRenderer::render(Crowds crowds, const Camera& camera) {
    accept(crowds, true);
    if (!gpu->is_native()) gpu->wait_idle();  // submitted work may write what is read below
    const std::vector<NativeGroups> kept = kept_of(crowds);
    const auto [width, height] = extent();
    RenderResult result{
        .picture = {width, height, std::vector<uint8_t>(size_t{4} * width * height)}, .draw_ms = 0, .warnings = {}};
    for (const NativeGroups& groups : kept)
        for (const NativeGroup* const group : groups)
            if (group)
                result.warnings.insert(result.warnings.end(), group->warnings().begin(), group->warnings().end());
    frame_->draw(crowds, kept, camera, options, {result.picture.rgba.data()});
    device_drew_ = false;
    result.draw_ms = draw_ms();
    return result;
}

RenderResult NativeRenderer::render_frame(Crowds crowds, float time_step_s, const Camera& camera) {
    accept(crowds, true);
    make_view(camera, 1);                     // refuses an invalid camera before time advances
    if (!gpu->is_native()) gpu->wait_idle();  // submitted work may write the meshes that are read below
    kept_of(crowds);
    update(crowds, time_step_s, camera);
    return render(crowds, camera);
}

void NativeRenderer::record(VkCommandBuffer commands, Crowds crowds, float time_step_s, const Camera& camera) {
    RendererState& device = device_renderer();
    device.record(commands, crowds, time_step_s, camera);
    staged_->record_copy(commands, device.picture());
    device_drew_ = true;
}

void NativeRenderer::record_drawing(VkCommandBuffer commands, Crowds crowds, const Camera& camera) {
    accept(crowds, false);
    if (std::ranges::any_of(crowds, [](const CrowdState* crowd) { return crowd->awaits_commands(); })) {
        RendererState& device = device_renderer();
        device.record_drawing(commands, crowds, camera);
        staged_->record_copy(commands, device.picture());
        device_drew_ = true;
        return;
    }
    frame_->draw(crowds, kept_of(crowds), camera, options, {staged_->next(), settings_.blue_first});
    staged_->record(commands);
    device_drew_ = false;
}

RendererState& NativeRenderer::device_renderer() {
    if (!device_) {
        RendererSettings settings = settings_;
        settings.samples = frame_->samples();
        device_ = std::make_unique<VulkanRenderer>(gpu, settings);
    }
    device_->options = options;
    return *device_;
}

double NativeRenderer::draw_ms() const { return device_drew_ ? device_->draw_ms() : frame_->times().total_ms(); }

}  // namespace throng
