#include "draw/pipeline.h"

#include "base/failure.h"
#include "draw/draw_io.h"
#include "draw/materials.h"

#include <algorithm>
#include <span>
#include <vector>

namespace throng {
namespace {

constexpr uint32_t kCharacterVertex[] = {
#include "draw/character.vert.inc"
};
constexpr uint32_t kCharacterFragment[] = {
#include "draw/character.frag.inc"
};
constexpr uint32_t kShadowFragment[] = {
#include "draw/shadow.frag.inc"
};
constexpr uint32_t kGroundVertex[] = {
#include "draw/ground.vert.inc"
};
constexpr uint32_t kGroundFragment[] = {
#include "draw/ground.frag.inc"
};
constexpr uint32_t kSkeletonVertex[] = {
#include "draw/skeleton.vert.inc"
};
constexpr uint32_t kBoundsVertex[] = {
#include "draw/bounds.vert.inc"
};
constexpr uint32_t kFarthestVertex[] = {
#include "draw/farthest.vert.inc"
};
constexpr uint32_t kFarthestFragment[] = {
#include "draw/farthest.frag.inc"
};
constexpr uint32_t kLineFragment[] = {
#include "draw/line.frag.inc"
};

enum class Depth { kNone, kTested, kAlone, kShadowMap };  // the last two: nothing else is written

struct Program {
    std::span<const uint32_t> vertex, fragment;  // no fragment shader: depth is written
    std::array<uint32_t, 5> vertex_constants{};
    std::array<uint32_t, 2> fragment_constants{};
    Depth depth = Depth::kNone;
    VkFormat color_format = kColorFormat;
};

OwnedSetLayout make_set_layout(const std::shared_ptr<Gpu>& gpu, const std::vector<VkDescriptorType>& types,
                               VkShaderStageFlags stages) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const VkDescriptorType type : types)
        bindings.push_back({static_cast<uint32_t>(bindings.size()), type, 1, stages, nullptr});
    VkDescriptorSetLayoutCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    create.bindingCount = static_cast<uint32_t>(bindings.size());
    create.pBindings = bindings.data();
    return {gpu, gpu->vk.vkCreateDescriptorSetLayout, create, "vkCreateDescriptorSetLayout"};
}

OwnedShader make_shader(const std::shared_ptr<Gpu>& gpu, std::span<const uint32_t> spirv) {
    VkShaderModuleCreateInfo create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    create.codeSize = spirv.size_bytes();
    create.pCode = spirv.data();
    return {gpu, gpu->vk.vkCreateShaderModule, create, "vkCreateShaderModule"};
}

OwnedPipeline make_pipeline(const std::shared_ptr<Gpu>& gpu, VkPipelineLayout layout, VkSampleCountFlagBits samples,
                            const Program& program) {
    constexpr VkSpecializationMapEntry kEntries[] = {{0, 0, 4}, {1, 4, 4}, {2, 8, 4}, {3, 12, 4}, {4, 16, 4}};
    const VkSpecializationInfo vertex_constants{5, kEntries, sizeof program.vertex_constants,
                                                program.vertex_constants.data()};
    const VkSpecializationInfo fragment_constants{2, kEntries, sizeof program.fragment_constants,
                                                  program.fragment_constants.data()};
    const OwnedShader vertex = make_shader(gpu, program.vertex);
    OwnedShader fragment;
    std::vector<VkPipelineShaderStageCreateInfo> stages;
    stages.push_back({VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_VERTEX_BIT,
                      vertex.get(), "main", &vertex_constants});
    if (!program.fragment.empty()) {
        fragment = make_shader(gpu, program.fragment);
        stages.push_back({VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_FRAGMENT_BIT,
                          fragment.get(), "main", &fragment_constants});
    }
    const bool is_shadow_map = program.depth == Depth::kShadowMap,
               depth_alone = is_shadow_map || program.depth == Depth::kAlone;

    // Vertices are fetched by the shader.
    const VkPipelineVertexInputStateCreateInfo vertex_input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo rasterization{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    rasterization.polygonMode = VK_POLYGON_MODE_FILL;
    rasterization.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    rasterization.lineWidth = 1;
    // What the sun grazes is put farther from it, so that it does not shadow itself between the texels of the map.
    rasterization.depthBiasEnable = is_shadow_map;
    rasterization.depthBiasSlopeFactor = -1.5f;
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = is_shadow_map ? VK_SAMPLE_COUNT_1_BIT : samples;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = program.depth != Depth::kNone;
    depth.depthWriteEnable = program.depth != Depth::kNone;
    depth.depthCompareOp = VK_COMPARE_OP_GREATER;  // reversed depth
    VkPipelineColorBlendAttachmentState attachment{};
    attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                                VK_COLOR_COMPONENT_A_BIT;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = depth_alone ? 0 : 1;
    blend.pAttachments = &attachment;
    constexpr std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR,
                                        VK_DYNAMIC_STATE_CULL_MODE};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = dynamic_states.size();
    dynamic.pDynamicStates = dynamic_states.data();
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = blend.attachmentCount;
    rendering.pColorAttachmentFormats = &program.color_format;
    rendering.depthAttachmentFormat = program.color_format == kColorFormat ? kDepthFormat : VK_FORMAT_UNDEFINED;

    VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    create.stageCount = static_cast<uint32_t>(stages.size());
    create.pStages = stages.data();
    create.pVertexInputState = &vertex_input;
    create.pInputAssemblyState = &assembly;
    create.pViewportState = &viewport;
    create.pRasterizationState = &rasterization;
    create.pMultisampleState = &multisample;
    create.pDepthStencilState = &depth;
    create.pColorBlendState = &blend;
    create.pDynamicState = &dynamic;
    create.layout = layout;
    return {gpu, gpu->make_pipeline(create)};
}

}  // namespace

