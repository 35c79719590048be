#include "gpu/shader.h"

#include "base/failure.h"

#include <algorithm>
#include <deque>
#include <map>

namespace throng {
namespace {

VkDescriptorType descriptor_type(BindingKind kind) {
    switch (kind) {
        case BindingKind::kStorage: return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case BindingKind::kTexels: return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
        case BindingKind::kUniform: return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        case BindingKind::kImage: break;
    }
    return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
}

BufferRange buffer_of(const BufferTable& buffers, const BindingInfo& binding, std::string_view what) {
    const bool is_table = binding.kind == BindingKind::kTexels;
    const BufferRange& range = is_table ? buffers.table(binding.binding) : buffers.storage(binding.binding);
    const auto refuse = [&](const std::string& before, const std::string& after) {
        return Failure(ErrorCode::kInvalidArgument, std::string(what),
                       before + std::string(name_of_buffer(binding.binding)) + after);
    };
    if (!range.buffer) throw refuse("buffer '", "' is missing");
    if (is_table && range.texel_bytes == 0)
        throw refuse("buffer '", "' is read as a table, but was not created as one");
    return range;
}

}  // namespace

ShaderLayout::ShaderLayout(const std::shared_ptr<const Gpu>& gpu, std::span<const ShaderCode> shaders) : sets_(1) {
    std::vector<std::map<uint32_t, VkDescriptorSetLayoutBinding>> merged(1);
    for (const ShaderCode& shader : shaders) {
        const SpirvInfo info = read_spirv(shader.spirv);
        for (const BindingInfo& binding : info.bindings) {
            if (binding.set >= sets_.size()) sets_.resize(binding.set + 1), merged.resize(binding.set + 1);
            const auto [entry, is_new] = merged[binding.set].try_emplace(
                binding.binding, VkDescriptorSetLayoutBinding{binding.binding, descriptor_type(binding.kind), 1});
            if (entry->second.descriptorType != descriptor_type(binding.kind))
                throw Failure(ErrorCode::kInvalidArgument, "shaders",
                              "binding " + std::to_string(binding.binding) + " of set " + std::to_string(binding.set) +
                                  " has different types in different shaders");
            entry->second.stageFlags |= shader.stage;
            if (is_new) sets_[binding.set].bindings.push_back(binding);
        }
        if (info.push_constant_bytes == 0) continue;
        push_.stageFlags |= shader.stage;
        push_.size = std::max(push_.size, info.push_constant_bytes);
    }
    std::vector<VkDescriptorSetLayout> layouts;
    for (size_t number = 0; number < sets_.size(); ++number) {
        Set& set = sets_[number];
        std::ranges::sort(set.bindings, {}, &BindingInfo::binding);
        std::vector<VkDescriptorSetLayoutBinding> bindings;
        for (const auto& [binding, description] : merged[number]) bindings.push_back(description);
        const VkDescriptorSetLayoutCreateInfo create{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                     .bindingCount = static_cast<uint32_t>(bindings.size()),
                                                     .pBindings = bindings.data()};
        set.layout = {gpu, gpu->vk.vkCreateDescriptorSetLayout, create, "vkCreateDescriptorSetLayout"};
        layouts.push_back(set.layout.get());
    }
    const VkPipelineLayoutCreateInfo create{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = static_cast<uint32_t>(layouts.size()),
                                            .pSetLayouts = layouts.data(),
                                            .pushConstantRangeCount = push_.size > 0 ? 1u : 0u,
                                            .pPushConstantRanges = &push_};
    layout_ = {gpu, gpu->vk.vkCreatePipelineLayout, create, "vkCreatePipelineLayout"};
}

void check_storage_buffers(const Gpu& gpu, std::string_view place, std::span<const BindingInfo> bindings) {
    const auto count = std::ranges::count(bindings, BindingKind::kStorage, &BindingInfo::kind);
    if (const uint32_t limit = gpu.properties.limits.maxPerStageDescriptorStorageBuffers; count > limit)
        throw Failure(ErrorCode::kLimit, std::string(place),
                      std::to_string(count) + " storage buffers exceed the device's " + std::to_string(limit) +
                          " (maxPerStageDescriptorStorageBuffers)");
}

ShaderStage::ShaderStage(const std::shared_ptr<const Gpu>& gpu, const ShaderCode& code,
                         std::span<const uint32_t> constants) {
    const VkShaderModuleCreateInfo create{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                          .codeSize = code.spirv.size_bytes(),
                                          .pCode = code.spirv.data()};
    module_ = {gpu, gpu->vk.vkCreateShaderModule, create, "vkCreateShaderModule"};
    for (uint32_t id = 0; id < constants.size(); ++id) entries_.push_back({id, id * 4, 4});
    specialization_ = {static_cast<uint32_t>(entries_.size()), entries_.data(), constants.size_bytes(),
                       constants.data()};
    info_ = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
             .stage = code.stage,
             .module = module_.get(),
             .pName = "main",
             .pSpecializationInfo = &specialization_};
}

