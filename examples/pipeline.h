// Pipelines that have storage buffers and a push constant, and the command buffer that they are used in.
#pragma once

#include "offscreen.h"

#include <throng/outputs.h>

#include <array>
#include <span>

struct PipelineSettings {
    std::span<const uint32_t> vertex_shader, fragment_shader;
    uint32_t storage_buffer_count = 0, push_size_bytes = 0;  // for the vertex shader
    VkFormat color = {}, depth = {};
    VkExtent2D size{};
};

struct Pipeline {
    VkPipelineBindPoint bind_point = VK_PIPELINE_BIND_POINT_GRAPHICS;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline handle = VK_NULL_HANDLE;
};

inline VkPipelineShaderStageCreateInfo make_stage(const Context& context, VkShaderStageFlagBits stage,
                                                  std::span<const uint32_t> words) {
    return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = stage,
            .module = make(context, "vkCreateShaderModule", vkCreateShaderModule, vkDestroyShaderModule,
                           {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                            .codeSize = words.size_bytes(),
                            .pCode = words.data()}),
            .pName = "main"};
}

// Makes the layout, but not yet the pipeline itself.
inline Pipeline make_layout(const Context& context, VkShaderStageFlags stage, uint32_t storage_buffer_count,
                            uint32_t push_size_bytes) {
    Pipeline out;
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < storage_buffer_count; ++i)
        bindings.push_back({i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, stage, nullptr});
    out.set_layout = make(context, "vkCreateDescriptorSetLayout", vkCreateDescriptorSetLayout,
                          vkDestroyDescriptorSetLayout,
                          {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                           .bindingCount = storage_buffer_count,
                           .pBindings = bindings.data()});
    const VkPushConstantRange push{stage, 0, push_size_bytes};
    out.layout = make(context, "vkCreatePipelineLayout", vkCreatePipelineLayout, vkDestroyPipelineLayout,
                      {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                       .setLayoutCount = 1,
                       .pSetLayouts = &out.set_layout,
                       .pushConstantRangeCount = 1,
                       .pPushConstantRanges = &push});
    return out;
}

inline Pipeline make_compute_pipeline(const Context& context, std::span<const uint32_t> shader,
                                      uint32_t storage_buffer_count, uint32_t push_size_bytes) {
    Pipeline out = make_layout(context, VK_SHADER_STAGE_COMPUTE_BIT, storage_buffer_count, push_size_bytes);
    out.bind_point = VK_PIPELINE_BIND_POINT_COMPUTE;
    const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                           .stage = make_stage(context, VK_SHADER_STAGE_COMPUTE_BIT, shader),
                                           .layout = out.layout};
    check(vkCreateComputePipelines(context.device, VK_NULL_HANDLE, 1, &info, nullptr, &out.handle),
          "vkCreateComputePipelines");
    context.cleanup.add([device = context.device, out] { vkDestroyPipeline(device, out.handle, nullptr); });
    return out;
}

inline Pipeline make_pipeline(const Context& context, const PipelineSettings& settings) {
    Pipeline out = make_layout(context, VK_SHADER_STAGE_VERTEX_BIT, settings.storage_buffer_count,
                               settings.push_size_bytes);
    const std::array stages{make_stage(context, VK_SHADER_STAGE_VERTEX_BIT, settings.vertex_shader),
                            make_stage(context, VK_SHADER_STAGE_FRAGMENT_BIT, settings.fragment_shader)};
    const VkPipelineVertexInputStateCreateInfo no_input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo triangles{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkViewport viewport{0, 0, static_cast<float>(settings.size.width), static_cast<float>(settings.size.height),
                              0, 1};
    const VkRect2D scissor{{}, settings.size};
    const VkPipelineViewportStateCreateInfo view{.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
                                                 .viewportCount = 1,
                                                 .pViewports = &viewport,
                                                 .scissorCount = 1,
                                                 .pScissors = &scissor};
    const VkPipelineRasterizationStateCreateInfo raster{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO, .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo samples{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = VK_TRUE,
        .depthCompareOp = VK_COMPARE_OP_GREATER};  // reversed depth, as throng::view_of() has it
    const VkPipelineColorBlendAttachmentState opaque{.colorWriteMask = 0xF};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = 1,
                                                    .pAttachments = &opaque};
    const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                  .colorAttachmentCount = 1,
                                                  .pColorAttachmentFormats = &settings.color,
                                                  .depthAttachmentFormat = settings.depth};
    const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                            .pNext = &rendering,
                                            .stageCount = static_cast<uint32_t>(stages.size()),
                                            .pStages = stages.data(),
                                            .pVertexInputState = &no_input,
                                            .pInputAssemblyState = &triangles,
                                            .pViewportState = &view,
                                            .pRasterizationState = &raster,
                                            .pMultisampleState = &samples,
                                            .pDepthStencilState = &depth,
                                            .pColorBlendState = &blend,
                                            .layout = out.layout};
    check(vkCreateGraphicsPipelines(context.device, VK_NULL_HANDLE, 1, &info, nullptr, &out.handle),
          "vkCreateGraphicsPipelines");
    context.cleanup.add([device = context.device, out] { vkDestroyPipeline(device, out.handle, nullptr); });
    return out;
}

// Binds the pipeline, and these buffers by a descriptor set of their own.
inline void bind(const Context& context, VkCommandBuffer commands, const Pipeline& pipeline,
                 const std::vector<throng::BufferView>& buffers) {
    const auto count = static_cast<uint32_t>(buffers.size());
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count};
    const VkDescriptorSetAllocateInfo allocation{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
        .descriptorPool = make(context, "vkCreateDescriptorPool", vkCreateDescriptorPool, vkDestroyDescriptorPool,
                               {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                .maxSets = 1,
                                .poolSizeCount = 1,
                                .pPoolSizes = &size}),
        .descriptorSetCount = 1,
        .pSetLayouts = &pipeline.set_layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    check(vkAllocateDescriptorSets(context.device, &allocation, &set), "vkAllocateDescriptorSets");
    std::vector<VkDescriptorBufferInfo> ranges;
    for (const throng::BufferView& view : buffers) ranges.push_back({view.buffer, view.offset_bytes, view.size_bytes});
    const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                     .dstSet = set,
                                     .descriptorCount = count,
                                     .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                     .pBufferInfo = ranges.data()};
    vkUpdateDescriptorSets(context.device, 1, &write, 0, nullptr);
    vkCmdBindPipeline(commands, pipeline.bind_point, pipeline.handle);
    vkCmdBindDescriptorSets(commands, pipeline.bind_point, pipeline.layout, 0, 1, &set, 0, nullptr);
}

inline VkCommandBuffer begin_commands(const Context& context, uint32_t queue_family) {
    const VkCommandBufferAllocateInfo allocation{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = make(context, "vkCreateCommandPool", vkCreateCommandPool, vkDestroyCommandPool,
                            {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, .queueFamilyIndex = queue_family}),
        .commandBufferCount = 1};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(vkAllocateCommandBuffers(context.device, &allocation, &commands), "vkAllocateCommandBuffers");
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    return commands;
}

inline void submit_and_wait(VkQueue queue, VkCommandBuffer commands) {
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    const VkSubmitInfo submit{
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    check(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
    check(vkQueueWaitIdle(queue), "vkQueueWaitIdle");
}
