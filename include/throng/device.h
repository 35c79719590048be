// The Vulkan device that throng works on: one of its own, or the application's.
#pragma once

#include <throng/jobs.h>
#include <throng/result.h>

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace throng {

struct DeviceInfo {
    uint32_t index = 0;  // as DeviceSettings::select takes it
    std::string name{};
    std::string type{};        // "discrete", "integrated", "virtual", "cpu", "native" or "other"
    std::string driver{};      // name and version
    uint32_t api_version = 0;  // VK_MAKE_API_VERSION
    uint32_t subgroup_size = 0;
    uint32_t shared_memory_bytes = 0;  // per workgroup
    uint64_t storage_buffer_range_bytes = 0;
    bool usable = false;         // false: too old for throng, or compiles_only
    bool compiles_only = false;  // the driver stands in for hardware that is not there: nothing runs on it
};

// What the Khronos validation layer looks at. Values other than kOff need the layer to be installed, and are for tests.
enum class Validation { kOff, kStandard, kSynchronization, kGpuAssisted };

struct DeviceSettings {
    // Empty: a discrete GPU if there is one, else an integrated one, else a virtual one, else the software device, else
    // the native one. Otherwise: an index of list(), "cpu" for the software device, "native", or a part of another
    // device's name (upper or lower case).
    //
    // The native device needs neither Vulkan nor a GPU: this machine's processor computes. Crowds are updated by
    // Crowd::update(), and OutputBlock::host is where the results are.
    std::string select{};
    // Native and software devices: threads that compute updates, the calling one included; 0: as many as the process
    // may run side by side (its affinity, its container); at most 1024. Results do not depend on it.
    uint32_t threads = 0;
    // Native and software devices: the application's job system computes updates, in place of the device's own threads.
    std::shared_ptr<JobSystem> jobs{};
    Validation validation = Validation::kOff;
    // Keeps what the driver has compiled in $XDG_CACHE_HOME/throng or ~/.cache/throng, one file for each device and
    // driver, so that it need not be compiled at the next start. The file is written when the device is destroyed; if
    // it cannot be read or written, the device works without it.
    bool pipeline_cache = true;
};

// An instance, device and queue that the application made, and destroys after all that throng made with them: copies of
// the Device, crowds and renderers. The instance must be made for Vulkan 1.3 (VkApplicationInfo::apiVersion), by the
// system's libvulkan.so.1; the device has the features synchronization2 and maintenance4 enabled, and
// dynamicRendering to draw with throng. throng cannot ask which features are enabled; validation layers can tell. The
// queue supports compute, and graphics to draw with throng.
struct AdoptedDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
    bool shader_int64 = false;  // that feature is enabled too: software devices run faster with it
    // These features of VkPhysicalDeviceVulkan13Features are enabled too: GPUs whose subgroups have several sizes run
    // faster with both, and compute the same bits as a device of throng's own.
    bool subgroup_size_control = false, compute_full_subgroups = false;
    // The application's own cache, with which throng makes its pipelines; the application still destroys it. Null:
    // none. It must not have been created as externally synchronized.
    VkPipelineCache pipeline_cache = VK_NULL_HANDLE;
    // The threads of native updates on a software device, as DeviceSettings::threads and jobs
    uint32_t threads = 0;
    std::shared_ptr<JobSystem> jobs{};
    // Families of other queues whose commands use throng's buffers: one that computes, for updates beside the drawing,
    // or one that copies, for Crowd::record_uploads(). The buffers then have VK_SHARING_MODE_CONCURRENT, and need no
    // ownership transfers. If the first update of a crowd runs on another queue than the uploads of a crowd that it
    // shares tables with (Crowd::create()), make it wait for that queue by a semaphore.
    //
    // If another family reads nothing but outputs(), the list may be empty: the application then transfers the views
    // that it reads, after a record() (or its record_disoccluded()), and back before the next record() to the same
    // frame slot. Views that are the same in all slots (parameter, target, destination, command) must be back before
    // the next record(); so must `skin` with keep_previous_matrices or Culling::skips_updates. Crowd::mesh() needs the
    // list.
    std::vector<uint32_t> more_queue_families{};
};

// The instruction set that native updates and pictures use, the best that this machine's processor has: "SSE2", "AVX2",
// "AVX-512" or "NEON"; empty where throng has none for it. Results of different sets differ in the last bits.
std::string native_instruction_set();

class Gpu;  // internal

// A handle; copies share one device, which lives as long as the last copy and the last crowd made with it.
// Several devices may live side by side. Creation is thread-safe; crowds of one device share its queue, so calls that
// use it need the caller's lock when made from several threads: Crowd::update(), read_...(), save_state() and
// restore_state(); Renderer::render(), render_frame() and update(), and prepare() for a crowd that has been updated. On
// a software device also prepare() and record_drawing(), if record_uploads() has been recorded and no update. A native
// device has no queue: its crowds may be updated side by side, each by one thread at a time.
class Device {
public:
    // All physical devices of this machine, and the native one, which is the last. Errors: kVulkan.
    static Result<std::vector<DeviceInfo>> list();
    // Errors: kNoDevice (no device matches, or it cannot run throng, and why; no validation layer), kLimit (too many
    // threads), kVulkan.
    static Result<Device> create(const DeviceSettings& settings = {});
    // throng submits to the adopted queue only in the calls that say so; the application guards the queue there.
    // Errors: kInvalidArgument (something is null; no such queue family, or without compute; an instance made for a
    // Vulkan below 1.3), kLimit (too many threads), kNoDevice (the device cannot run throng).
    static Result<Device> adopt(const AdoptedDevice& adopted);

    const DeviceInfo& info() const;
    // Compiles the kernels of all crowds of this device that Crowd::record() would otherwise compile when it first
    // needs them. Only software devices defer this, since they need no kernels as long as updates are native
    // (Crowd::update()); elsewhere Crowd::create() has compiled them, and this does nothing. Any thread, also while
    // others record. Errors: kVulkan.
    Result<void> warm_up() const;
    // Messages of the validation layer so far (errors and warnings); 0 where validation is off.
    uint32_t validation_message_count() const;

    // Internal.
    explicit Device(std::shared_ptr<Gpu> gpu);
    const std::shared_ptr<Gpu>& gpu() const;  // throws where the device has been moved from

private:
    std::shared_ptr<Gpu> gpu_;
};

}  // namespace throng
