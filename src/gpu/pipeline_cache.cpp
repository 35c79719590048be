#include "gpu/pipeline_cache.h"

#include "base/cache_folder.h"
#include "base/crc64.h"
#include "base/failure.h"
#include "base/read_file.h"
#include "base/replace_file.h"
#include "gpu/gpu.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

namespace throng {
namespace {

constexpr uint64_t kMagic = 0x3145504950524854;       // "THRPIPE1"
constexpr uint64_t kMax_bytes = uint64_t{256} << 20;  // a larger file is discarded and started anew
constexpr size_t kDriverHead_bytes = sizeof(VkPipelineCacheHeaderVersionOne);
static_assert(kDriverHead_bytes == 16 + VK_UUID_SIZE);

struct FileHead {
    uint64_t magic = kMagic;
    uint64_t data_bytes = 0;
    uint64_t checksum = 0;  // crc64() of the data
};

// Empty if the file cannot be read.
std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
    try {
        return read_file(file, kMax_bytes, file.string());
    } catch (const Failure&) {
        return {};
    }
}

}  // namespace

std::filesystem::path pipeline_cache_file(const VkPhysicalDeviceProperties& device) {
    const std::filesystem::path folder = cache_folder();
    if (folder.empty()) return {};
    char name[64 + 2 * VK_UUID_SIZE];
    int length = std::snprintf(name, sizeof name, "pipelines_%04x_%04x_%08x_", device.vendorID, device.deviceID,
                               device.driverVersion);
    for (const uint8_t byte : device.pipelineCacheUUID)
        length += std::snprintf(name + length, sizeof name - static_cast<size_t>(length), "%02x", byte);
    return folder / (std::string(name) + ".bin");
}

std::vector<std::byte> pipeline_cache_bytes(std::span<const std::byte> data) {
    const FileHead head{.data_bytes = data.size(), .checksum = crc64(data)};
    std::vector<std::byte> file(sizeof head + data.size());
    std::memcpy(file.data(), &head, sizeof head);
    std::ranges::copy(data, file.begin() + sizeof head);
    return file;
}

std::vector<std::byte> pipeline_cache_data(std::span<const std::byte> file, const VkPhysicalDeviceProperties& device) {
    FileHead head;
    if (file.size() < sizeof head + kDriverHead_bytes) return {};
    std::memcpy(&head, file.data(), sizeof head);
    const std::span<const std::byte> data = file.subspan(sizeof head);
    if (head.magic != kMagic || head.data_bytes != data.size() || head.checksum != crc64(data)) return {};
    VkPipelineCacheHeaderVersionOne driver;
    std::memcpy(&driver, data.data(), sizeof driver);
    const bool is_of_device = driver.headerSize >= kDriverHead_bytes && driver.headerSize <= data.size() &&
                              driver.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
                              driver.vendorID == device.vendorID && driver.deviceID == device.deviceID &&
                              std::ranges::equal(driver.pipelineCacheUUID, device.pipelineCacheUUID);
    return is_of_device ? std::vector(data.begin(), data.end()) : std::vector<std::byte>();
}

PipelineCache::PipelineCache(const Gpu& gpu, std::filesystem::path file) : gpu_(gpu), file_(std::move(file)) {
    // If loading fails, everything is compiled
    Result<std::vector<std::byte>> loaded = as_result(
        [&] { return pipeline_cache_data(bytes_of(file_), gpu.properties); });
    if (loaded) loaded_ = std::move(*loaded);
    if (!create() && !loaded_.empty()) {
        loaded_.clear();  // the driver rejects the data: starts empty, and replaces the file
        create();
    }
}

bool PipelineCache::create() {
    VkPipelineCacheCreateInfo create{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    create.initialDataSize = loaded_.size();
    create.pInitialData = loaded_.data();
    if (gpu_.vk.vkCreatePipelineCache(gpu_.device, &create, nullptr, &cache_) == VK_SUCCESS) return true;
    cache_ = VK_NULL_HANDLE;
    return false;
}

PipelineCache::~PipelineCache() {
    // A destructor cannot report a failure
    const Result<void> saved = as_result([this] { save(); });
    static_cast<void>(saved);
    gpu_.vk.vkDestroyPipelineCache(gpu_.device, cache_, nullptr);
}

void PipelineCache::save() const {
    size_t size_bytes = 0;
    if (!cache_ || gpu_.vk.vkGetPipelineCacheData(gpu_.device, cache_, &size_bytes, nullptr) != VK_SUCCESS) return;
    std::vector<std::byte> data(size_bytes);
    if (gpu_.vk.vkGetPipelineCacheData(gpu_.device, cache_, &size_bytes, data.data()) != VK_SUCCESS) return;
    data.resize(size_bytes);
    // Drivers that cache elsewhere, as Mesa's do, return only a head that identifies them.
    if (data.size() <= kDriverHead_bytes || data == loaded_) return;
    std::error_code error;
    std::filesystem::create_directories(file_.parent_path(), error);
    replace_file(file_, pipeline_cache_bytes(data));
}

}  // namespace throng
