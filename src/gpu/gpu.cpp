#include "gpu/gpu.h"

#include "base/enumeration.h"
#include "base/failure.h"
#include "gpu/device_list.h"
#include "gpu/pipeline_cache.h"
#include "gpu/shared_buffers.h"

#include <algorithm>
#include <cstdio>
#include <set>

namespace throng {
namespace {

// Instance-level entry points of volk are process-wide; every use of them holds this lock.
std::mutex& instance_level_mutex() {
    static std::mutex mutex;
    return mutex;
}

void load_vulkan() {
    static const VkResult result = volkInitialize();
    if (result != VK_SUCCESS)
        throw Failure(ErrorCode::kNoDevice, {},
                      "no Vulkan loader (libvulkan.so.1): install libvulkan1 and a driver such as mesa-vulkan-drivers");
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_validation_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                     VkDebugUtilsMessageTypeFlagsEXT,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* counter) {
    static_cast<std::atomic<uint32_t>*>(counter)->fetch_add(1);
    std::fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

void check_threads(const char* place, uint32_t threads) {
    if (threads > NativeDevice::kMaxThreads)
        throw Failure(ErrorCode::kLimit, place, threads, " threads exceed the limit of ", NativeDevice::kMaxThreads);
}

bool has_extension(VkPhysicalDevice physical, std::string_view name) {
    uint32_t count = 0;
    check(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr),
          "vkEnumerateDeviceExtensionProperties");
    std::vector<VkExtensionProperties> extensions(count);
    check(vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data()),
          "vkEnumerateDeviceExtensionProperties");
    return std::ranges::any_of(extensions, [&](const auto& extension) { return extension.extensionName == name; });
}

// 0 if the vendor has no extension that reports it.
uint32_t count_simds(VkPhysicalDevice physical) {
    VkPhysicalDeviceShaderSMBuiltinsPropertiesNV nvidia{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_SM_BUILTINS_PROPERTIES_NV};
    VkPhysicalDeviceShaderCorePropertiesAMD amd{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_CORE_PROPERTIES_AMD};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    if (has_extension(physical, VK_NV_SHADER_SM_BUILTINS_EXTENSION_NAME)) {
        properties.pNext = &nvidia;
        vkGetPhysicalDeviceProperties2(physical, &properties);
        constexpr uint32_t kSimds = 4;  // of a multiprocessor, since Maxwell
        return kSimds * nvidia.shaderSMCount;
    }
    if (has_extension(physical, VK_AMD_SHADER_CORE_PROPERTIES_EXTENSION_NAME)) {
        properties.pNext = &amd;
        vkGetPhysicalDeviceProperties2(physical, &properties);
        return amd.shaderEngineCount * amd.shaderArraysPerEngineCount * amd.computeUnitsPerShaderArray *
               amd.simdPerComputeUnit;
    }
    return 0;
}

}  // namespace

Gpu::Gpu(bool owns_device)
    : memory(*this, owns_device),
      kernels(owns_device ? SharedKernels::kKept : 0),
      buffers(std::make_unique<SharedBuffers>()),
      owns_device_(owns_device),
      submissions_(*this, owns_device) {}

std::vector<DeviceInfo> Gpu::list() {
    // Made before the lock is taken: if something below throws, ~Gpu() runs and takes the lock too
    const std::shared_ptr<Gpu> gpu(new Gpu(true));
    const std::lock_guard lock(instance_level_mutex());
    try {
        load_vulkan();
        gpu->create_instance(Validation::kOff);
    } catch (const Failure& failure) {
        if (failure.error.code != ErrorCode::kNoDevice) throw;
        return describe_all({});
    }
    return describe_all(physical_devices(gpu->instance_));
}

