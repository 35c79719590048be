#include "gpu/native.h"

#include "base/count.h"
#include "base/processor.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <new>

namespace throng {
namespace {

constexpr uint64_t kAlignment_bytes = 64, kHugePage_bytes = uint64_t{2} << 20;
constexpr uint32_t kWorkgroupSize = 64;     // of kernels that do not fix it
constexpr uint32_t kJobsOfThread = 8;       // so that no thread waits long for the last job
constexpr uint32_t kInvocationsOfJob = 64;  // below this, waking another thread takes longer than the work

}  // namespace

NativeDevice::NativeDevice(const DeviceSettings& settings) : jobs_(settings.jobs), threads_(settings.threads) {}

JobSystem& NativeDevice::jobs() const {
    std::call_once(jobs_made_, [&] {
        if (!jobs_) jobs_ = std::make_shared<ThreadPool>(threads_);
    });
    return *jobs_;
}

DeviceInfo NativeDevice::info(uint32_t index) {
    return {.index = index,
            .name = "native (" + processor_name() + ")",
            .type = "native",
            .driver = "throng",
            .api_version = 0,
            .subgroup_size = 1,
            .shared_memory_bytes = 0,
            .storage_buffer_range_bytes = properties().limits.maxStorageBufferRange,
            .usable = true};
}

uint64_t NativeDevice::memory_bytes() {
    const long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGESIZE);
    uint64_t bytes = static_cast<uint64_t>(std::max(pages, 0L)) * static_cast<uint64_t>(std::max(page_bytes, 0L));
    std::ifstream file("/sys/fs/cgroup/memory.max");  // "max" where a container has no limit of its own
    if (uint64_t limit_bytes = 0; file >> limit_bytes) bytes = std::min(bytes, limit_bytes);
    return bytes;
}

// Only the limits that throng asks for are set; shaders count in 32 bits.
VkPhysicalDeviceProperties NativeDevice::properties() {
    constexpr uint32_t kMaximum = std::numeric_limits<uint32_t>::max();
    VkPhysicalDeviceProperties properties{};
    properties.limits.maxStorageBufferRange = kMaximum;
    properties.limits.maxTexelBufferElements = kMaximum;
    properties.limits.maxPerStageDescriptorStorageBuffers = kMaximum;
    properties.limits.minStorageBufferOffsetAlignment = kAlignment_bytes;
    properties.limits.timestampPeriod = 1;
    std::ranges::fill(properties.limits.maxComputeWorkGroupCount, kMaximum);
    std::ranges::fill(properties.limits.maxComputeWorkGroupSize, kWorkgroupSize);
    properties.limits.maxComputeWorkGroupInvocations = kWorkgroupSize;
    return properties;
}

void NativeDevice::run(const NativeKernel& kernel, const NativeDispatch& dispatch, uint32_t workgroup_count) const {
    const uint32_t workgroup_size = kernel.workgroup_size > 0 ? kernel.workgroup_size : dispatch.constants[0];
    // With WORKGROUP_OF_STRIDE one invocation processes a whole instance, so that a workgroup is enough for a job
    const uint32_t least = workgroup_size == 1 ? 1 : std::max(1u, kInvocationsOfJob / workgroup_size);
    for_parts(workgroup_count, least, [&](uint32_t first, uint32_t end) { kernel.run(dispatch, first, end); });
}

uint32_t NativeDevice::part_limit() const {
    const uint32_t threads = jobs().concurrency();
    return threads > 1 ? threads * kJobsOfThread : 1;
}

NativeMemory::NativeMemory(uint64_t size_bytes) {
    const uint64_t alignment_bytes = size_bytes >= kHugePage_bytes ? kHugePage_bytes : kAlignment_bytes;
    const uint64_t used_bytes = rounded_up(std::max<uint64_t>(size_bytes, 1), alignment_bytes);
    // calloc(), since pages that are never written take no memory, such as most of the room for events
    allocation_ = std::calloc(1, used_bytes + alignment_bytes);
    if (!allocation_) throw std::bad_alloc();
    void* start = allocation_;
    size_t room_bytes = used_bytes + alignment_bytes;
    bytes_ = static_cast<std::byte*>(std::align(alignment_bytes, used_bytes, start, room_bytes));
    if (alignment_bytes < kHugePage_bytes) return;
    // Huge pages cause fewer TLB misses when updates walk the rows and matrices of a crowd; only a hint. Written here,
    // so that the first update does not wait for page faults
    madvise(bytes_, used_bytes, MADV_HUGEPAGE);
    std::memset(bytes_, 0, used_bytes);
}

NativeMemory::~NativeMemory() { std::free(allocation_); }

}  // namespace throng