DrawLayouts::DrawLayouts(const std::shared_ptr<Gpu>& gpu) {
    if (const uint32_t most = gpu->properties.limits.maxPerStageDescriptorStorageBuffers; kBatchBindings.size() > most)
        throw Failure(ErrorCode::kUnsupported, gpu->properties.deviceName,
                      "a shader stage has " + std::to_string(most) + " storage buffers, and drawing needs " +
                          std::to_string(kBatchBindings.size()));
    constexpr VkShaderStageFlags kBothStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    scene_set = make_set_layout(gpu, {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER},
                                kBothStages);
    batch_set = make_set_layout(gpu, std::vector(kBatchBindings.size(), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER),
                                VK_SHADER_STAGE_VERTEX_BIT);
    material_set = make_set_layout(gpu, std::vector(kMaterialTextures, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER),
                                   VK_SHADER_STAGE_FRAGMENT_BIT);
    const std::array sets{scene_set.get(), batch_set.get(), material_set.get()};
    const VkPushConstantRange push{kBothStages, 0, std::max(sizeof(io::DrawPush), sizeof(io::LinePush))};
    VkPipelineLayoutCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    create.setLayoutCount = sets.size();
    create.pSetLayouts = sets.data();
    create.pushConstantRangeCount = 1;
    create.pPushConstantRanges = &push;
    layout = {gpu, gpu->vk.vkCreatePipelineLayout, create, "vkCreatePipelineLayout"};
}

OwnedPipeline make_ground_pipeline(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts,
                                   VkSampleCountFlagBits samples) {
    return make_pipeline(gpu, layouts.layout.get(), samples, {.vertex = kGroundVertex, .fragment = kGroundFragment});
}

OwnedPipeline make_farthest_pipeline(const std::shared_ptr<Gpu>& gpu, VkPipelineLayout layout) {
    return make_pipeline(gpu, layout, VK_SAMPLE_COUNT_1_BIT,
                         {.vertex = kFarthestVertex, .fragment = kFarthestFragment, .color_format = kFarthestFormat});
}

CharacterPipelines::CharacterPipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts,
                                       VkSampleCountFlagBits samples, const VertexKind& kind) {
    const auto make = [&](const Program& program) {
        return make_pipeline(gpu, layouts.layout.get(), samples, program);
    };
    const auto vertex_constants = [&](bool is_shadow) {
        return std::array<uint32_t, 5>{is_shadow, static_cast<uint32_t>(kind.format), kind.listed,
                                       static_cast<uint32_t>(kind.blend), kind.skinned};
    };
    shadow[0] = make(
        {.vertex = kCharacterVertex, .vertex_constants = vertex_constants(true), .depth = Depth::kShadowMap});
    shadow[1] = make({.vertex = kCharacterVertex,
                      .fragment = kShadowFragment,
                      .vertex_constants = vertex_constants(true),
                      .depth = Depth::kShadowMap});
    occluder[0] = make(
        {.vertex = kCharacterVertex, .vertex_constants = vertex_constants(false), .depth = Depth::kAlone});
    occluder[1] = make({.vertex = kCharacterVertex,
                        .fragment = kShadowFragment,
                        .vertex_constants = vertex_constants(false),
                        .depth = Depth::kAlone});
    for (uint32_t discards = 0; discards < 2; ++discards)
        for (uint32_t has_maps = 0; has_maps < 2; ++has_maps)
            into_picture[discards][has_maps] = make({.vertex = kCharacterVertex,
                                                     .fragment = kCharacterFragment,
                                                     .vertex_constants = vertex_constants(false),
                                                     .fragment_constants = {discards, has_maps},
                                                     .depth = Depth::kTested});
}

LinePipelines::LinePipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, VkSampleCountFlagBits samples,
                             bool listed) {
    const std::array<uint32_t, 5> constants{listed};
    skeletons = make_pipeline(gpu, layouts.layout.get(), samples,
                              {.vertex = kSkeletonVertex, .fragment = kLineFragment, .vertex_constants = constants});
    bounds = make_pipeline(
        gpu, layouts.layout.get(), samples,
        {.vertex = kBoundsVertex, .fragment = kLineFragment, .vertex_constants = constants, .depth = Depth::kTested});
}

}  // namespace throng
