// The driver's cache of compiled pipelines, kept in a file from one start to the next.
#pragma once

#include "gpu/vulkan.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace throng {

class Gpu;

// Its failures are never errors of throng: if the file is missing, damaged or another driver's, the cache begins empty,
// and if the file cannot be written, the cache is not kept.
class PipelineCache {
public:
    PipelineCache(const Gpu& gpu, std::filesystem::path file);
    // Replaces the file if the driver's data differ from what was loaded.
    ~PipelineCache();
    PipelineCache(const PipelineCache&) = delete;
    PipelineCache& operator=(const PipelineCache&) = delete;

    VkPipelineCache handle() const { return cache_; }

private:
    bool create();  // with what was loaded
    void save() const;

    const Gpu& gpu_;
    std::filesystem::path file_;
    std::vector<std::byte> loaded_;  // the driver's data, as the file had it
    VkPipelineCache cache_ = VK_NULL_HANDLE;
};

// One file for each device and driver, in throng's cache folder; empty if there is no folder.
std::filesystem::path pipeline_cache_file(const VkPhysicalDeviceProperties& device);

// The contents of the file: a head to detect damage, since drivers trust what they are given, then the driver's data.
std::vector<std::byte> pipeline_cache_bytes(std::span<const std::byte> data);
// The data of the file if it is intact and of this device and driver, else none.
std::vector<std::byte> pipeline_cache_data(std::span<const std::byte> file, const VkPhysicalDeviceProperties& device);

}  // namespace throng
