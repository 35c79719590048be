#include "gpu/gpu.h"

#include "base/failure.h"
#include "gpu/pipeline_cache.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <optional>

namespace throng {
namespace {

constexpr uint32_t kApiVersion = VK_API_VERSION_1_3;

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

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

const char* type_name(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return "discrete";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return "integrated";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return "virtual";
        case VK_PHYSICAL_DEVICE_TYPE_CPU: return "cpu";
        default: return "other";
    }
}

// Lower is better.
int preference(const DeviceInfo& info) {
    constexpr std::array order{"discrete", "integrated", "virtual", "other", "cpu"};
    return static_cast<int>(std::find(order.begin(), order.end(), info.type) - order.begin());
}

struct Family {
    uint32_t index = 0;
    VkQueueFlags flags = 0;
    uint32_t timestamp_valid_bits = 0;
};

std::vector<Family> queue_families(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> properties(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, properties.data());
    std::vector<Family> families;
    for (uint32_t i = 0; i < count; ++i)
        families.push_back({i, properties[i].queueFlags, properties[i].timestampValidBits});
    return families;
}

// The first family with compute, and with graphics too where the device has one such.
std::optional<Family> find_family(VkPhysicalDevice physical) {
    std::optional<Family> best;
    for (const Family& family : queue_families(physical)) {
        if (!(family.flags & VK_QUEUE_COMPUTE_BIT)) continue;
        if (family.flags & VK_QUEUE_GRAPHICS_BIT) return family;
        if (!best) best = family;
    }
    return best;
}

DeviceInfo describe(VkPhysicalDevice physical, uint32_t index) {
    VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
    VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES, &v11};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v12};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    const auto& p = properties.properties;
    DeviceInfo info;
    info.index = index;
    info.name = p.deviceName;
    info.type = type_name(p.deviceType);
    info.driver = std::string(v12.driverName) + (v12.driverInfo[0] ? " " : "") + v12.driverInfo;
    info.api_version = p.apiVersion;
    info.subgroup_size = v11.subgroupSize;
    info.shared_memory_bytes = p.limits.maxComputeSharedMemorySize;
    info.storage_buffer_range_bytes = p.limits.maxStorageBufferRange;
    info.usable = p.apiVersion >= kApiVersion && find_family(physical).has_value();
    return info;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
    uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "vkEnumeratePhysicalDevices");
    devices.resize(count);
    return devices;
}

DeviceInfo select_device(const std::vector<DeviceInfo>& infos, const std::string& select) {
    std::string names;
    for (const auto& info : infos)
        names += (names.empty() ? "" : ", ") + std::to_string(info.index) + " (" + info.name + ")";
    const auto refuse = [&](const std::string& why) -> Failure {
        return Failure(ErrorCode::kNoDevice, "device '" + select + "'",
                       why + "; the devices are: " + (names.empty() ? "none" : names));
    };

    std::vector<DeviceInfo> candidates;
    uint32_t index = 0;
    const auto [end, parse] = std::from_chars(select.data(), select.data() + select.size(), index);
    const bool is_index = parse == std::errc{} && end == select.data() + select.size();
    for (const auto& info : infos) {
        const bool fits = select.empty()    ? true
                          : is_index        ? info.index == index
                          : select == "cpu" ? info.type == "cpu"
                                            : lower(info.name).find(lower(select)) != std::string::npos;
        if (fits) candidates.push_back(info);
    }
    if (candidates.empty()) throw refuse(infos.empty() ? "no Vulkan driver is installed" : "no such device");
    std::erase_if(candidates, [](const DeviceInfo& info) { return !info.usable; });
    if (candidates.empty()) throw refuse("Vulkan 1.3 and a compute queue are needed");
    return *std::min_element(candidates.begin(), candidates.end(),
                             [](const auto& a, const auto& b) { return preference(a) < preference(b); });
}

