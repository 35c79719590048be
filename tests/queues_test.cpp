// An application with queues of its own: it uploads on one, updates on another, and reads the results on a third. Where
// the device has fewer families or queues than that, some are the same.
#include "crowd/crowd_state.h"
#include "gpu/barrier.h"
#include "tests/application.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/test_rig.h"

#include <bit>
#include <cstring>
#include <list>

namespace throng::test {
namespace {

// The family that has all `wanted` flags, the adopted queue's or another one, and the fewest others.
uint32_t family_for(const Application& application, VkQueueFlags wanted) {
    uint32_t best = application.queue_family;
    const auto others = [&](uint32_t family) {
        return std::popcount(application.families[family].queueFlags & ~wanted);
    };
    for (uint32_t family = 0; family < application.families.size(); ++family)
        if ((application.families[family].queueFlags & wanted) == wanted && others(family) < others(best))
            best = family;
    return best;
}

class Queue {
public:
    // The last queue of the family: another one than the adopted one, if there is one.
    Queue(const Application& application, uint32_t family) : app_(application) {
        app_.table.vkGetDeviceQueue(app_.device, family, app_.queue_count_of(family) - 1, &queue_);
        VkCommandPoolCreateInfo create{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
        create.queueFamilyIndex = family;
        check(app_.table.vkCreateCommandPool(app_.device, &create, nullptr, &pool_), "vkCreateCommandPool");
    }
    ~Queue() { app_.table.vkDestroyCommandPool(app_.device, pool_, nullptr); }
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;

    template <class Body>
    void submit(const std::vector<VkSemaphore>& wait_for, const std::vector<VkSemaphore>& signal, const Body& body) {
        VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
        allocate.commandPool = pool_;
        allocate.commandBufferCount = 1;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        check(app_.table.vkAllocateCommandBuffers(app_.device, &allocate, &commands), "vkAllocateCommandBuffers");
        const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
        check(app_.table.vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
        body(commands);
        check(app_.table.vkEndCommandBuffer(commands), "vkEndCommandBuffer");
        const std::vector<VkPipelineStageFlags> stages(wait_for.size(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
        VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
        submit.waitSemaphoreCount = static_cast<uint32_t>(wait_for.size());
        submit.pWaitSemaphores = wait_for.data();
        submit.pWaitDstStageMask = stages.data();
        submit.commandBufferCount = 1;
        submit.pCommandBuffers = &commands;
        submit.signalSemaphoreCount = static_cast<uint32_t>(signal.size());
        submit.pSignalSemaphores = signal.data();
        check(app_.table.vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
    }

private:
    const Application& app_;
    VkQueue queue_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
};

class Semaphores {
public:
    explicit Semaphores(const Application& application) : app_(application) {}
    ~Semaphores() {
        for (const VkSemaphore semaphore : all_) app_.table.vkDestroySemaphore(app_.device, semaphore, nullptr);
    }
    VkSemaphore make() {
        const VkSemaphoreCreateInfo create{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
        check(app_.table.vkCreateSemaphore(app_.device, &create, nullptr, &all_.emplace_back()), "vkCreateSemaphore");
        return all_.back();
    }

private:
    const Application& app_;
    std::list<VkSemaphore> all_;
};

// One half of a transfer between families, the release or the acquisition; within a family, a barrier.
void transfer(const Gpu& gpu, VkCommandBuffer commands, const BufferView& view, uint32_t from, uint32_t to) {
    VkBufferMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.srcQueueFamilyIndex = from;
    barrier.dstQueueFamilyIndex = to;
    barrier.buffer = view.buffer;
    barrier.offset = view.offset_bytes;
    barrier.size = view.size_bytes;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.bufferMemoryBarrierCount = 1;
    dependency.pBufferMemoryBarriers = &barrier;
    gpu.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

class Queues : public testing::TestWithParam<bool> {};

// Frames in flight: an update runs on its queue while the results of the one before are read on another. Buffers are
// shared by the families or, if the parameter is true, the application transfers the results between them.
TEST_P(Queues, UploadUpdateAndReadOnQueuesOfTheirOwn) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no queues";
    const bool transfers = GetParam();
    constexpr uint32_t kFrames = 6, kInFlight = 2, kCount = 40;
    const Application application;
    const uint32_t reading = application.queue_family, computing = family_for(application, VK_QUEUE_COMPUTE_BIT),
                   copying = transfers ? computing : family_for(application, VK_QUEUE_TRANSFER_BIT);
    if (transfers && computing == reading) GTEST_SKIP() << "its queues are all of one family";
    AdoptedDevice adopted = application.adopted();
    if (transfers) {
        adopted.queue_family = computing;
        application.table.vkGetDeviceQueue(application.device, computing, 0, &adopted.queue);
    } else {
        adopted.more_queue_families = {computing, copying};
    }
    const Device device = Device::adopt(adopted).value();
    const std::shared_ptr<Gpu>& gpu = device.gpu();
    const Character character = make_character({.joint_count = 30});
    const Controller controller = direct_layers(1);
    const CrowdSettings settings{
        .groups = {{.character = &character, .instance_count = kCount},
                   {.character = &character, .instance_count = kCount, .controller = &controller}},
        .path = UpdatePath::kDevice,
        .frames_in_flight = kInFlight};
    const auto set_up = [&](Crowd& crowd) {
        std::vector<Playback> plays(kCount);
        for (uint32_t i = 0; i < kCount; ++i)
            plays[i].first = {
                .clip = 0, .time_s = 0.05f * static_cast<float>(i), .speed = 1 + 0.01f * static_cast<float>(i)};
        EXPECT_TRUE(crowd.set_playback(*crowd.instances(0), plays));
        EXPECT_TRUE(crowd.play(*crowd.instances(1), 0, {.clip = {.clip = 0}}));
    };
    const auto size_bytes = [](const Crowd& crowd, uint32_t block) { return crowd.outputs()[block].skin.size_bytes; };

    std::vector<std::vector<std::byte>> wanted;  // [frame * 2 + group]
    Crowd alone = Crowd::create(device, settings).value();
    set_up(alone);
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        ASSERT_TRUE(alone.update(0.1f));
        for (uint32_t group = 0; group < 2; ++group)
            wanted.push_back(
                output<std::byte>(alone.outputs()[group], &OutputBlock::skin, size_bytes(alone, group), gpu));
    }

    ASSERT_NE(wanted[0], wanted[2]) << "it moves";

    Crowd crowd = Crowd::create(device, settings).value();
    set_up(crowd);
    std::vector<Buffer> copies;
    {
        Queue upload(application, copying), update(application, computing), read(application, reading);
        Semaphores semaphores(application);
        std::vector<VkSemaphore> is_read(kFrames);
        const VkSemaphore uploaded = semaphores.make();
        upload.submit({}, {uploaded}, [&](VkCommandBuffer commands) { EXPECT_TRUE(crowd.record_uploads(commands)); });
        for (uint32_t frame = 0; frame < kFrames; ++frame) {
            std::vector<VkSemaphore> ready;
            if (frame == 0) ready.push_back(uploaded);
            if (frame >= kInFlight) ready.push_back(is_read[frame - kInFlight]);
            const VkSemaphore updated = semaphores.make();
            const auto transfer_skins = [&](VkCommandBuffer commands, uint32_t slot, uint32_t from, uint32_t to) {
                for (const OutputBlock& block : crowd.outputs(slot))
                    if (transfers) transfer(*gpu, commands, block.skin, from, to);
            };
            update.submit(ready, {updated}, [&](VkCommandBuffer commands) {
                const uint32_t slot = (crowd.frame_slot() + 1) % kInFlight;
                if (frame >= kInFlight) transfer_skins(commands, slot, reading, computing);
                const Result<void> recorded = crowd.record(commands, 0.1f);
                EXPECT_TRUE(recorded) << recorded.error().text();
                EXPECT_EQ(crowd.frame_slot(), slot);
                transfer_skins(commands, slot, computing, reading);
            });
            // The last ones signal nothing, since nobody waits.
            std::vector<VkSemaphore> done;
            if (frame + kInFlight < kFrames) done.push_back(is_read[frame] = semaphores.make());
            read.submit({updated}, done, [&](VkCommandBuffer commands) {
                transfer_skins(commands, crowd.frame_slot(), computing, reading);
                for (uint32_t group = 0; group < 2; ++group) {
                    const VkDeviceSize bytes = size_bytes(crowd, group);
                    copies.emplace_back(gpu, "copy", bytes, 0, MemoryKind::kReadback);
                    record_copy(*gpu, commands, output_range(crowd.outputs()[group], &OutputBlock::skin, 0, bytes),
                                BufferRange(copies.back(), 0, bytes));
                }
                memory_barrier(*gpu, commands, kTransferWrite, kHostRead);
                transfer_skins(commands, crowd.frame_slot(), reading, computing);
            });
        }
        EXPECT_EQ(application.table.vkDeviceWaitIdle(application.device), VK_SUCCESS);
    }
    for (size_t i = 0; i < wanted.size(); ++i)
        EXPECT_EQ(std::memcmp(copies[i].mapped(), wanted[i].data(), wanted[i].size()), 0)
            << "group " << i % 2 << " after update " << i / 2;
}

INSTANTIATE_TEST_SUITE_P(Queues, Queues, testing::Bool(),
                         [](const auto& of) { return of.param ? "TransferOwnership" : "ShareBuffers"; });

}  // namespace
}  // namespace throng::test
