#include "gpu/kernel.h"

#include "base/failure.h"

#include <algorithm>
#include <mutex>

namespace throng {

// The compiled part that kernels share. Does not keep the device alive: the device keeps it.
class CompiledKernel {
public:
    CompiledKernel(const Gpu& gpu, const KernelSettings& settings);

    // Throws where the device or the shader does not allow the settings.
    void check_settings(const Gpu& gpu, const KernelSettings& settings) const;
    // Made with the kernel; where there is a Gpu::processor, made on first use, since most updates run on that and need
    // no pipeline. Thread-safe.
    VkPipeline pipeline(const Gpu& gpu) const;

    SpirvInfo info;
    uint32_t workgroup_size = 0;
    ShaderLayout layout;

private:
    void make_pipeline(const Gpu& gpu) const;

    ShaderCode code_;
    std::vector<uint32_t> constants_;  // constant_id 0, 1, …
    uint32_t subgroup_size_ = 0;
    bool full_subgroups_ = false;
    mutable std::once_flag pipeline_made_;
    mutable OwnedPipeline pipeline_;
};

CompiledKernel::CompiledKernel(const Gpu& gpu, const KernelSettings& settings)
    : info(read_spirv(settings.spirv)),
      workgroup_size(settings.workgroup_size != 0 ? settings.workgroup_size : info.local_size_x),
      code_{VK_SHADER_STAGE_COMPUTE_BIT, settings.spirv},
      constants_{workgroup_size},
      subgroup_size_(settings.subgroup_size),
      full_subgroups_(settings.full_subgroups) {
    check_settings(gpu, settings);
    layout = ShaderLayout(gpu.unowned(), {&code_, 1});
    constants_.insert(constants_.end(), settings.constants.begin(), settings.constants.end());
    if (!gpu.processor) pipeline(gpu);
}

VkPipeline CompiledKernel::pipeline(const Gpu& gpu) const {
    std::call_once(pipeline_made_, [&] { make_pipeline(gpu); });
    return pipeline_.get();
}

void CompiledKernel::make_pipeline(const Gpu& gpu) const {
    const ShaderStage stage(gpu.unowned(), code_, constants_);
    VkComputePipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO, .stage = stage.info(), .layout = layout.get()};
    uint32_t subgroup_size = gpu.can_choose_subgroup ? subgroup_size_ : 0;
    if (gpu.compiled_subgroup_size > 0) subgroup_size = std::max(gpu.compiled_subgroup_size, subgroup_size);
    const VkPipelineShaderStageRequiredSubgroupSizeCreateInfo required{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO,
        .requiredSubgroupSize = subgroup_size};
    if (subgroup_size > 0) create.stage.pNext = &required;
    const uint32_t largest = subgroup_size > 0 ? subgroup_size : gpu.largest_subgroup;
    if (full_subgroups_ && gpu.has_full_subgroups && workgroup_size % largest == 0)
        create.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
    pipeline_ = {gpu.unowned(), gpu.make_pipeline(create)};
}

void CompiledKernel::check_settings(const Gpu& gpu, const KernelSettings& settings) const {
    if (info.local_size_is_specialized != (settings.workgroup_size != 0))
        throw Failure(ErrorCode::kInvalidArgument, std::string(settings.name),
                      "KernelSettings::workgroup_size must be set if the shader leaves it open, and only then");
    check_storage_buffers(gpu, settings.name, info.bindings);
}

namespace {

SharedKernels::Key key_of(const KernelSettings& settings) {
    SharedKernels::Key key{settings.spirv, {settings.workgroup_size, settings.subgroup_size, settings.full_subgroups}};
    key.settings.insert(key.settings.end(), settings.constants.begin(), settings.constants.end());
    return key;
}

}  // namespace

void make_pipelines(Gpu& gpu) {
    for (const SharedKernels::Shared& kernel : gpu.kernels.in_use()) kernel->pipeline(gpu);
}