std::shared_ptr<Gpu> Gpu::create(const DeviceSettings& settings) {
    check_threads("device", settings.threads);
    check_known(settings.validation, Validation::kGpuAssisted, "device: validation");
    std::shared_ptr<Gpu> gpu(new Gpu(true));  // before the lock, as in list()
    if (is_native_name(settings.select)) {    // does not load Vulkan
        gpu->make_native(settings, NativeDevice::info(0));
        return gpu;
    }
    const std::lock_guard lock(instance_level_mutex());
    try {
        load_vulkan();
        gpu->create_instance(settings.validation);
    } catch (const Failure& failure) {
        const DeviceInfo native = describe_all({}).front();
        if (failure.error.code != ErrorCode::kNoDevice || settings.validation != Validation::kOff ||
            !is_selected(native, settings.select))
            throw;
        gpu->make_native(settings, native);
        return gpu;
    }
    const std::vector<VkPhysicalDevice> devices = physical_devices(gpu->instance_);
    const DeviceInfo selected = select_device(describe_all(devices), settings.select);
    if (selected.type == kNativeType)
        gpu->make_native(settings, selected);
    else
        gpu->create_device(settings, devices[selected.index], selected);
    return gpu;
}

std::shared_ptr<Gpu> Gpu::create_compiler() {
    std::shared_ptr<Gpu> gpu(new Gpu(true));  // before the lock, as in list()
    const std::lock_guard lock(instance_level_mutex());
    load_vulkan();
    gpu->create_instance(Validation::kOff);
    const std::vector<VkPhysicalDevice> devices = physical_devices(gpu->instance_);
    const std::vector<DeviceInfo> infos = describe_all(devices);
    const auto found = std::ranges::find_if(infos, &DeviceInfo::compiles_only);
    if (found == infos.end()) return nullptr;
    gpu->create_device({.pipeline_cache = false}, devices[found->index], *found);
    gpu->memory_properties.memoryHeapCount = 1;
    gpu->memory_properties.memoryHeaps[0].size = NativeDevice::memory_bytes();
    return gpu;
}

// Whether kernels may run natively: only on software devices, and only if the CPU can map all of their memory.
bool Gpu::computes_in_host_memory() const {
    constexpr VkMemoryPropertyFlags kHost = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const auto types = std::span(memory_properties.memoryTypes).first(memory_properties.memoryTypeCount);
    return is_cpu() &&
           std::ranges::all_of(types, [](const VkMemoryType& type) { return (type.propertyFlags & kHost) == kHost; });
}

void Gpu::wait_idle() const { check(vk.vkQueueWaitIdle(queue), "vkQueueWaitIdle"); }

void Gpu::make_native(const DeviceSettings& settings, const DeviceInfo& of) {
    processor = std::make_unique<NativeDevice>(settings);
    is_native_ = true;
    info = of;
    properties = NativeDevice::properties();
    max_allocation_bytes = NativeDevice::memory_bytes();
    memory_properties.memoryHeapCount = 1;
    memory_properties.memoryHeaps[0].size = max_allocation_bytes;
    timestamp_valid_bits = 64;
}

std::shared_ptr<Gpu> Gpu::adopt(const AdoptedDevice& adopted) {
    if (!adopted.instance || !adopted.physical_device || !adopted.device || !adopted.queue)
        throw Failure(ErrorCode::kInvalidArgument, "adopted device",
                      "instance, physical_device, device and queue must all be set");
    check_threads("adopted device", adopted.threads);
    std::shared_ptr<Gpu> gpu(new Gpu(false));  // before the lock, as in list()
    const std::lock_guard lock(instance_level_mutex());
    load_vulkan();
    volkLoadInstanceOnly(adopted.instance);
    gpu->info = describe(adopted.physical_device, 0);
    if (const std::string reason = unusable_reason(gpu->info); !reason.empty())
        throw Failure(ErrorCode::kNoDevice, "adopted device " + gpu->info.name, reason);
    gpu->device = adopted.device;
    gpu->queue = adopted.queue;
    gpu->queue_family = adopted.queue_family;
    gpu->has_int64 = adopted.shader_int64;
    gpu->read_properties(adopted.physical_device);
    gpu->can_choose_subgroup = gpu->can_choose_subgroup && adopted.subgroup_size_control;
    gpu->has_full_subgroups = adopted.compute_full_subgroups;
    if (!(gpu->queue_flags & VK_QUEUE_COMPUTE_BIT))
        throw Failure(ErrorCode::kInvalidArgument, "adopted device",
                      "queue family " + std::to_string(adopted.queue_family) + " does not support compute");
    gpu->share_with(adopted.more_queue_families);
    volkLoadDeviceTable(&gpu->vk, gpu->device);
    // Drivers provide no functions, and fill no structures, of a Vulkan version that the instance has not requested.
    if (gpu->max_allocation_bytes == 0 || !gpu->vk.vkCmdPipelineBarrier2 ||
        !gpu->vk.vkGetDeviceBufferMemoryRequirements)
        throw Failure(ErrorCode::kInvalidArgument, "adopted device",
                      "its instance was created for a Vulkan version below 1.3: set VkApplicationInfo::apiVersion to "
                      "VK_API_VERSION_1_3");
    gpu->adopted_cache_ = adopted.pipeline_cache;
    if (gpu->computes_in_host_memory())
        gpu->processor = std::make_unique<NativeDevice>(
            DeviceSettings{.threads = adopted.threads, .jobs = adopted.jobs});
    return gpu;
}

