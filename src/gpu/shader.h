// What pipelines need of shaders: the layouts that their SPIR-V asks for, their constants, and what is bound to them.
#pragma once

#include "gpu/buffer_table.h"
#include "gpu/owned.h"
#include "gpu/spirv_info.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace throng {

struct ShaderCode {
    VkShaderStageFlagBits stage = VK_SHADER_STAGE_COMPUTE_BIT;
    std::span<const uint32_t> spirv;
};

// What pipelines made of some shaders share: their descriptor sets and push constants.
class ShaderLayout {
public:
    ShaderLayout() = default;
    ShaderLayout(const std::shared_ptr<const Gpu>& gpu, std::span<const ShaderCode> shaders);

    struct Set {
        std::vector<BindingInfo> bindings;  // ascending
        OwnedSetLayout layout;
    };
    const Set& set(uint32_t number) const { return sets_[number]; }
    const VkPushConstantRange& push() const { return push_; }
    VkPipelineLayout get() const { return layout_.get(); }

private:
    std::vector<Set> sets_;
    VkPushConstantRange push_{};
    OwnedPipelineLayout layout_;
};

// Throws kLimit if these are more storage buffers than the device allows a shader stage. `place`: what needs them.
void check_storage_buffers(const Gpu& gpu, std::string_view place, std::span<const BindingInfo> bindings);

// A stage of a pipeline; needed only while the pipeline is made.
class ShaderStage {
public:
    // `constants`: those of constant_id 0, 1, …
    ShaderStage(const std::shared_ptr<const Gpu>& gpu, const ShaderCode& code, std::span<const uint32_t> constants);
    ShaderStage(const ShaderStage&) = delete;

    const VkPipelineShaderStageCreateInfo& info() const { return info_; }

private:
    OwnedShader module_;
    std::vector<VkSpecializationMapEntry> entries_;
    VkSpecializationInfo specialization_{};
    VkPipelineShaderStageCreateInfo info_{};
};

// A descriptor set: the buffers of a table that the shaders use, and images. Movable; must outlive its recorded
// commands.
class Bindings {
public:
    Bindings() = default;
    // `what` names the shaders in messages; `images` are by their bindings. Throws kInvalidArgument if the table has
    // neither one of the buffers nor a stand-in.
    Bindings(const std::shared_ptr<const Gpu>& gpu, std::string_view what, const ShaderLayout::Set& set,
             const BufferTable& buffers, std::span<const VkDescriptorImageInfo> images = {});

    // Adds what Gpu::processor needs to run the kernel.
    void add_native(const BufferTable& buffers);

    VkDescriptorSet set() const { return set_; }
    const std::array<std::byte*, io::kBufferCount>& native() const { return *native_; }

private:
    std::unique_ptr<const std::array<std::byte*, io::kBufferCount>> native_;
    OwnedDescriptorPool pool_;
    std::vector<OwnedBufferView> views_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace throng
