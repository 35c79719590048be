// The graphics pipelines of the draw, and the layouts that they share.
#pragma once

#include "gpu/owned.h"
#include "gpu/spirv_info.h"

#include <throng/crowd.h>

#include <array>

namespace throng {

inline constexpr VkFormat kColorFormat = VK_FORMAT_R8G8B8A8_SRGB;
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat kFarthestFormat = VK_FORMAT_R32_SFLOAT;  // draw/occluders.h

// What all pipelines share. Descriptor sets: 0 the scene (one uniform buffer, the shadow map), 1 a batch (seven storage
// buffers), 2 a material (its textures).
struct DrawLayouts {
    explicit DrawLayouts(const std::shared_ptr<Gpu>& gpu);

    OwnedSetLayout scene_set, batch_set, material_set;
    OwnedPipelineLayout layout;
};

// The ground over the whole picture, without depth.
OwnedPipeline make_ground_pipeline(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts,
                                   VkSampleCountFlagBits samples);

// Depths of several samples -> the farthest (draw/occluders.h).
OwnedPipeline make_farthest_pipeline(const std::shared_ptr<Gpu>& gpu, VkPipelineLayout layout);

// How a crowd's vertices come about.
struct VertexKind {
    SkinFormat format = SkinFormat::kAffine;
    SkinBlend blend = SkinBlend::kLinear;
    bool listed = false;   // instances are
    bool skinned = false;  // by the crowd
    friend auto operator<=>(const VertexKind&, const VertexKind&) = default;
};

// Cull mode, viewport and scissor are dynamic.
struct CharacterPipelines {
    CharacterPipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, VkSampleCountFlagBits samples,
                       const VertexKind& kind);

    // Those that discard: of materials with a mask; and in the picture of batches with mirrored instances, whose front
    // faces wind the other way.
    std::array<OwnedPipeline, 2> shadow;                       // [discards]: into the shadow map
    std::array<OwnedPipeline, 2> occluder;                     // [discards]: depths alone, of the camera
    std::array<std::array<OwnedPipeline, 2>, 2> into_picture;  // [discards][has_maps]
};

// Lines over a crowd whose instances are listed or not.
struct LinePipelines {
    LinePipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, VkSampleCountFlagBits samples,
                  bool listed);

    OwnedPipeline skeletons;  // without depth: over everything
    OwnedPipeline bounds;
};

// Vertices, influences, skin matrices or skinned vertices, placements, morph differences, active morphs, list
inline constexpr std::array<BindingInfo, 7> kBatchBindings{{{0}, {1}, {2}, {3}, {4}, {5}, {6}}};

}  // namespace throng
