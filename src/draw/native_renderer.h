// Drawing by this machine's processor: on native devices, which have no other renderer, and on software devices.
#pragma once

#include "draw/group_cache.h"
#include "draw/native_frame.h"
#include "draw/renderer_state.h"
#include "draw/staged_picture.h"
#include "native/native.h"

namespace throng {

// Why this device cannot have a native renderer; empty if it can.
std::string natively_undrawable_reason(const Gpu& gpu);

class NativeRenderer : public RendererState {
public:
    // `isa`: one of native_isas().
    NativeRenderer(std::shared_ptr<Gpu> gpu, const RendererSettings& settings, NativeIsa isa = native_isas().back());

    RenderResult render(Crowds crowds, const Camera& camera) override;
    RenderResult render_frame(Crowds crowds, float time_step_s, const Camera& camera) override;
    void record(VkCommandBuffer commands, Crowds crowds, float time_step_s, const Camera& camera) override;
    void record_drawing(VkCommandBuffer commands, Crowds crowds, const Camera& camera) override;
    void prepare(Crowds crowds) override;
    void resize(VkExtent2D extent) override;
    VkExtent2D extent() const override { return frame_->extent(); }
    VkImage picture() const override { return staged_ ? staged_->image() : VK_NULL_HANDLE; }
    double draw_ms() const override;
    bool is_native() const override { return true; }
    const NativeTimes& times() const { return frame_->times(); }

private:
    std::vector<NativeGroups> kept_of(Crowds crowds);
    RendererState& device_renderer();

    RendererSettings settings_;  // with the current size
    NativeIsa isa_;
    std::unique_ptr<NativeFrame> frame_;
    std::unique_ptr<StagedPicture> staged_;  // if the device has images
    GroupCache<const NativeGroup> groups_;
    // The device's own renderer, which draws recorded updates on a software device; made when first needed
    std::unique_ptr<RendererState> device_;
    bool device_drew_ = false;  // the last frame
};

}  // namespace throng
