#include "gpu/kernel.h"

#include "base/failure.h"

#include <algorithm>
#include <utility>

namespace throng {

namespace {

VkDescriptorType descriptor_type(BindingKind kind) {
    return kind == BindingKind::kStorage ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

// Only needed while a pipeline is made.
struct OwnedModule {
    const Gpu& gpu;
    VkShaderModule module;
    ~OwnedModule() { gpu.vk.vkDestroyShaderModule(gpu.device, module, nullptr); }
};

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

// What kernels share. Does not keep the device: the device keeps it.
struct CompiledKernel {
    CompiledKernel(const Gpu& gpu, const KernelSettings& settings);
    ~CompiledKernel();
    CompiledKernel(const CompiledKernel&) = delete;

    const Gpu& gpu;
    SpirvInfo info;
    uint32_t workgroup_size = 0;
    VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline pipeline = VK_NULL_HANDLE;

    // Throws where the device or the shader does not allow the settings.
    void check_settings(const KernelSettings& settings) const;

private:
    void create(const KernelSettings& settings);
    void destroy() noexcept;
};

CompiledKernel::CompiledKernel(const Gpu& gpu_in, const KernelSettings& settings)
    : gpu(gpu_in), info(read_spirv(settings.spirv)) {
    workgroup_size = settings.workgroup_size != 0 ? settings.workgroup_size : info.local_size_x;
    check_settings(settings);
    try {
        create(settings);
    } catch (...) {
        destroy();
        throw;
    }
}

CompiledKernel::~CompiledKernel() { destroy(); }

void CompiledKernel::destroy() noexcept {
    gpu.vk.vkDestroyPipeline(gpu.device, pipeline, nullptr);
    gpu.vk.vkDestroyPipelineLayout(gpu.device, layout, nullptr);
    gpu.vk.vkDestroyDescriptorSetLayout(gpu.device, set_layout, nullptr);
}

void CompiledKernel::check_settings(const KernelSettings& settings) const {
    const std::string place(settings.name);
    if (info.local_size_is_specialized != (settings.workgroup_size != 0))
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "the workgroup size must be given exactly where the shader leaves it open");
    const auto storage_buffers = std::count_if(
        info.bindings.begin(), info.bindings.end(),
        [](const BindingInfo& binding) { return binding.kind == BindingKind::kStorage; });
    if (const uint32_t limit = gpu.properties.limits.maxPerStageDescriptorStorageBuffers; storage_buffers > limit)
        throw Failure(ErrorCode::kLimit, place,
                      std::to_string(storage_buffers) + " storage buffers exceed the device's " +
                          std::to_string(limit) + " (maxPerStageDescriptorStorageBuffers)");
}

void CompiledKernel::create(const KernelSettings& settings) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const BindingInfo& binding : info.bindings)
        bindings.push_back({binding.binding, descriptor_type(binding.kind), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo set_create{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set_create.bindingCount = static_cast<uint32_t>(bindings.size());
    set_create.pBindings = bindings.data();
    check(gpu.vk.vkCreateDescriptorSetLayout(gpu.device, &set_create, nullptr, &set_layout),
          "vkCreateDescriptorSetLayout");

    const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, info.push_constant_bytes};
    VkPipelineLayoutCreateInfo layout_create{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout_create.setLayoutCount = 1;
    layout_create.pSetLayouts = &set_layout;
    layout_create.pushConstantRangeCount = 1;
    layout_create.pPushConstantRanges = &push;
    check(gpu.vk.vkCreatePipelineLayout(gpu.device, &layout_create, nullptr, &layout), "vkCreatePipelineLayout");

    std::vector<uint32_t> values{workgroup_size};
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
    check(gpu.vk.vkCreateShaderModule(gpu.device, &module_create, nullptr, &module), "vkCreateShaderModule");
    const OwnedModule owned{gpu, module};
    VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    create.layout = layout;
    create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    create.stage.module = module;
    create.stage.pName = "main";
    if (settings.full_subgroups && gpu.has_full_subgroups && workgroup_size % gpu.largest_subgroup == 0)
        create.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
    create.stage.pSpecializationInfo = &specialization;
    pipeline = gpu.make_pipeline(create);
}

namespace {

SharedKernels::Key key_of(const KernelSettings& settings) {
    SharedKernels::Key key{static_cast<uint32_t>(settings.spirv.size()), settings.workgroup_size,
                           settings.full_subgroups};
    key.insert(key.end(), settings.spirv.begin(), settings.spirv.end());
    key.insert(key.end(), settings.constants.begin(), settings.constants.end());
    return key;
}

}  // namespace

Kernel::Kernel(std::shared_ptr<Gpu> gpu, const KernelSettings& settings) : gpu_(std::move(gpu)), name_(settings.name) {
    SharedKernels::Key key = key_of(settings);
    compiled_ = gpu_->kernels.find(key);
    if (compiled_)
        compiled_->check_settings(settings);  // tests lower limits of a device that has the pipeline
    else
        compiled_ = gpu_->kernels.add(std::move(key), std::make_shared<const CompiledKernel>(*gpu_, settings));
    workgroup_size_ = compiled_->workgroup_size;
}

void Kernel::swap(Kernel& other) noexcept {
    std::swap(gpu_, other.gpu_);
    std::swap(name_, other.name_);
    std::swap(compiled_, other.compiled_);
    std::swap(workgroup_size_, other.workgroup_size_);
}

Bindings Kernel::bind(const BufferTable& buffers) const {
    return Bindings(gpu_, compiled_->set_layout, name_, compiled_->info.bindings, buffers);
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
    if (push_bytes != compiled_->info.push_constant_bytes)
        throw Failure(ErrorCode::kInvalidArgument, name_,
                      "the push constants have " + std::to_string(compiled_->info.push_constant_bytes) +
                          " bytes, not " + std::to_string(push_bytes));
    const VkDescriptorSet set = bindings.set();
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compiled_->pipeline);
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compiled_->layout, 0, 1, &set, 0,
                                     nullptr);
    gpu_->vk.vkCmdPushConstants(commands, compiled_->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                static_cast<uint32_t>(push_bytes), push);
}

}  // namespace throng