void Gpu::create_instance(Validation validation) {
    constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
    const VkApplicationInfo application{
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "throng", .apiVersion = kApiVersion};
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_validation_message,
        .pUserData = &validation_messages_};
    const VkValidationFeatureEnableEXT feature = validation == Validation::kSynchronization
                                                     ? VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
                                                     : VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT;
    const VkValidationFeaturesEXT features{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                           .pNext = &messenger,
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = &feature};
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    if (validation != Validation::kOff) {
        create.enabledLayerCount = create.enabledExtensionCount = 1;
        create.ppEnabledLayerNames = &kLayer;
        create.ppEnabledExtensionNames = &extension;
        create.pNext = validation == Validation::kStandard ? static_cast<const void*>(&messenger) : &features;
    }
    const VkResult result = vkCreateInstance(&create, nullptr, &instance_);
    if (result == VK_ERROR_LAYER_NOT_PRESENT)
        throw Failure(ErrorCode::kNoDevice, {}, "the validation layer is not installed (vulkan-validationlayers)");
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        throw Failure(ErrorCode::kNoDevice, {},
                      "no Vulkan driver is installed (mesa-vulkan-drivers has a software one)");
    check(result, "vkCreateInstance");
    volkLoadInstanceOnly(instance_);
    if (validation == Validation::kOff) return;
    check(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
          "vkCreateDebugUtilsMessengerEXT");
    destroy_messenger_ = vkDestroyDebugUtilsMessengerEXT;
    set_name_ = vkSetDebugUtilsObjectNameEXT;
}