Bindings::Bindings(const std::shared_ptr<const Gpu>& gpu, std::string_view what, const ShaderLayout::Set& set,
                   const BufferTable& buffers, std::span<const VkDescriptorImageInfo> images) {
    if (gpu->compiles_only()) return;
    std::vector<VkDescriptorPoolSize> sizes;
    for (const BindingInfo& binding : set.bindings) sizes.push_back({descriptor_type(binding.kind), 1});
    const VkDescriptorPoolCreateInfo create{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .maxSets = 1,
                                            .poolSizeCount = static_cast<uint32_t>(sizes.size()),
                                            .pPoolSizes = sizes.data()};
    pool_ = {gpu, gpu->vk.vkCreateDescriptorPool, create, "vkCreateDescriptorPool"};
    const VkDescriptorSetLayout layout = set.layout.get();
    const VkDescriptorSetAllocateInfo allocate{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .descriptorPool = pool_.get(),
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &layout};
    check(gpu->vk.vkAllocateDescriptorSets(gpu->device, &allocate, &set_), "vkAllocateDescriptorSets");

    // Deques, since `writes` points to their elements.
    std::deque<VkDescriptorBufferInfo> infos;
    std::deque<VkBufferView> views;
    std::vector<VkWriteDescriptorSet> writes;
    for (const BindingInfo& binding : set.bindings) {
        VkWriteDescriptorSet& write = writes.emplace_back(
            VkWriteDescriptorSet{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                 .dstSet = set_,
                                 .dstBinding = binding.binding,
                                 .descriptorCount = 1,
                                 .descriptorType = descriptor_type(binding.kind)});
        if (binding.kind == BindingKind::kImage) {
            if (binding.binding >= images.size())
                throw Failure(ErrorCode::kInvalidArgument, std::string(what),
                              "the image of binding " + std::to_string(binding.binding) + " is missing");
            write.pImageInfo = &images[binding.binding];
            continue;
        }
        const BufferRange range = buffer_of(buffers, binding, what);
        if (binding.kind == BindingKind::kTexels) {
            const VkBufferViewCreateInfo view_create{
                .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                .buffer = range.buffer,
                .format = range.texel_bytes == 4 ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32B32A32_UINT,
                .offset = range.offset_bytes,
                .range = range.size_bytes};
            views_.emplace_back(gpu, gpu->vk.vkCreateBufferView, view_create, "vkCreateBufferView");
            write.pTexelBufferView = &views.emplace_back(views_.back().get());
        } else {
            write.pBufferInfo = &infos.emplace_back(
                VkDescriptorBufferInfo{range.buffer, range.offset_bytes, range.size_bytes});
        }
    }
    gpu->vk.vkUpdateDescriptorSets(gpu->device, static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

// If a buffer is missing, its stand-in for tables is used: a text may still read it and discard the value.
void Bindings::add_native(const BufferTable& buffers) {
    std::array<std::byte*, io::kBufferCount> bytes;
    for (uint32_t number = 0; number < io::kBufferCount; ++number) bytes[number] = buffers.table(number).bytes();
    native_ = std::make_unique<const std::array<std::byte*, io::kBufferCount>>(bytes);
}

}  // namespace throng
