#include "tools/view/canvas.h"

#include <imgui.h>

#include <backends/imgui_impl_vulkan.h>

#include <array>

namespace throng::view {
namespace {

constexpr VkImageSubresourceLayers kLayer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

OwnedRenderPass make_render_pass(VkDevice device, VkFormat format) {
    const VkAttachmentDescription attachment{.format = format,
                                             .samples = VK_SAMPLE_COUNT_1_BIT,
                                             .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                             .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                             .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                             .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                             .initialLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                             .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
    const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass{
        .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1, .pColorAttachments = &color};
    constexpr VkAccessFlags kBlends = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    const std::array<VkSubpassDependency, 2> dependencies{
        {{VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
          VK_ACCESS_TRANSFER_WRITE_BIT, kBlends, 0},
         {0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
          kBlends, VK_ACCESS_TRANSFER_READ_BIT, 0}}};
    const VkRenderPassCreateInfo create{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                        .attachmentCount = 1,
                                        .pAttachments = &attachment,
                                        .subpassCount = 1,
                                        .pSubpasses = &subpass,
                                        .dependencyCount = dependencies.size(),
                                        .pDependencies = dependencies.data()};
    return {device, vkCreateRenderPass, create, "vkCreateRenderPass"};
}

}  // namespace

Canvas::Canvas(const Context& context, VkFormat format)
    : context_(&context), format_(format), render_pass_(make_render_pass(context.device(), format)) {}

void Canvas::resize(VkExtent2D extent) {
    extent_ = extent;
    const VkDevice device = context_->device();
    const VkImageCreateInfo image_create{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                         .imageType = VK_IMAGE_TYPE_2D,
                                         .format = format_,
                                         .extent = size(),
                                         .mipLevels = 1,
                                         .arrayLayers = 1,
                                         .samples = VK_SAMPLE_COUNT_1_BIT,
                                         .tiling = VK_IMAGE_TILING_OPTIMAL,
                                         .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                  VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT};
    image_ = {device, vkCreateImage, image_create, "vkCreateImage"};
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device, image_.get(), &needs);
    memory_ = allocate_memory(context_->physical_device(), device, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    check(vkBindImageMemory(device, image_.get(), memory_.get(), 0), "vkBindImageMemory");

    const VkImageViewCreateInfo view_create{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                            .image = image_.get(),
                                            .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                            .format = format_,
                                            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    view_ = {device, vkCreateImageView, view_create, "vkCreateImageView"};
    const VkImageView view = view_.get();
    const VkFramebufferCreateInfo framebuffer_create{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                     .renderPass = render_pass_.get(),
                                                     .attachmentCount = 1,
                                                     .pAttachments = &view,
                                                     .width = extent.width,
                                                     .height = extent.height,
                                                     .layers = 1};
    framebuffer_ = {device, vkCreateFramebuffer, framebuffer_create, "vkCreateFramebuffer"};

    read_back_ = {context_->physical_device(), device, VkDeviceSize{extent.width} * extent.height * 4};
}

void Canvas::record_picture(VkCommandBuffer commands, VkImage picture) const {
    transition(commands, image_.get(), {.stage = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT}, kCopiedTo);
    const VkImageCopy copy{.srcSubresource = kLayer, .dstSubresource = kLayer, .extent = size()};
    // Copies the bytes without conversion
    vkCmdCopyImage(commands, picture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image_.get(),
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
}

void Canvas::record_panels(VkCommandBuffer commands) const {
    const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                      .renderPass = render_pass_.get(),
                                      .framebuffer = framebuffer_.get(),
                                      .renderArea = {{0, 0}, extent_}};
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    vkCmdEndRenderPass(commands);
}

void Canvas::record_copy(VkCommandBuffer commands, VkImage shown) const {
    transition(commands, shown, {.stage = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT}, kCopiedTo);
    const VkImageCopy copy{.srcSubresource = kLayer, .dstSubresource = kLayer, .extent = size()};
    vkCmdCopyImage(commands, image_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, shown,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    transition(commands, shown, kCopiedTo,
               {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_NONE, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR});
}

void Canvas::record_read_back(VkCommandBuffer commands) const {
    const VkBufferImageCopy copy{.imageSubresource = kLayer, .imageExtent = size()};
    vkCmdCopyImageToBuffer(commands, image_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, read_back_.get(), 1, &copy);
    read_back_.record_end(commands);
}

Picture Canvas::read() const {
    Picture picture{extent_.width, extent_.height, read_back_.read()};
    for (size_t i = 0; i < picture.rgba.size(); i += 4) {
        if (format_ == VK_FORMAT_B8G8R8A8_UNORM) std::swap(picture.rgba[i], picture.rgba[i + 2]);
        picture.rgba[i + 3] = 255;  // the window is opaque
    }
    return picture;
}

}  // namespace throng::view
