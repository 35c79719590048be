// The benchmark of very many characters: what was timed is kept if a later part fails.
#include "bench/million_bench.h"
#include "gpu/gpu.h"
#include "tests/test_device.h"
#include "tests/text.h"
#include "tools/creatures/creature.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace throng::bench {
namespace {

VKAPI_ATTR VkResult VKAPI_CALL create_no_buffer(VkDevice, const VkBufferCreateInfo*, const VkAllocationCallbacks*,
                                                VkBuffer*) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

// No further crowd fits from the moment that recording is to be timed.
TEST(MillionBench, ViewsAreKeptIfTheCrowdForRecordingDoesNotFit) {
    constexpr uint32_t kCharacters = 300;
    const Character character = *compile_character(
        *make_creature({.joint_count = 40, .level_count = 12, .face_count = 300}));
    const std::vector<Playback> playback(kCharacters);
    std::vector<Affine> placement(kCharacters);
    for (uint32_t i = 0; i < kCharacters; ++i) {
        placement[i].row[0][3] = character.size * static_cast<float>(i % 20);
        placement[i].row[2][3] = character.size * static_cast<float>(i / 20);
    }
    const Device device = another_device();
    const auto progress = [&](const std::string& text) {
        if (test::contains(text, ": recording ")) device.gpu()->vk.vkCreateBuffer = create_no_buffer;
    };
    size_t views = 0, recordings = 0;
    for (const Json& record : measure_million(device,
                                              {.configuration = "300",
                                              .character = &character,
                                              .playback = playback,
                                              .placement = placement,
                                              .pool = {.capacity = 100}},
                                              1, progress)) {
        EXPECT_FALSE(record.value("device", "").empty()) << record;
        if (record.contains("machine") || record.contains("family")) continue;  // predictions
        if (record.contains("view")) {
            EXPECT_TRUE(record.contains("ms")) << record;
            ++views;
            continue;
        }
        EXPECT_EQ(record["characters"], kCharacters);
        EXPECT_TRUE(record.contains("unsupported_reason") && !record.contains("record_ms")) << record;
        ++recordings;
    }
    EXPECT_EQ(views, 5u);
    EXPECT_EQ(recordings, 1u);
}

}  // namespace
}  // namespace throng::bench