void Gpu::create_device(const DeviceSettings& settings, VkPhysicalDevice physical, const DeviceInfo& of) {
    info = of;
    queue_family = *find_family(physical);
    read_properties(physical);

    VkPhysicalDeviceVulkan13Features available13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 available{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &available13};
    vkGetPhysicalDeviceFeatures2(physical, &available);
    has_int64 = available.features.shaderInt64 == VK_TRUE;
    has_full_subgroups = available13.computeFullSubgroups == VK_TRUE;
    can_choose_subgroup = can_choose_subgroup && available13.subgroupSizeControl == VK_TRUE;
    // VK_TRUE: features that throng requires. The others are optional: enabled if the device has them.
    VkPhysicalDeviceVulkan13Features features13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                .subgroupSizeControl = available13.subgroupSizeControl,
                                                .computeFullSubgroups = available13.computeFullSubgroups,
                                                .synchronization2 = VK_TRUE,
                                                .dynamicRendering = VK_TRUE,
                                                .maintenance4 = VK_TRUE};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &features13,
                                       .features = {.shaderInt64 = available.features.shaderInt64}};
    if (settings.validation == Validation::kGpuAssisted) {  // what the layer's own instrumentation needs
        features.features.fragmentStoresAndAtomics = available.features.fragmentStoresAndAtomics;
        features.features.vertexPipelineStoresAndAtomics = available.features.vertexPipelineStoresAndAtomics;
    }
    VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
        .pipelineExecutableInfo = VK_TRUE};
    constexpr const char* kExecutables = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
    if (compiles_only()) {
        features13.subgroupSizeControl = VK_TRUE;
        features13.pNext = &executables;
    }
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue_create{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                               .queueFamilyIndex = queue_family,
                                               .queueCount = 1,
                                               .pQueuePriorities = &priority};
    const VkDeviceCreateInfo create{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                    .pNext = &features,
                                    .queueCreateInfoCount = 1,
                                    .pQueueCreateInfos = &queue_create,
                                    .enabledExtensionCount = compiles_only() ? 1u : 0u,
                                    .ppEnabledExtensionNames = &kExecutables};
    check(vkCreateDevice(physical, &create, nullptr, &device), "vkCreateDevice");
    volkLoadDeviceTable(&vk, device);
    if (computes_in_host_memory()) processor = std::make_unique<NativeDevice>(settings);
    vk.vkGetDeviceQueue(device, queue_family, 0, &queue);
    if (!settings.pipeline_cache) return;
    if (const std::filesystem::path file = pipeline_cache_file(properties); !file.empty())
        own_cache_ = std::make_unique<PipelineCache>(*this, file);
}

void Gpu::read_properties(VkPhysicalDevice physical) {
    physical_device = physical;
    VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceVulkan11Properties v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
                                           .pNext = &v13};
    VkPhysicalDeviceProperties2 properties2{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &v11};
    vkGetPhysicalDeviceProperties2(physical, &properties2);
    properties = properties2.properties;
    max_allocation_bytes = v11.maxMemoryAllocationSize;
    smallest_subgroup = std::max(1u, std::min(v13.minSubgroupSize, v11.subgroupSize));
    largest_subgroup = std::max(v13.maxSubgroupSize, v11.subgroupSize);
    can_choose_subgroup = (v13.requiredSubgroupSizeStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
    has_shuffle = (v11.subgroupSupportedStages & VK_SHADER_STAGE_COMPUTE_BIT) &&
                  (v11.subgroupSupportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT);
    simd_count = count_simds(physical);
    vkGetPhysicalDeviceMemoryProperties(physical, &memory_properties);
    const std::vector<VkQueueFamilyProperties> families = queue_families(physical);
    if (queue_family >= families.size())
        throw Failure(ErrorCode::kInvalidArgument, "queue family " + std::to_string(queue_family),
                      "the device's number of queue families is " + std::to_string(families.size()));
    queue_flags = families[queue_family].queueFlags;
    timestamp_valid_bits = families[queue_family].timestampValidBits;
}

// Timestamps may be written on any of the families with compute, so only the bits that are valid on all of them count.
void Gpu::share_with(const std::vector<uint32_t>& more_families) {
    const std::vector<VkQueueFamilyProperties> families = queue_families(physical_device);
    std::set<uint32_t> all{queue_family};
    for (const uint32_t family : more_families) {
        if (family >= families.size())
            throw Failure(ErrorCode::kInvalidArgument, "queue family " + std::to_string(family),
                          "the device's number of queue families is " + std::to_string(families.size()));
        all.insert(family);
        if (families[family].queueFlags & VK_QUEUE_COMPUTE_BIT)
            timestamp_valid_bits = std::min(timestamp_valid_bits, families[family].timestampValidBits);
    }
    if (all.size() > 1) sharing_families.assign(all.begin(), all.end());
}

