// Vulkan events that commands set, and objects that are kept while commands use them.
#include "base/failure.h"
#include "draw/staged_picture.h"
#include "gpu/event.h"
#include "tests/recorder.h"
#include "tests/test_device.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace throng::test {
namespace {

// A host stage in the barrier of an event is invalid (VUID-vkCmdSetEvent2-dstStageMask-09392), but validation layers
// before 2024 do not report it.
VkPipelineStageFlags2 event_stages = 0;
PFN_vkCmdSetEvent2 driver_set_event = nullptr;

VKAPI_ATTR void VKAPI_CALL note_stages(VkCommandBuffer commands, VkEvent event, const VkDependencyInfo* dependency) {
    for (uint32_t i = 0; i < dependency->memoryBarrierCount; ++i)
        event_stages |= dependency->pMemoryBarriers[i].srcStageMask | dependency->pMemoryBarriers[i].dstStageMask;
    driver_set_event(commands, event, dependency);
}

TEST(DeviceEvent, IsSetWithoutTheHostStage) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    driver_set_event = std::exchange(gpu.vk.vkCmdSetEvent2, &note_stages);
    DeviceEvent after_copies(device.gpu()), after_all(device.gpu());
    gpu.submit_and_wait([&](VkCommandBuffer commands) {
        after_copies.record_set(commands);
        after_all.record_set_behind_all(commands);
    });
    gpu.vk.vkCmdSetEvent2 = driver_set_event;
    EXPECT_TRUE(after_copies.is_set() && after_all.is_set());
    EXPECT_NE(event_stages, 0u);
    EXPECT_EQ(event_stages & VK_PIPELINE_STAGE_2_HOST_BIT, 0u);
}

TEST(DeviceEvent, ReportsALostDevice) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    const DeviceEvent event(device.gpu());
    EXPECT_FALSE(event.is_set());
    const PFN_vkGetEventStatus of_driver = std::exchange(
        gpu.vk.vkGetEventStatus, +[](VkDevice, VkEvent) -> VkResult { return VK_ERROR_DEVICE_LOST; });
    try {
        event.is_set();
        ADD_FAILURE() << "it is neither set nor to be set";
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.error.code, ErrorCode::kDeviceLost);
    }
    gpu.vk.vkGetEventStatus = of_driver;
}

TEST(StagedPicture, DroppedFramesNeedNoMoreMemory) {
    Recorder recorder;
    StagedPicture picture(test_gpu(), {16, 16}, false);
    std::set<const uint8_t*> used;
    for (int frame = 0; frame < 12; ++frame) {
        used.insert(picture.next());
        VkCommandBuffer commands = recorder.record([&](VkCommandBuffer recorded) { picture.record(recorded); });
        if (frame % 3 == 2) recorder.submit(commands);
        test_gpu()->wait_idle();
    }
    EXPECT_EQ(used.size(), 3u);
}

}  // namespace
}  // namespace throng::test
