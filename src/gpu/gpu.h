// The device as throng's own code sees it: handles, limits, its function table, and one-shot submission.
#pragma once

#include "gpu/memory.h"
#include "gpu/native.h"
#include "gpu/shared_kernels.h"
#include "gpu/shared_values.h"
#include "gpu/submissions.h"
#include "gpu/vulkan.h"

#include <throng/device.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string_view>

namespace throng {

class PipelineCache;
class SharedBuffers;

// How often the driver was asked for something, for tests and measurements.
struct GpuCounts {
    std::atomic<uint64_t> allocations{0};       // of memory for buffers
    std::atomic<uint64_t> submissions{0};       // that throng waits for
    std::atomic<uint64_t> pipelines{0};         // made, of any kind
    std::atomic<uint64_t> cached_pipelines{0};  // of these, found in the pipeline cache, as the driver says
};

// A pipeline of a device that only compiles.
struct MadePipeline {
    std::string_view name;
    uint32_t workgroup_size = 0;  // 0: a graphics pipeline
    VkPipeline pipeline = VK_NULL_HANDLE;
};

class Gpu {
public:
    static std::vector<DeviceInfo> list();
    static std::shared_ptr<Gpu> create(const DeviceSettings& settings);
    static std::shared_ptr<Gpu> adopt(const AdoptedDevice& adopted);
    // The first device that compiles only (DeviceInfo::compiles_only); null where there is none. Its buffers lie in
    // host memory, and nothing is bound or submitted. The driver can report machine code and statistics of each
    // pipeline.
    static std::shared_ptr<Gpu> create_compiler();
    ~Gpu();
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    // A pointer that does not keep the device alive, for objects that the device itself keeps.
    std::shared_ptr<const Gpu> unowned() const { return {std::shared_ptr<const Gpu>(), this}; }

    // Whether it is a device without Vulkan, which has none of the handles.
    bool is_native() const { return is_native_; }
    // Whether pipelines can be made, but nothing can run.
    bool compiles_only() const { return info.compiles_only; }

    // Records `body` into a fresh command buffer, submits it to the queue and waits for it. On a native device the
    // command buffer is null.
    void submit_and_wait(const std::function<void(VkCommandBuffer)>& body) const;

    // Waits until the queue has done all that was submitted to it.
    void wait_idle() const;

    // Uses the device's pipeline cache, if it has one.
    VkPipeline make_pipeline(const VkComputePipelineCreateInfo& create) const;
    VkPipeline make_pipeline(const VkGraphicsPipelineCreateInfo& create) const;

    // Names an object for messages of the validation layer; does nothing where the layer is off.
    template <class Handle>
    void name(VkObjectType type, Handle handle, std::string_view what) const {
        if (set_name_) set_name(type, reinterpret_cast<uint64_t>(handle), what);
    }

    // Calls allocate_from() with a memory type among `type_bits` that has all `required` properties, and also the
    // `preferred` ones if there is such a type. If its heap has no memory left, tries a type of the next heap: memory
    // that is slower for the GPU is better than none.
    void allocate(uint32_t type_bits, VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred,
                  const std::function<void(uint32_t memory_type)>& allocate_from) const;

    bool is_cpu() const { return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
    bool has_graphics() const { return (queue_flags & VK_QUEUE_GRAPHICS_BIT) != 0; }
    // Whether the device gets the kernels' GPU_SOFTWARE variants (gpu/stored.glsl, gpu/table.glsl).
    bool uses_software_kernels() const { return is_cpu() && has_int64; }
    uint64_t largest_heap_bytes() const;
    bool has_timestamps() const { return timestamp_valid_bits != 0 && properties.limits.timestampPeriod > 0; }

    // On native and software devices, where buffers lie in host memory: runs kernels on this machine's processor, at
    // once, if the command buffer that they are recorded into is null. The queue must then be idle (wait_idle()).
    std::unique_ptr<NativeDevice> processor;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
    std::vector<uint32_t> sharing_families;  // all that use the buffers, queue_family included; empty: it alone
    VkQueueFlags queue_flags = 0;
    uint32_t timestamp_valid_bits = 0;
    VolkDeviceTable vk{};
    DeviceInfo info;
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory_properties{};
    uint64_t max_allocation_bytes = 0;
    uint32_t smallest_subgroup = 1;  // of those that the driver may choose
    uint32_t largest_subgroup = 1;
    uint32_t simd_count = 0;   // processors that run one subgroup at a time; 0: the driver does not say
    bool has_shuffle = false;  // subgroup shuffles in compute shaders
    bool has_int64 = false;    // 64-bit integers, enabled
    // A compute pipeline can request a subgroup size, from the smallest to the largest; enabled
    bool can_choose_subgroup = false;
    bool has_full_subgroups = false;  // a pipeline can ask for subgroups without idle invocations; enabled
    uint32_t validation_message_count() const { return validation_messages_; }
    VkPipelineCache pipeline_cache() const;

    // On a device that compiles only: the subgroup size to compile kernels for; 0: what the driver chooses.
    uint32_t compiled_subgroup_size = 0;
    // On such a device: called for each kernel, even one that shares its pipeline with another, and for each graphics
    // pipeline.
    std::function<void(const MadePipeline&)> on_pipeline;

    MemoryBlocks memory;
    SharedKernels kernels;
    const std::unique_ptr<SharedBuffers> buffers;
    SharedValues values;
    mutable GpuCounts counts;

private:
    // On an application's device, nothing that no crowd uses is kept: the application may destroy the device before
    // this object.
    explicit Gpu(bool owns_device);
    bool computes_in_host_memory() const;
    void make_native(const DeviceSettings& settings, const DeviceInfo& of);
    void create_instance(Validation validation);
    void create_device(const DeviceSettings& settings, VkPhysicalDevice physical, const DeviceInfo& of);
    void read_properties(VkPhysicalDevice physical);
    void share_with(const std::vector<uint32_t>& more_families);
    void set_name(VkObjectType type, uint64_t handle, std::string_view what) const;
    template <class Info, class Create>
    VkPipeline make_pipeline(Info create, uint32_t stage_count, Create function, const char* call) const;

    const bool owns_device_;
    bool is_native_ = false;
    VkInstance instance_ = VK_NULL_HANDLE;  // null where adopted
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    // Null in instances without the extension: volk's pointers may be another instance's
    PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger_ = nullptr;
    PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
    std::unique_ptr<PipelineCache> own_cache_;
    VkPipelineCache adopted_cache_ = VK_NULL_HANDLE;
    std::atomic<uint32_t> validation_messages_{0};
    mutable Submissions submissions_;
};

}  // namespace throng
