// The graphics pipelines of the draw, and the layouts that they share.
#pragma once

#include "draw/owned.h"
#include "gpu/spirv_info.h"

#include <throng/crowd.h>

#include <array>

namespace throng {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

// What all pipelines share. Descriptor sets: 0 the scene (one uniform buffer), 1 a batch (seven storage buffers), 2 a material (one texture).
struct DrawLayouts {
    explicit DrawLayouts(const std::shared_ptr<Gpu>& gpu);

    OwnedSetLayout scene_set, batch_set, material_set;
    OwnedPipelineLayout layout;
};

// Of crowds whose skin matrices have this format, and whose instances are listed or not. Cull mode, viewport and scissor are dynamic.
struct DrawPipelines {
    DrawPipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, VkSampleCountFlagBits samples, SkinFormat format, bool listed);

    OwnedPipeline ground;              // over the whole picture, without depth
    OwnedPipeline shadow;              // characters laid flat on the ground, without depth
    OwnedPipeline character;           // of opaque materials
    OwnedPipeline character_discards;  // of materials with a mask, and of batches with mirrored instances
};

inline constexpr std::array<BindingInfo, 7> kBatchBindings{{{0}, {1}, {2}, {3}, {4}, {5}, {6}}};  // vertices, influences, skin matrices, placements, morph differences, active morphs, list

}  // namespace throng
