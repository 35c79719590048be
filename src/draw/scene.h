// What the shaders know of the whole picture: camera, sun, sky, ground.
#pragma once

#include "draw/crowd_bounds.h"
#include "draw/draw_io.h"
#include "draw/depth_pass.h"

#include <throng/draw.h>

namespace throng {

// Everything is measured in the crowds' own size: a file's unit may be a metre or a centimetre. Throws kInvalidArgument
// if the camera is invalid.
io::DrawScene make_scene(const CrowdBounds& crowds, const Camera& camera, const VkExtent2D& picture, uint32_t map_size,
                         const DrawOptions& options);

// The scene and the shadow map in a descriptor set.
class SceneBinding {
public:
    SceneBinding(const std::shared_ptr<Gpu>& gpu, const ShaderLayout& layout, const DepthPass& shadow_map);

    // Waits for earlier frames that read it.
    void record(VkCommandBuffer commands, const io::DrawScene& scene) const;
    VkDescriptorSet set() const { return bindings_.set(); }

private:
    std::shared_ptr<Gpu> gpu_;
    Buffer buffer_;
    Bindings bindings_;
};

}  // namespace throng
