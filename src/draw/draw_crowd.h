// Recording the draws of a crowd: every batch, every section, every level of detail.
#pragma once

#include "draw/crowd_bindings.h"

#include <functional>

namespace throng {

struct DrawnSection {
    const DrawMaterial& material;
    bool mirrors;  // the batch has mirrored instances, whose front faces wind the other way: then the fragment shader culls
};

// Within a render pass, with the scene bound; `pipeline_of` chooses by what is drawn.
void draw_crowd(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings, VkPipelineLayout layout,
                const std::function<VkPipeline(const DrawnSection&)>& pipeline_of);

}  // namespace throng
