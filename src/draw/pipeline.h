// The graphics pipelines of the draw, and the layout that they share.
#pragma once

#include "gpu/shader.h"

#include <throng/crowd.h>

#include <array>

namespace throng {

inline VkFormat color_format(bool blue_first) { return blue_first ? VK_FORMAT_B8G8R8A8_SRGB : VK_FORMAT_R8G8B8A8_SRGB; }
inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
inline constexpr VkFormat kFarthestFormat = VK_FORMAT_R32_SFLOAT;  // draw/occluders.h

// Descriptor sets of the shaders: the buffers of a batch, at the same binding numbers as in kernels; the scene and the
// shadow map; the textures of a material.
enum DrawSet : uint32_t { kBatchSet, kSceneSet, kMaterialSet };

// The layout of all shaders of the draw, so that a set stays bound when the pipeline changes.
ShaderLayout make_draw_layout(const std::shared_ptr<Gpu>& gpu);

// What pipelines of a picture are made with.
struct PipelineSettings {
    std::shared_ptr<Gpu> gpu;
    VkPipelineLayout layout;
    VkSampleCountFlagBits samples;
    VkFormat color_format;
};

// The ground over the whole picture, without depth.
OwnedPipeline make_ground_pipeline(const PipelineSettings& settings);

// Depths of several samples -> the farthest (draw/occluders.h), with a layout of its own.
ShaderLayout make_farthest_layout(const std::shared_ptr<Gpu>& gpu);
OwnedPipeline make_farthest_pipeline(const std::shared_ptr<Gpu>& gpu, const ShaderLayout& layout);

// What the pipelines of a crowd's characters depend on.
struct CharacterKind {
    SkinFormat format = SkinFormat::kAffine;
    SkinBlend blend = SkinBlend::kLinear;
    bool listed = false;   // instances are listed
    bool skinned = false;  // by the crowd
    bool has_looks = false;
    bool has_blends = false;  // some of its materials are blended
    friend auto operator<=>(const CharacterKind&, const CharacterKind&) = default;
};

// Cull mode, viewport and scissor are dynamic.
struct CharacterPipelines {
    CharacterPipelines(const PipelineSettings& settings, const CharacterKind& kind);

    // By AlphaMode. In the picture, the pipelines for masks also draw opaque materials of batches with mirrored
    // instances, whose front faces wind the other way. Those for blended materials exist only with
    // CharacterKind::has_blends.
    std::array<OwnedPipeline, 3> shadow;                       // into the shadow map
    std::array<OwnedPipeline, 3> occluder;                     // depths alone, of the camera
    std::array<std::array<OwnedPipeline, 2>, 3> into_picture;  // [alpha mode][has_maps]
};

// The lines over a crowd. `listed`: its instances are listed.
struct LinePipelines {
    LinePipelines(const PipelineSettings& settings, bool listed);

    OwnedPipeline skeletons;  // without depth: over everything
    OwnedPipeline bounds;
};

}  // namespace throng
