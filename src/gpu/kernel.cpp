#include "gpu/kernel.h"

#include "base/failure.h"

#include <algorithm>
#include <utility>

namespace throng {

namespace {

VkDescriptorType descriptor_type(BindingKind kind) {
    return kind == BindingKind::kStorage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

}  // namespace

Bindings::Bindings(std::shared_ptr<Gpu> gpu, VkDescriptorSetLayout layout, std::string_view what,
                   std::span<const BindingInfo> bindings, const BufferTable& buffers)
    : gpu_(std::move(gpu)) {
    try {
        write(layout, what, bindings, buffers);
    } catch (...) {
        destroy();
        throw;
    }
}

void Bindings::write(VkDescriptorSetLayout layout, std::string_view what, std::span<const BindingInfo> bindings,
                     const BufferTable& buffers) {
    const auto count = static_cast<uint32_t>(bindings.size());
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, count},
                                          {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, count}};
    VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    create.maxSets = 1;
    create.poolSizeCount = static_cast<uint32_t>(std::size(sizes));
    create.pPoolSizes = sizes;
    check(gpu_->vk.vkCreateDescriptorPool(gpu_->device, &create, nullptr, &pool_), "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = pool_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    check(gpu_->vk.vkAllocateDescriptorSets(gpu_->device, &allocate, &set_), "vkAllocateDescriptorSets");

    std::vector<VkDescriptorBufferInfo> infos;
    std::vector<VkWriteDescriptorSet> writes;
    infos.reserve(bindings.size());
    views_.reserve(bindings.size());
    for (const BindingInfo& binding : bindings) {
        const bool is_storage = binding.kind == BindingKind::kStorage;
        const BufferRange& range = is_storage ? buffers.storage(binding.binding) : buffers.table(binding.binding);
        if (!range.buffer)
            throw Failure(ErrorCode::kInvalidArgument, std::string(what),
                          "there is no buffer of " + std::string(name_of_buffer(binding.binding)));
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set_;
        write.dstBinding = binding.binding;
        write.descriptorCount = 1;
        write.descriptorType = descriptor_type(binding.kind);
        if (is_storage) {
            infos.push_back({range.buffer, range.offset_bytes, range.size_bytes});
            write.pBufferInfo = &infos.back();
        } else {
            views_.push_back(texel_view(what, binding, range));
            write.pTexelBufferView = &views_.back();
        }
        writes.push_back(write);
    }
    gpu_->vk.vkUpdateDescriptorSets(gpu_->device, static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

VkBufferView Bindings::texel_view(std::string_view what, const BindingInfo& binding, const BufferRange& range) {
    if (range.texel_bytes == 0)
        throw Failure(
            ErrorCode::kInvalidArgument, std::string(what),
            "the buffer of " + std::string(name_of_buffer(binding.binding)) + " is read as texels, and is no table");
    VkBufferViewCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
    create.buffer = range.buffer;
    create.offset = range.offset_bytes;
    create.range = range.size_bytes;
    create.format = range.texel_bytes == 4 ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32B32A32_UINT;
    VkBufferView view = VK_NULL_HANDLE;
    check(gpu_->vk.vkCreateBufferView(gpu_->device, &create, nullptr, &view), "vkCreateBufferView");
    return view;
}

void Bindings::destroy() noexcept {
    if (!gpu_) return;
    for (VkBufferView view : views_) gpu_->vk.vkDestroyBufferView(gpu_->device, view, nullptr);
    gpu_->vk.vkDestroyDescriptorPool(gpu_->device, pool_, nullptr);
    gpu_.reset();
}

void Bindings::swap(Bindings& other) noexcept {
    std::swap(gpu_, other.gpu_);
    std::swap(views_, other.views_);
    std::swap(pool_, other.pool_);
    std::swap(set_, other.set_);
}

Kernel::Kernel(std::shared_ptr<Gpu> gpu, const KernelSettings& settings)
    : gpu_(std::move(gpu)), name_(settings.name), info_(read_spirv(settings.spirv)) {
    workgroup_size_ = settings.workgroup_size != 0 ? settings.workgroup_size : info_.local_size_x;
    if (info_.local_size_is_specialized != (settings.workgroup_size != 0))
        throw Failure(ErrorCode::kInvalidArgument, name_,
                      "the workgroup size must be given exactly where the shader leaves it open");
    const auto storage_buffers = std::count_if(
        info_.bindings.begin(), info_.bindings.end(),
        [](const BindingInfo& binding) { return binding.kind == BindingKind::kStorage; });
    if (const uint32_t limit = gpu_->properties.limits.maxPerStageDescriptorStorageBuffers; storage_buffers > limit)
        throw Failure(ErrorCode::kLimit, name_,
                      std::to_string(storage_buffers) + " storage buffers exceed the device's " +
                          std::to_string(limit) + " (maxPerStageDescriptorStorageBuffers)");
    try {
        create(settings);
    } catch (...) {
        destroy();
        throw;
    }
}

void Kernel::create(const KernelSettings& settings) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const BindingInfo& binding : info_.bindings)
        bindings.push_back({binding.binding, descriptor_type(binding.kind), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo set_create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_create.bindingCount = static_cast<uint32_t>(bindings.size());
    set_create.pBindings = bindings.data();
    check(gpu_->vk.vkCreateDescriptorSetLayout(gpu_->device, &set_create, nullptr, &set_layout_),
          "vkCreateDescriptorSetLayout");

    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, info_.push_constant_bytes};
    VkPipelineLayoutCreateInfo layout_create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_create.setLayoutCount = 1;
    layout_create.pSetLayouts = &set_layout_;
    layout_create.pushConstantRangeCount = 1;
    layout_create.pPushConstantRanges = &push;
    check(gpu_->vk.vkCreatePipelineLayout(gpu_->device, &layout_create, nullptr, &layout_), "vkCreatePipelineLayout");

    std::vector<uint32_t> values{workgroup_size_};
    values.insert(values.end(), settings.constants.begin(), settings.constants.end());
    std::vector<VkSpecializationMapEntry> entries;
    for (uint32_t id = 0; id < values.size(); ++id) entries.push_back({id, id * 4, 4});
    VkSpecializationInfo specialization{};
    specialization.mapEntryCount = static_cast<uint32_t>(entries.size());
    specialization.pMapEntries = entries.data();
    specialization.dataSize = values.size() * 4;
    specialization.pData = values.data();

    VkShaderModuleCreateInfo module_create{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_create.codeSize = settings.spirv.size_bytes();
    module_create.pCode = settings.spirv.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check(gpu_->vk.vkCreateShaderModule(gpu_->device, &module_create, nullptr, &module), "vkCreateShaderModule");
    VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    create.layout = layout_;
    create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    create.stage.module = module;
    create.stage.pName = "main";
    if (settings.full_subgroups && gpu_->has_full_subgroups && workgroup_size_ % gpu_->largest_subgroup == 0)
        create.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
    create.stage.pSpecializationInfo = &specialization;
    const VkResult result = gpu_->vk.vkCreateComputePipelines(gpu_->device, VK_NULL_HANDLE, 1, &create, nullptr,
                                                              &pipeline_);
    gpu_->vk.vkDestroyShaderModule(gpu_->device, module, nullptr);
    check(result, "vkCreateComputePipelines");
}

Kernel::~Kernel() { destroy(); }

void Kernel::destroy() noexcept {
    if (!gpu_) return;
    gpu_->vk.vkDestroyPipeline(gpu_->device, pipeline_, nullptr);
    gpu_->vk.vkDestroyPipelineLayout(gpu_->device, layout_, nullptr);
    gpu_->vk.vkDestroyDescriptorSetLayout(gpu_->device, set_layout_, nullptr);
    gpu_.reset();
}

void Kernel::swap(Kernel& other) noexcept {
    std::swap(gpu_, other.gpu_);
    std::swap(name_, other.name_);
    std::swap(info_, other.info_);
    std::swap(workgroup_size_, other.workgroup_size_);
    std::swap(set_layout_, other.set_layout_);
    std::swap(layout_, other.layout_);
    std::swap(pipeline_, other.pipeline_);
}

void Kernel::dispatch(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes,
                      uint32_t workgroup_count) const {
    if (workgroup_count > gpu_->properties.limits.maxComputeWorkGroupCount[0])
        throw Failure(ErrorCode::kLimit, name_,
                      std::to_string(workgroup_count) + " workgroups exceed the device's " +
                          std::to_string(gpu_->properties.limits.maxComputeWorkGroupCount[0]));
    prepare(commands, bindings, push, push_bytes);
    gpu_->vk.vkCmdDispatch(commands, workgroup_count, 1, 1);
}

void Kernel::prepare(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes) const {
    if (push_bytes != info_.push_constant_bytes)
        throw Failure(ErrorCode::kInvalidArgument, name_,
                      "the push constants have " + std::to_string(info_.push_constant_bytes) + " bytes, not " +
                          std::to_string(push_bytes));
    const VkDescriptorSet set = bindings.set();
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set, 0, nullptr);
    gpu_->vk.vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<uint32_t>(push_bytes),
                                push);
}

}  // namespace throng