Gpu::~Gpu() {
    kernels.clear();
    memory.clear();
    submissions_.clear();
    own_cache_.reset();
    if (!instance_ && !device) return;  // a native device: Vulkan may not be installed
    const std::lock_guard lock(instance_level_mutex());
    if (owns_device_ && device) {
        if (!compiles_only()) vk.vkDeviceWaitIdle(device);
        vk.vkDestroyDevice(device, nullptr);
    }
    if (messenger_) destroy_messenger_(instance_, messenger_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Gpu::submit_and_wait(const std::function<void(VkCommandBuffer)>& body) const {
    if (is_native()) return body(VK_NULL_HANDLE);
    if (!compiles_only()) submissions_.run(body);
}

VkPipelineCache Gpu::pipeline_cache() const { return own_cache_ ? own_cache_->handle() : adopted_cache_; }

VkPipeline Gpu::make_pipeline(const VkComputePipelineCreateInfo& create) const {
    return make_pipeline(create, 1, vk.vkCreateComputePipelines, "vkCreateComputePipelines");
}

VkPipeline Gpu::make_pipeline(const VkGraphicsPipelineCreateInfo& create) const {
    return make_pipeline(create, create.stageCount, vk.vkCreateGraphicsPipelines, "vkCreateGraphicsPipelines");
}

template <class Info, class Create>
VkPipeline Gpu::make_pipeline(Info create, uint32_t stage_count, Create function, const char* call) const {
    VkPipelineCreationFeedback whole{};
    std::vector<VkPipelineCreationFeedback> stages(stage_count);
    const VkPipelineCreationFeedbackCreateInfo feedback{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_CREATION_FEEDBACK_CREATE_INFO,
        .pNext = create.pNext,
        .pPipelineCreationFeedback = &whole,
        .pipelineStageCreationFeedbackCount = stage_count,
        .pPipelineStageCreationFeedbacks = stages.data()};
    create.pNext = &feedback;
    if (compiles_only())
        create.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR |
                        VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR;
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(function(device, pipeline_cache(), 1, &create, nullptr, &pipeline), call);
    ++counts.pipelines;
    constexpr VkPipelineCreationFeedbackFlags kHit = VK_PIPELINE_CREATION_FEEDBACK_VALID_BIT |
                                                     VK_PIPELINE_CREATION_FEEDBACK_APPLICATION_PIPELINE_CACHE_HIT_BIT;
    if ((whole.flags & kHit) == kHit) ++counts.cached_pipelines;
    return pipeline;
}

void Gpu::set_name(VkObjectType type, uint64_t handle, std::string_view what) const {
    const std::string text(what);
    const VkDebugUtilsObjectNameInfoEXT name_info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                                  .objectType = type,
                                                  .objectHandle = handle,
                                                  .pObjectName = text.c_str()};
    check(set_name_(device, &name_info), "vkSetDebugUtilsObjectNameEXT");
}

void Gpu::allocate(uint32_t type_bits, VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred,
                   const std::function<void(uint32_t memory_type)>& allocate_from) const {
    const auto types = std::span(memory_properties.memoryTypes).first(memory_properties.memoryTypeCount);
    std::vector<uint32_t> fitting;  // the first one that is preferred, then the first one of each other heap
    for (const VkMemoryPropertyFlags wanted : {required | preferred, required})
        for (uint32_t i = 0; i < types.size(); ++i) {
            const bool is_of_known_heap = std::ranges::any_of(
                fitting, [&](uint32_t other) { return types[other].heapIndex == types[i].heapIndex; });
            if ((type_bits & (1u << i)) && (types[i].propertyFlags & wanted) == wanted && !is_of_known_heap)
                fitting.push_back(i);
        }
    if (fitting.empty())
        throw Failure(ErrorCode::kVulkan, {}, "the device has no memory type with the properties that throng needs");
    for (size_t i = 0;; ++i) {
        try {
            return allocate_from(fitting[i]);
        } catch (const Failure& failure) {
            if (failure.error.code != ErrorCode::kOutOfMemory || i + 1 == fitting.size()) throw;
        }
    }
}

uint64_t Gpu::largest_heap_bytes() const {
    uint64_t largest_bytes = 0;
    for (uint32_t heap = 0; heap < memory_properties.memoryHeapCount; ++heap)
        largest_bytes = std::max<uint64_t>(largest_bytes, memory_properties.memoryHeaps[heap].size);
    return largest_bytes;
}

}  // namespace throng