Kernel::Kernel(std::shared_ptr<Gpu> gpu, const KernelSettings& settings) : gpu_(std::move(gpu)), name_(settings.name) {
    if (gpu_->processor && settings.native) {
        native_ = settings.native;
        workgroup_size_ = settings.workgroup_size != 0 ? settings.workgroup_size : native_->workgroup_size;
        constants_.push_back(workgroup_size_);
        constants_.insert(constants_.end(), settings.constants.begin(), settings.constants.end());
    }
    if (gpu_->is_native()) {
        if (!native_) throw Failure(ErrorCode::kUnsupported, name_, "this kernel cannot run on a native device");
        return;
    }
    SharedKernels::Key key = key_of(settings);
    compiled_ = gpu_->kernels.find(key);
    if (compiled_)
        compiled_->check_settings(*gpu_, settings);  // tests lower the limits of a device that has the pipeline
    else
        compiled_ = gpu_->kernels.add(std::move(key), std::make_shared<const CompiledKernel>(*gpu_, settings));
    workgroup_size_ = compiled_->workgroup_size;
    if (gpu_->on_pipeline) gpu_->on_pipeline({name_, workgroup_size_, compiled_->pipeline(*gpu_)});
}

Bindings Kernel::bind(const BufferTable& buffers) const {
    Bindings bindings;
    if (compiled_) bindings = Bindings(gpu_, name_, compiled_->layout.set(0), buffers);
    if (native_) bindings.add_native(buffers);
    return bindings;
}

void Kernel::dispatch(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes,
                      uint32_t workgroup_count) const {
    if (!commands) return run_native(bindings, push, push_bytes, workgroup_count);
    if (workgroup_count > gpu_->properties.limits.maxComputeWorkGroupCount[0])
        throw Failure(ErrorCode::kLimit, name_,
                      std::to_string(workgroup_count) + " workgroups exceed the device's " +
                          std::to_string(gpu_->properties.limits.maxComputeWorkGroupCount[0]));
    prepare(commands, bindings, push, push_bytes);
    gpu_->vk.vkCmdDispatch(commands, workgroup_count, 1, 1);
}

void Kernel::dispatch_indirect(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes,
                               const BufferRange& workgroups) const {
    if (!commands) {
        VkDispatchIndirectCommand command;
        std::memcpy(&command, workgroups.bytes(), sizeof command);
        return run_native(bindings, push, push_bytes, command.x);
    }
    prepare(commands, bindings, push, push_bytes);
    gpu_->vk.vkCmdDispatchIndirect(commands, workgroups.buffer, workgroups.offset_bytes);
}

void Kernel::run_native(const Bindings& bindings, const void* push, size_t push_bytes, uint32_t workgroup_count) const {
    if (!native_) throw Failure(ErrorCode::kUnsupported, name_, "this kernel runs only on Vulkan");
    check_push(native_->push_bytes, push_bytes);
    gpu_->processor->run(*native_, {.buffers = bindings.native(), .constants = constants_, .push = push},
                         workgroup_count);
}

void Kernel::check_push(size_t expected_bytes, size_t push_bytes) const {
    if (push_bytes != expected_bytes)
        throw Failure(ErrorCode::kInvalidArgument, name_,
                      "the kernel takes " + std::to_string(expected_bytes) + " bytes of push constants, not " +
                          std::to_string(push_bytes));
}

void Kernel::prepare(VkCommandBuffer commands, const Bindings& bindings, const void* push, size_t push_bytes) const {
    check_push(compiled_->info.push_constant_bytes, push_bytes);
    const VkDescriptorSet set = bindings.set();
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compiled_->pipeline(*gpu_));
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, compiled_->layout.get(), 0, 1, &set, 0,
                                     nullptr);
    gpu_->vk.vkCmdPushConstants(commands, compiled_->layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                static_cast<uint32_t>(push_bytes), push);
}

}  // namespace throng
