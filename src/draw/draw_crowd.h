// Recording the draws of a crowd: every batch, every section, every level of detail; and the lines over it.
#pragma once

#include "draw/crowd_bindings.h"

namespace throng {

enum class DrawPass { kShadow, kOccluders, kPicture };

// Within the pass, with the scene bound.
void draw_crowd(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                VkPipelineLayout layout, const CharacterPipelines& pipelines, DrawPass pass);

// Of all instances, or of those that are listed. Skeletons need CrowdSettings::keep_model_matrices.
void draw_skeletons(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                    VkPipelineLayout layout, const LinePipelines& pipelines);
void draw_bounds(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                 VkPipelineLayout layout, const LinePipelines& pipelines);

}  // namespace throng