VKAPI_ATTR VkBool32 VKAPI_CALL on_validation_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                     VkDebugUtilsMessageTypeFlagsEXT,
                                                     const VkDebugUtilsMessengerCallbackDataEXT* data, void* counter) {
    static_cast<std::atomic<uint32_t>*>(counter)->fetch_add(1);
    std::fprintf(stderr, "validation: %s\n", data->pMessage);
    return VK_FALSE;
}

// A bare instance that only lives while devices are listed.
struct ListingInstance {
    VkInstance handle = VK_NULL_HANDLE;
    ListingInstance() {
        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
        application.apiVersion = kApiVersion;
        VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
        create.pApplicationInfo = &application;
        check(vkCreateInstance(&create, nullptr, &handle), "vkCreateInstance");
        volkLoadInstanceOnly(handle);
    }
    ~ListingInstance() { vkDestroyInstance(handle, nullptr); }
};

}  // namespace

Gpu::Gpu(size_t kept_kernels) : kernels(kept_kernels) {}

std::vector<DeviceInfo> Gpu::list() {
    const std::lock_guard lock(instance_level_mutex());
    load_vulkan();
    const ListingInstance instance;
    std::vector<DeviceInfo> infos;
    for (VkPhysicalDevice physical : physical_devices(instance.handle))
        infos.push_back(describe(physical, static_cast<uint32_t>(infos.size())));
    return infos;
}

std::shared_ptr<Gpu> Gpu::create(const DeviceSettings& settings) {
    // Before the lock: where something below throws, its destructor takes the lock
    std::shared_ptr<Gpu> gpu(new Gpu(SharedKernels::kKept));
    const std::lock_guard lock(instance_level_mutex());
    load_vulkan();
    gpu->create_instance(settings.validation);
    gpu->create_device(settings);
    return gpu;
}

std::shared_ptr<Gpu> Gpu::adopt(const AdoptedDevice& adopted) {
    if (!adopted.instance || !adopted.physical_device || !adopted.device || !adopted.queue)
        throw Failure(ErrorCode::kInvalidArgument, "adopted device",
                      "instance, physical device, device and queue are all needed");
    // Before the lock, as in create(). Nothing of it may outlive the crowds: the application's device may not.
    std::shared_ptr<Gpu> gpu(new Gpu(0));
    const std::lock_guard lock(instance_level_mutex());
    load_vulkan();
    volkLoadInstanceOnly(adopted.instance);
    gpu->info = describe(adopted.physical_device, 0);
    if (!gpu->info.usable)
        throw Failure(ErrorCode::kNoDevice, "adopted device " + gpu->info.name,
                      "Vulkan 1.3 and a compute queue are needed");
    gpu->device = adopted.device;
    gpu->queue = adopted.queue;
    gpu->queue_family = adopted.queue_family;
    gpu->has_int64 = adopted.shader_int64;
    gpu->read_properties(adopted.physical_device);
    if (!(gpu->queue_flags & VK_QUEUE_COMPUTE_BIT))
        throw Failure(ErrorCode::kInvalidArgument, "adopted device",
                      "queue family " + std::to_string(adopted.queue_family) + " has no compute");
    volkLoadDeviceTable(&gpu->vk, gpu->device);
    gpu->adopted_cache_ = adopted.pipeline_cache;
    return gpu;
}

