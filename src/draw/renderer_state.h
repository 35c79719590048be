// The implementations behind Renderer: by the device's shaders, or by this machine's processor.
#pragma once

#include "draw/crowd_bounds.h"

#include <throng/draw.h>

namespace throng {

struct RendererState {
    RendererState(std::shared_ptr<Gpu> gpu, const DrawOptions& options);
    virtual ~RendererState() = default;

    // As in Renderer.
    virtual RenderResult render(Crowds crowds, const Camera& camera) = 0;
    virtual RenderResult render_frame(Crowds crowds, float time_step_s, const Camera& camera) = 0;
    virtual void record(VkCommandBuffer commands, Crowds crowds, float time_step_s, const Camera& camera) = 0;
    virtual void record_drawing(VkCommandBuffer commands, Crowds crowds, const Camera& camera) = 0;
    void update(Crowds crowds, float time_step_s, const Camera& camera) const;
    virtual void prepare(Crowds crowds) = 0;
    virtual void resize(VkExtent2D extent) = 0;
    virtual VkExtent2D extent() const = 0;
    virtual VkImage picture() const = 0;
    virtual double draw_ms() const = 0;
    virtual bool is_native() const = 0;

    const std::shared_ptr<Gpu> gpu;
    DrawOptions options;

protected:
    // Call it first with the crowds that are to be drawn. From now on the CPU learns where their updates move
    // instances, since the scene and the views are fitted to them; if it may `wait`, also where they have moved them
    // before. Throws kInvalidArgument if the crowds cannot be drawn with these options.
    void accept(Crowds crowds, bool wait) const;
    CrowdView view_of(const CrowdBounds& crowds, const Camera& camera) const;  // without occlusion
};

}  // namespace throng
