// What stands behind a Renderer: the device's shaders, or this machine's processor.
#pragma once

#include "crowd/crowd_state.h"

#include <throng/draw.h>

namespace throng {

struct RendererState {
    RendererState(std::shared_ptr<Gpu> gpu, const DrawOptions& options);
    virtual ~RendererState() = default;

    // As Renderer has them.
    virtual RenderResult render(const Crowd& crowd, const Camera& camera) = 0;
    virtual RenderResult render_frame(Crowd& crowd, float time_step_s, const Camera& camera) = 0;
    virtual void record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera) = 0;
    virtual void record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera) = 0;
    void update(Crowd& crowd, float time_step_s, const Camera& camera) const;
    virtual void prepare(const Crowd& crowd) = 0;
    virtual void resize(VkExtent2D extent) = 0;
    virtual VkExtent2D extent() const = 0;
    virtual VkImage picture() const = 0;
    virtual double draw_ms() const = 0;
    virtual bool is_native() const = 0;

    const std::shared_ptr<Gpu> gpu;
    DrawOptions options;

protected:
    // A crowd that is to be drawn: what is fitted to it follows where its updates move instances. Throws
    // kInvalidArgument where it cannot be drawn with these options.
    void accept(const Crowd& crowd) const;
    CrowdView view_of(const Crowd& crowd, const Camera& camera) const;  // without occlusion
};

}  // namespace throng