void Gpu::create_instance(Validation validation) {
    constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.pApplicationName = "throng";
    application.apiVersion = kApiVersion;
    VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    create.pApplicationInfo = &application;

    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = on_validation_message;
    messenger.pUserData = &validation_messages_;

    const VkValidationFeatureEnableEXT feature = validation == Validation::kSynchronization
                                                     ? VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
                                                     : VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT;
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &feature;
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    if (validation != Validation::kOff) {
        create.enabledLayerCount = 1;
        create.ppEnabledLayerNames = &kLayer;
        create.enabledExtensionCount = 1;
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

void Gpu::create_device(const DeviceSettings& settings) {
    const std::vector<VkPhysicalDevice> devices = physical_devices(instance_);
    std::vector<DeviceInfo> infos;
    for (VkPhysicalDevice physical : devices) infos.push_back(describe(physical, static_cast<uint32_t>(infos.size())));
    info = select_device(infos, settings.select);
    VkPhysicalDevice physical = devices[info.index];
    queue_family = find_family(physical)->index;
    read_properties(physical);

    const float priority = 1;
    VkDeviceQueueCreateInfo queue_create{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue_create.queueFamilyIndex = queue_family;
    queue_create.queueCount = 1;
    queue_create.pQueuePriorities = &priority;
    VkPhysicalDeviceVulkan13Features features13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    features13.synchronization2 = VK_TRUE;
    features13.dynamicRendering = VK_TRUE;
    features13.maintenance4 = VK_TRUE;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features13};
    VkPhysicalDeviceVulkan13Features available13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 available2{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &available13};
    vkGetPhysicalDeviceFeatures2(physical, &available2);
    const VkPhysicalDeviceFeatures& available = available2.features;
    features.features.shaderInt64 = available.shaderInt64;
    has_int64 = available.shaderInt64 == VK_TRUE;
    features13.computeFullSubgroups = available13.computeFullSubgroups;
    has_full_subgroups = available13.computeFullSubgroups == VK_TRUE;
    if (settings.validation == Validation::kGpuAssisted) {  // what the layer's own instrumentation needs
        features.features.fragmentStoresAndAtomics = available.fragmentStoresAndAtomics;
        features.features.vertexPipelineStoresAndAtomics = available.vertexPipelineStoresAndAtomics;
    }
    VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue_create;
    check(vkCreateDevice(physical, &create, nullptr, &device), "vkCreateDevice");
    owns_device_ = true;
    volkLoadDeviceTable(&vk, device);
    vk.vkGetDeviceQueue(device, queue_family, 0, &queue);
    if (!settings.pipeline_cache) return;
    if (const std::filesystem::path file = pipeline_cache_file(properties); !file.empty())
        own_cache_ = std::make_unique<PipelineCache>(*this, file);
}

void Gpu::read_properties(VkPhysicalDevice physical) {
    physical_device = physical;
    VkPhysicalDeviceVulkan13Properties properties13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceSubgroupProperties subgroup{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, &properties13};
    VkPhysicalDeviceMaintenance3Properties maintenance3{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES,
                                                        &subgroup};
    VkPhysicalDeviceProperties2 properties2{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &maintenance3};
    vkGetPhysicalDeviceProperties2(physical, &properties2);
    properties = properties2.properties;
    max_allocation_bytes = maintenance3.maxMemoryAllocationSize;
    smallest_subgroup = std::max(1u, std::min(properties13.minSubgroupSize, subgroup.subgroupSize));
    largest_subgroup = std::max(properties13.maxSubgroupSize, subgroup.subgroupSize);
    has_shuffle = (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) &&
                  (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_SHUFFLE_BIT);
    vkGetPhysicalDeviceMemoryProperties(physical, &memory_properties);
    const std::vector<Family> families = queue_families(physical);
    if (queue_family >= families.size())
        throw Failure(ErrorCode::kInvalidArgument, "queue family " + std::to_string(queue_family),
                      "the device has " + std::to_string(families.size()));
    queue_flags = families[queue_family].flags;
    timestamp_valid_bits = families[queue_family].timestamp_valid_bits;
}

Gpu::~Gpu() {
    kernels.clear();
    own_cache_.reset();
    const std::lock_guard lock(instance_level_mutex());
    if (owns_device_) {
        vk.vkDeviceWaitIdle(device);
        vk.vkDestroyDevice(device, nullptr);
    }
    if (messenger_) destroy_messenger_(instance_, messenger_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Gpu::submit_and_wait(const std::function<void(VkCommandBuffer)>& body) const {
    // A pool and a fence of its own: rare calls, and nothing to share between threads.
    struct OneShot {
        const Gpu& gpu;
        VkCommandPool pool = VK_NULL_HANDLE;
        VkFence fence = VK_NULL_HANDLE;
        ~OneShot() {
            gpu.vk.vkDestroyFence(gpu.device, fence, nullptr);
            gpu.vk.vkDestroyCommandPool(gpu.device, pool, nullptr);
        }
    } shot{*this};
    VkCommandPoolCreateInfo pool_create{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_create.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool_create.queueFamilyIndex = queue_family;
    check(vk.vkCreateCommandPool(device, &pool_create, nullptr, &shot.pool), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = shot.pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check(vk.vkAllocateCommandBuffers(device, &allocate, &commands), "vkAllocateCommandBuffers");
    VkFenceCreateInfo fence_create{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vk.vkCreateFence(device, &fence_create, nullptr, &shot.fence), "vkCreateFence");

    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vk.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    body(commands);
    check(vk.vkEndCommandBuffer(commands), "vkEndCommandBuffer");

    VkCommandBufferSubmitInfo command_submit{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    command_submit.commandBuffer = commands;
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &command_submit;
    check(vk.vkQueueSubmit2(queue, 1, &submit, shot.fence), "vkQueueSubmit2");
    ++counts.submissions;
    // No timeout: a frame of a software device may take minutes, and a driver reports a device that hangs as lost.
    check(vk.vkWaitForFences(device, 1, &shot.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
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
    VkPipelineCreationFeedbackCreateInfo feedback{VK_STRUCTURE_TYPE_PIPELINE_CREATION_FEEDBACK_CREATE_INFO,
                                                  create.pNext};
    feedback.pPipelineCreationFeedback = &whole;
    feedback.pipelineStageCreationFeedbackCount = stage_count;
    feedback.pPipelineStageCreationFeedbacks = stages.data();
    create.pNext = &feedback;
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
    VkDebugUtilsObjectNameInfoEXT name_info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    name_info.objectType = type;
    name_info.objectHandle = handle;
    name_info.pObjectName = text.c_str();
    check(set_name_(device, &name_info), "vkSetDebugUtilsObjectNameEXT");
}

uint32_t Gpu::memory_type(uint32_t type_bits, VkMemoryPropertyFlags required, VkMemoryPropertyFlags preferred) const {
    for (const VkMemoryPropertyFlags wanted : {required | preferred, required})
        for (uint32_t i = 0; i < memory_properties.memoryTypeCount; ++i)
            if ((type_bits & (1u << i)) && (memory_properties.memoryTypes[i].propertyFlags & wanted) == wanted)
                return i;
    throw Failure(ErrorCode::kVulkan, {}, "the device has no memory type that fits a buffer of throng");
}

uint64_t Gpu::largest_heap_bytes() const {
    uint64_t largest_bytes = 0;
    for (uint32_t heap = 0; heap < memory_properties.memoryHeapCount; ++heap)
        largest_bytes = std::max<uint64_t>(largest_bytes, memory_properties.memoryHeaps[heap].size);
    return largest_bytes;
}

Result<std::vector<DeviceInfo>> Device::list() {
    return as_result([] { return Gpu::list(); });
}

Result<Device> Device::create(const DeviceSettings& settings) {
    return as_result([&] { return Device(Gpu::create(settings)); });
}

Result<Device> Device::adopt(const AdoptedDevice& adopted) {
    return as_result([&] { return Device(Gpu::adopt(adopted)); });
}

Device::Device(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

const std::shared_ptr<Gpu>& Device::gpu() const {
    if (!gpu_) throw Failure(ErrorCode::kInvalidArgument, "device", "it has been moved from");
    return gpu_;
}

const DeviceInfo& Device::info() const {
    static const DeviceInfo none;
    return gpu_ ? gpu_->info : none;
}

uint32_t Device::validation_message_count() const { return gpu_ ? gpu_->validation_message_count() : 0; }

}  // namespace throng
