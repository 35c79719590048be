#include "tools/view/vulkan.h"

#include "tools/cli/command.h"

namespace throng::view {

void check(VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    if (result == VK_ERROR_DEVICE_LOST) throw tools::CommandError(std::string(call) + ": the device was lost");
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        throw tools::CommandError(std::string(call) + ": out of memory");
    throw tools::CommandError(std::string(call) + ": VkResult " + std::to_string(result));
}

OwnedMemory allocate_memory(VkPhysicalDevice physical_device, VkDevice device, const VkMemoryRequirements& needs,
                            VkMemoryPropertyFlags properties) {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(physical_device, &memory);
    uint32_t type = 0;
    while (type < memory.memoryTypeCount && !((needs.memoryTypeBits & (1u << type)) &&
                                              (memory.memoryTypes[type].propertyFlags & properties) == properties))
        ++type;
    if (type == memory.memoryTypeCount)
        throw tools::CommandError("the device has no memory type for a picture of the window");
    const VkMemoryAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needs.size, .memoryTypeIndex = type};
    return {device, vkAllocateMemory, allocate, "vkAllocateMemory"};
}

HostBuffer::HostBuffer(VkPhysicalDevice physical_device, VkDevice device, VkDeviceSize size_bytes)
    : device_(device), size_bytes_(size_bytes) {
    const VkBufferCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size_bytes, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    buffer_ = {device, vkCreateBuffer, create, "vkCreateBuffer"};
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device, buffer_.get(), &needs);
    memory_ = allocate_memory(physical_device, device, needs,
                              VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vkBindBufferMemory(device, buffer_.get(), memory_.get(), 0), "vkBindBufferMemory");
}

void HostBuffer::record_end(VkCommandBuffer commands) const {
    const VkMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                   .srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                   .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                   .dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT,
                                   .dstAccessMask = VK_ACCESS_2_HOST_READ_BIT};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

std::vector<uint8_t> HostBuffer::read() const {
    void* mapped = nullptr;
    check(vkMapMemory(device_, memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
    const auto* bytes = static_cast<const uint8_t*>(mapped);
    std::vector<uint8_t> out(bytes, bytes + size_bytes_);
    vkUnmapMemory(device_, memory_.get());
    return out;
}

void transition(VkCommandBuffer commands, VkImage image, const ImageUse& before, const ImageUse& after) {
    const VkImageMemoryBarrier2 barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                        .srcStageMask = before.stage,
                                        .srcAccessMask = before.access,
                                        .dstStageMask = after.stage,
                                        .dstAccessMask = after.access,
                                        .oldLayout = before.layout,
                                        .newLayout = after.layout,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkDependencyInfo dependency{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace throng::view
