// The benchmark of very many characters: finished measurements are kept if a later part fails.
#include "bench/million_bench.h"
#include "base/failure.h"
#include "bench/report/records.h"
#include "gpu/gpu.h"
#include "tests/test_device.h"
#include "tests/text.h"
#include "tools/creatures/creature.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

namespace throng::bench {
namespace {

VKAPI_ATTR VkResult VKAPI_CALL create_no_buffer(VkDevice, const VkBufferCreateInfo*, const VkAllocationCallbacks*,
                                                VkBuffer*) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

VKAPI_ATTR VkResult VKAPI_CALL lose_device(VkQueue, uint32_t, const VkSubmitInfo2*, VkFence) {
    return VK_ERROR_DEVICE_LOST;
}

constexpr uint32_t kFew = 300;

// Calls `before_recording` before the time of recording is measured.
std::vector<Json> measure_a_few(const Device& device, const std::function<void(Gpu&)>& before_recording) {
    const Character character = *compile_character(
        *make_creature({.joint_count = 40, .level_count = 12, .face_count = 300}));
    const std::vector<Playback> playback(kFew);
    std::vector<Affine> placement(kFew);
    for (uint32_t i = 0; i < kFew; ++i) {
        placement[i].row[0][3] = character.size * static_cast<float>(i % 20);
        placement[i].row[2][3] = character.size * static_cast<float>(i / 20);
    }
    const auto progress = [&](const std::string& text) {
        if (test::contains(text, ": recording ")) before_recording(*device.gpu());
    };
    return measure_million(device,
                           {.configuration = "300",
                            .character = &character,
                            .playback = playback,
                            .placement = placement,
                            .pool = {.capacity = 100}},
                           1, progress);
}

TEST(MillionBench, ViewsAreKeptIfTheCrowdForRecordingDoesNotFit) {
    const Device device = another_device();
    size_t views = 0, recordings = 0;
    for (const Json& record : measure_a_few(device, [](Gpu& gpu) { gpu.vk.vkCreateBuffer = create_no_buffer; })) {
        EXPECT_FALSE(record.value("device", "").empty()) << record;
        if (!is_measured(record)) continue;
        if (record.contains("view")) {
            EXPECT_TRUE(record.contains("ms")) << record;
            ++views;
            continue;
        }
        EXPECT_EQ(record["characters"], kFew);
        EXPECT_TRUE(record.contains("unsupported_reason") && !record.contains("record_ms")) << record;
        ++recordings;
    }
    EXPECT_EQ(views, 5u);
    EXPECT_EQ(recordings, 1u);
}

TEST(MillionBench, ALostDeviceEndsIt) {
    const Device device = another_device();
    EXPECT_THROW(measure_a_few(device, [](Gpu& gpu) { gpu.vk.vkQueueSubmit2 = lose_device; }), Failure);
}

}  // namespace
}  // namespace throng::bench
