#include "draw/pipeline.h"

#include "base/failure.h"
#include "draw/draw_io.h"

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

struct Program {
    std::span<const uint32_t> vertex, fragment;
    bool vertex_constant = false, fragment_constant = false;  // constant_id 0
    SkinFormat skin_format = SkinFormat::kAffine;             // constant_id 1 of the vertex shader
    bool listed = false;                                      // constant_id 2 of the vertex shader
    bool depth = false;
};

OwnedSetLayout make_set_layout(const std::shared_ptr<Gpu>& gpu, VkDescriptorType type, uint32_t count, VkShaderStageFlags stages) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < count; ++i) bindings.push_back({i, type, 1, stages, nullptr});
    VkDescriptorSetLayoutCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    create.bindingCount = count;
    create.pBindings = bindings.data();
    return {gpu, gpu->vk.vkCreateDescriptorSetLayout, create, "vkCreateDescriptorSetLayout"};
}

OwnedShader make_shader(const std::shared_ptr<Gpu>& gpu, std::span<const uint32_t> spirv) {
    VkShaderModuleCreateInfo create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    create.codeSize = spirv.size_bytes();
    create.pCode = spirv.data();
    return {gpu, gpu->vk.vkCreateShaderModule, create, "vkCreateShaderModule"};
}

OwnedPipeline make_pipeline(const std::shared_ptr<Gpu>& gpu, VkPipelineLayout layout, VkSampleCountFlagBits samples, const Program& program) {
    const OwnedShader vertex = make_shader(gpu, program.vertex), fragment = make_shader(gpu, program.fragment);
    const std::array<uint32_t, 3> vertex_values{program.vertex_constant, static_cast<uint32_t>(program.skin_format), program.listed};
    const uint32_t fragment_value = program.fragment_constant;
    constexpr VkSpecializationMapEntry kEntries[] = {{0, 0, 4}, {1, 4, 4}, {2, 8, 4}};
    const VkSpecializationInfo vertex_constants{3, kEntries, sizeof vertex_values, vertex_values.data()};
    const VkSpecializationInfo fragment_constants{1, kEntries, sizeof fragment_value, &fragment_value};
    std::array<VkPipelineShaderStageCreateInfo, 2> stages{};
    stages[0] = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_VERTEX_BIT, vertex.get(), "main", &vertex_constants};
    stages[1] = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get(), "main", &fragment_constants};

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
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = samples;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = program.depth;
    depth.depthWriteEnable = program.depth;
    depth.depthCompareOp = VK_COMPARE_OP_GREATER;  // reversed depth
    VkPipelineColorBlendAttachmentState attachment{};
    attachment.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &attachment;
    constexpr std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR, VK_DYNAMIC_STATE_CULL_MODE};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = dynamic_states.size();
    dynamic.pDynamicStates = dynamic_states.data();
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachmentFormats = &kColorFormat;
    rendering.depthAttachmentFormat = kDepthFormat;

    VkGraphicsPipelineCreateInfo create{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO, &rendering};
    create.stageCount = stages.size();
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
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(gpu->vk.vkCreateGraphicsPipelines(gpu->device, VK_NULL_HANDLE, 1, &create, nullptr, &pipeline), "vkCreateGraphicsPipelines");
    return {gpu, pipeline};
}

}  // namespace

DrawLayouts::DrawLayouts(const std::shared_ptr<Gpu>& gpu) {
    if (const uint32_t most = gpu->properties.limits.maxPerStageDescriptorStorageBuffers; kBatchBindings.size() > most)
        throw Failure(ErrorCode::kUnsupported, gpu->properties.deviceName, "a shader stage has " + std::to_string(most) + " storage buffers, and drawing needs " + std::to_string(kBatchBindings.size()));
    constexpr VkShaderStageFlags kBothStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    scene_set = make_set_layout(gpu, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, kBothStages);
    batch_set = make_set_layout(gpu, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kBatchBindings.size(), VK_SHADER_STAGE_VERTEX_BIT);
    material_set = make_set_layout(gpu, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT);
    const std::array sets{scene_set.get(), batch_set.get(), material_set.get()};
    const VkPushConstantRange push{kBothStages, 0, sizeof(io::DrawPush)};
    VkPipelineLayoutCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    create.setLayoutCount = sets.size();
    create.pSetLayouts = sets.data();
    create.pushConstantRangeCount = 1;
    create.pPushConstantRanges = &push;
    layout = {gpu, gpu->vk.vkCreatePipelineLayout, create, "vkCreatePipelineLayout"};
}

DrawPipelines::DrawPipelines(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, VkSampleCountFlagBits samples, SkinFormat format, bool listed) {
    const auto make = [&](const Program& program) { return make_pipeline(gpu, layouts.layout.get(), samples, program); };
    ground = make({.vertex = kGroundVertex, .fragment = kGroundFragment});
    shadow = make({.vertex = kCharacterVertex, .fragment = kShadowFragment, .vertex_constant = true, .skin_format = format, .listed = listed});
    character = make({.vertex = kCharacterVertex, .fragment = kCharacterFragment, .skin_format = format, .listed = listed, .depth = true});
    character_discards = make({.vertex = kCharacterVertex, .fragment = kCharacterFragment, .fragment_constant = true, .skin_format = format, .listed = listed, .depth = true});
}

}  // namespace throng
