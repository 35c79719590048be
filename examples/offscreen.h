// What every Vulkan application has somewhere, kept out of the examples' way: memory, buffers, and images to draw to.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <type_traits>
#include <vector>

inline void check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    std::fprintf(stderr, "%s failed: %d\n", call, result);
    std::exit(1);
}

// Destroys in the reverse order of creation.
class Cleanup {
public:
    ~Cleanup() {
        while (!steps_.empty()) {
            steps_.back()();
            steps_.pop_back();
        }
    }
    void add(std::function<void()> step) { steps_.push_back(std::move(step)); }

private:
    std::vector<std::function<void()>> steps_;
};

struct Context {
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    Cleanup& cleanup;
};

// Creates an object of the device, to be destroyed at the end.
template <class Info, class Handle>
Handle make(const Context& context, const char* call,
            VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
            void (*destroy)(VkDevice, Handle, const VkAllocationCallbacks*), const std::type_identity_t<Info>& info) {
    Handle out = VK_NULL_HANDLE;
    check(create(context.device, &info, nullptr, &out), call);
    context.cleanup.add([device = context.device, destroy, out] { destroy(device, out, nullptr); });
    return out;
}

inline VkDeviceMemory allocate(const Context& context, const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(context.physical_device, &memory);
    uint32_t type = 0;
    while (type < memory.memoryTypeCount &&
           (!(needs.memoryTypeBits >> type & 1) || (memory.memoryTypes[type].propertyFlags & flags) != flags))
        ++type;
    return make(
        context, "vkAllocateMemory", vkAllocateMemory, vkFreeMemory,
        {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type});
}

struct Buffer {
    VkBuffer handle = VK_NULL_HANDLE;
    void* mapped = nullptr;
};

// Host-visible: simple, and enough for an example.
inline Buffer make_buffer(const Context& context, size_t size_bytes, VkBufferUsageFlags usage,
                          const void* data = nullptr) {
    Buffer buffer{make(context, "vkCreateBuffer", vkCreateBuffer, vkDestroyBuffer,
                       {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_bytes, .usage = usage})};
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(context.device, buffer.handle, &needs);
    const VkDeviceMemory memory = allocate(context, needs,
                                           VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vkBindBufferMemory(context.device, buffer.handle, memory, 0), "vkBindBufferMemory");
    check(vkMapMemory(context.device, memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped), "vkMapMemory");
    if (data) std::memcpy(buffer.mapped, data, size_bytes);
    return buffer;
}

struct Image {
    VkImage handle = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
};

inline Image make_image(const Context& context, VkFormat format, VkExtent2D size, VkImageUsageFlags usage,
                        VkImageAspectFlags aspect) {
    const VkImage image = make(context, "vkCreateImage", vkCreateImage, vkDestroyImage,
                               {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                .imageType = VK_IMAGE_TYPE_2D,
                                .format = format,
                                .extent = {size.width, size.height, 1},
                                .mipLevels = 1,
                                .arrayLayers = 1,
                                .samples = VK_SAMPLE_COUNT_1_BIT,
                                .usage = usage});
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(context.device, image, &needs);
    check(vkBindImageMemory(context.device, image, allocate(context, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT), 0),
          "vkBindImageMemory");
    return {image, make(context, "vkCreateImageView", vkCreateImageView, vkDestroyImageView,
                        {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                         .image = image,
                         .viewType = VK_IMAGE_VIEW_TYPE_2D,
                         .format = format,
                         .subresourceRange = {aspect, 0, 1, 0, 1}})};
}

// A barrier between everything before it and everything after it, the host included: coarse, but short. Without an
// image it is a memory barrier alone.
inline void barrier(VkCommandBuffer commands, VkImage image = VK_NULL_HANDLE, VkImageAspectFlags aspect = 0,
                    VkImageLayout from = {}, VkImageLayout to = {}) {
    constexpr VkPipelineStageFlags2 kBefore = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    kAfter = kBefore | VK_PIPELINE_STAGE_2_HOST_BIT;
    constexpr VkAccessFlags2 kWritten = VK_ACCESS_2_MEMORY_WRITE_BIT, kUsed = kWritten | VK_ACCESS_2_MEMORY_READ_BIT;
    const VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, kBefore, kWritten, kAfter, kUsed};
    const VkImageMemoryBarrier2 transition{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                           nullptr,
                                           kBefore,
                                           kWritten,
                                           kAfter,
                                           kUsed,
                                           from,
                                           to,
                                           VK_QUEUE_FAMILY_IGNORED,
                                           VK_QUEUE_FAMILY_IGNORED,
                                           image,
                                           {aspect, 0, 1, 0, 1}};
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .memoryBarrierCount = 1,
                                .pMemoryBarriers = &memory,
                                .imageMemoryBarrierCount = image ? 1u : 0u,
                                .pImageMemoryBarriers = &transition};
    vkCmdPipelineBarrier2(commands, &info);
}

// The images that are drawn to, and the buffer that receives the pixels.
struct Target {
    VkExtent2D size{};
    Image color, depth;
    Buffer pixels;  // four bytes each, rows from the top
};

inline Target make_target(const Context& context, VkExtent2D size, VkFormat color, VkFormat depth) {
    return {size,
            make_image(context, color, size, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                       VK_IMAGE_ASPECT_COLOR_BIT),
            make_image(context, depth, size, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT),
            make_buffer(context, size_t{size.width} * size.height * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT)};
}

inline void begin_drawing(VkCommandBuffer commands, const Target& target) {
    constexpr VkImageLayout kLayout = VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL;
    barrier(commands, target.color.handle, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED, kLayout);
    barrier(commands, target.depth.handle, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, kLayout);
    VkRenderingAttachmentInfo color{.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
                                    .imageView = target.color.view,
                                    .imageLayout = kLayout,
                                    .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                    .storeOp = VK_ATTACHMENT_STORE_OP_STORE};
    VkRenderingAttachmentInfo depth = color;
    depth.imageView = target.depth.view;
    color.clearValue.color = {{0.02f, 0.03f, 0.05f, 1}};
    depth.clearValue.depthStencil.depth = 0;  // infinitely far
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{}, target.size},
                               .layerCount = 1,
                               .colorAttachmentCount = 1,
                               .pColorAttachments = &color,
                               .pDepthAttachment = &depth};
    vkCmdBeginRendering(commands, &info);
}

inline void end_drawing(VkCommandBuffer commands, const Target& target) {
    vkCmdEndRendering(commands);
    barrier(commands, target.color.handle, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL,
            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {target.size.width, target.size.height, 1}};
    vkCmdCopyImageToBuffer(commands, target.color.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target.pixels.handle, 1,
                           &region);
    barrier(commands);
}
