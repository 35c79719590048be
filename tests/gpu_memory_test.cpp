// Buffer memory, uploads to it, and that the driver is asked for memory rarely.
#include "gpu/buffer.h"
#include "gpu/free_ranges.h"
#include "gpu/upload.h"
#include "base/failure.h"
#include "tests/kernel_runner.h"
#include "tests/test_rig.h"
#include "tests/text.h"
#include "tools/creatures/creature.h"

#include <throng/crowd.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <random>
#include <thread>

namespace throng {
namespace {

using namespace test;

constexpr VkDeviceSize kMiB = VkDeviceSize{1} << 20;

// ---- Which parts of a block are free

// A reference model of the free ranges, with one byte per unit.
struct RangesModel {
    explicit RangesModel(uint64_t size) : used(size) {}

    bool has_room(uint64_t size, uint64_t alignment) const {
        for (uint64_t offset = 0; offset + size <= used.size(); offset += alignment)
            if (is_free(offset, size)) return true;
        return false;
    }
    bool is_free(uint64_t offset, uint64_t size) const {
        const auto begin = used.begin() + static_cast<ptrdiff_t>(offset);
        return std::none_of(begin, begin + static_cast<ptrdiff_t>(size), [](bool one) { return one; });
    }
    void set(uint64_t offset, uint64_t size, bool to) {
        std::fill_n(used.begin() + static_cast<ptrdiff_t>(offset), size, to);
    }

    std::vector<bool> used;
};

TEST(FreeRanges, GiveOnlyFreeRanges) {
    constexpr uint64_t kSize = 3000;
    std::mt19937 random(1);
    const auto below = [&](uint32_t end) { return std::uniform_int_distribution<uint32_t>(0, end - 1)(random); };
    FreeRanges ranges(kSize);
    RangesModel model(kSize);
    struct Part {
        uint64_t offset, size;
    };
    std::vector<Part> parts;
    size_t refused = 0;
    for (int step = 0; step < 20'000; ++step) {
        if (parts.empty() || below(100) < 52) {
            const uint64_t size = 1 + below(below(8) == 0 ? 600 : 60), alignment = uint64_t{1} << below(7);
            const std::optional<uint64_t> offset = ranges.take(size, alignment);
            ASSERT_EQ(offset.has_value(), model.has_room(size, alignment)) << "step " << step;
            refused += !offset;
            if (!offset) continue;
            ASSERT_EQ(*offset % alignment, 0u);
            ASSERT_LE(*offset + size, kSize);
            ASSERT_TRUE(model.is_free(*offset, size)) << "step " << step;
            model.set(*offset, size, true);
            parts.push_back({*offset, size});
        } else {
            std::swap(parts[below(static_cast<uint32_t>(parts.size()))], parts.back());
            ranges.give_back(parts.back().offset, parts.back().size);
            model.set(parts.back().offset, parts.back().size, false);
            parts.pop_back();
        }
        ASSERT_EQ(ranges.all_free(), parts.empty()) << "step " << step;
    }
    EXPECT_GT(refused, 100u) << "the block was full at times";
    for (const Part& part : parts) ranges.give_back(part.offset, part.size);
    EXPECT_TRUE(ranges.all_free());
    EXPECT_EQ(ranges.take(kSize, 64), 0u);
    EXPECT_EQ(ranges.take(1, 1), std::nullopt);
}

// ---- Blocks

TEST(GpuMemory, BlocksAreSharedAndGrowAndAreFreed) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    ASSERT_EQ(gpu.memory.block_count(), 0u);
    constexpr VkDeviceSize kPart_bytes = 300'000;
    std::deque<MemoryPart> parts;
    for (int i = 0; i < 200; ++i) parts.push_back(gpu.memory.take(0, kPart_bytes, 256));
    EXPECT_LE(gpu.counts.allocations, 6u) << "of 57 MiB: 4, 4, 8, 16 and 32";
    EXPECT_EQ(gpu.memory.block_count(), gpu.counts.allocations);
    for (size_t i = 0; i < parts.size(); ++i) {
        EXPECT_EQ(parts[i].offset_bytes % 256, 0u);
        for (size_t k = 0; k < i; ++k)
            EXPECT_TRUE(parts[i].memory != parts[k].memory ||
                        parts[i].offset_bytes >= parts[k].offset_bytes + kPart_bytes ||
                        parts[k].offset_bytes >= parts[i].offset_bytes + kPart_bytes);
    }
    const uint64_t before = gpu.counts.allocations;
    const size_t blocks_before = gpu.memory.block_count();
    const MemoryPart large = gpu.memory.take(0, 2 * MemoryBlocks::kLargestBlock_bytes, 16);
    EXPECT_EQ(gpu.counts.allocations, before + 1) << "a block of its own";
    gpu.memory.give_back(large);
    EXPECT_EQ(gpu.memory.block_count(), blocks_before);
    for (; parts.size() > 1; parts.pop_front()) gpu.memory.give_back(parts.front());
    EXPECT_EQ(gpu.memory.block_count(), 2u) << "one where something is in use still, and an empty one, which is kept";
    gpu.memory.give_back(parts.front());
    EXPECT_EQ(gpu.memory.block_count(), 1u) << "the empty one";
    gpu.memory.clear();
    EXPECT_EQ(gpu.memory.block_count(), 0u);
}

TEST(GpuMemory, ReadBacksReuseTheirMemory) {
    const Device device = another_device();
    const std::vector<uint32_t> values(1000, 7);
    const Buffer buffer = upload(device.gpu(), "values", values);
    EXPECT_EQ(download<uint32_t>(device.gpu(), buffer), values);
    const uint64_t before = device.gpu()->counts.allocations;
    for (int i = 0; i < 5; ++i) EXPECT_EQ(download<uint32_t>(device.gpu(), buffer), values);
    EXPECT_EQ(device.gpu()->counts.allocations, before);
    // The same of a memory type that nothing else uses, as on a discrete GPU
    MemoryBlocks blocks(*device.gpu(), true);
    for (int i = 0; i < 5; ++i) blocks.give_back(blocks.take(0, 1000, 64));
    EXPECT_EQ(device.gpu()->counts.allocations, before + 1);
    EXPECT_EQ(blocks.block_count(), 1u);
}

TEST(GpuMemory, OneEmptyBlockIsKept) {
    const Device device = another_device();
    for (const bool keeps_empty : {true, false}) {
        MemoryBlocks blocks(*device.gpu(), keeps_empty);
        const MemoryPart first = blocks.take(0, MemoryBlocks::kSmallestBlock_bytes, 16),
                         second = blocks.take(0, MemoryBlocks::kSmallestBlock_bytes, 16),
                         large = blocks.take(0, 2 * MemoryBlocks::kLargestBlock_bytes, 16);
        EXPECT_EQ(blocks.block_count(), 3u);
        blocks.give_back(large);
        EXPECT_EQ(blocks.block_count(), 2u) << "what is larger than shared blocks is never kept";
        blocks.give_back(first);
        EXPECT_EQ(blocks.block_count(), keeps_empty ? 2u : 1u);
        blocks.give_back(second);
        EXPECT_EQ(blocks.block_count(), keeps_empty ? 1u : 0u);
    }
}

// Each thread writes its number into the memory that it takes, and must find it there when it gives the memory back.
TEST(GpuMemory, ThreadsDoNotShareMemory) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    uint32_t type = 0;
    gpu.allocate(~0u, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, 0,
                 [&](uint32_t mapped) { type = mapped; });
    std::atomic<uint32_t> wrong{0};
    const auto work = [&](std::byte number) {
        std::mt19937 random(static_cast<uint32_t>(number));
        std::deque<MemoryPart> parts;
        const auto give_back = [&] {
            const MemoryPart part = parts.front();
            parts.pop_front();
            wrong += std::any_of(part.mapped, part.mapped + part.size_bytes,
                                 [&](std::byte byte) { return byte != number; });
            gpu.memory.give_back(part);
        };
        for (int step = 0; step < 500; ++step) {
            parts.push_back(gpu.memory.take(type, 1 + random() % 100'000, 64));
            std::fill_n(parts.back().mapped, parts.back().size_bytes, number);
            if (parts.size() > 20) give_back();
        }
        while (!parts.empty()) give_back();
    };
    std::vector<std::thread> threads;
    for (int number = 1; number <= 4; ++number) threads.emplace_back(work, static_cast<std::byte>(number));
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(gpu.memory.block_count(), 1u) << "the one that is kept";
}

PFN_vkAllocateMemory driver_allocate = nullptr;
VkDeviceSize max_allocated_bytes = 0;

VKAPI_ATTR VkResult VKAPI_CALL allocate_little(VkDevice device, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
    if (info->allocationSize > max_allocated_bytes) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return driver_allocate(device, info, callbacks, memory);
}

TEST(GpuMemory, FallsBackToTheNeededSizeIfABlockDoesNotFit) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    driver_allocate = std::exchange(gpu.vk.vkAllocateMemory, &allocate_little);
    max_allocated_bytes = kMiB;
    const std::vector<uint32_t> values(1000, 7);
    std::optional<Buffer> buffer(upload(device.gpu(), "values", values));
    EXPECT_EQ(download<uint32_t>(device.gpu(), *buffer), values);
    const Result<void> refused = as_result([&] { Buffer(device.gpu(), "too much", 2 * kMiB, 0); });
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kOutOfMemory);
    EXPECT_TRUE(contains(refused.error().text(), "too much")) << refused.error().text();
    buffer.reset();
    gpu.memory.clear();  // one block per memory type is kept
    EXPECT_EQ(gpu.memory.block_count(), 0u);
}

PFN_vkFreeMemory driver_free = nullptr;

VKAPI_ATTR void VKAPI_CALL free_and_have_more(VkDevice device, VkDeviceMemory memory,
                                              const VkAllocationCallbacks* callbacks) {
    driver_free(device, memory, callbacks);
    max_allocated_bytes = 64 * kMiB;
}

TEST(GpuMemory, KeptBlocksAreFreedIfMemoryRunsOut) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    const uint32_t type = 0;
    gpu.memory.give_back(gpu.memory.take(type, 20 * kMiB, 64));
    ASSERT_EQ(gpu.memory.block_count(), 1u) << "kept, and too small for what follows";
    driver_allocate = std::exchange(gpu.vk.vkAllocateMemory, &allocate_little);
    driver_free = std::exchange(gpu.vk.vkFreeMemory, &free_and_have_more);
    max_allocated_bytes = 0;
    const MemoryPart part = gpu.memory.take(type, 30 * kMiB, 64);
    EXPECT_EQ(gpu.memory.block_count(), 1u);
    gpu.memory.give_back(part);
    gpu.memory.clear();
    gpu.vk.vkAllocateMemory = driver_allocate;
    gpu.vk.vkFreeMemory = driver_free;
}

// Simulates two memory types on a driver that has one: the first is device-local and full, the second is not
// device-local.
PFN_vkGetBufferMemoryRequirements driver_requirements = nullptr;

VKAPI_ATTR void VKAPI_CALL fits_both(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs) {
    driver_requirements(device, buffer, needs);
    needs->memoryTypeBits = 3;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_of_second(VkDevice device, const VkMemoryAllocateInfo* asked,
                                                  const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
    if (asked->memoryTypeIndex == 0) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    VkMemoryAllocateInfo of_driver = *asked;
    of_driver.memoryTypeIndex = 0;
    return driver_allocate(device, &of_driver, callbacks, memory);
}

TEST(GpuMemory, AnotherHeapIsUsedIfTheBestIsFull) {
    const Device device = another_device();
    Gpu& gpu = *device.gpu();
    if (gpu.memory_properties.memoryTypeCount != 1) GTEST_SKIP() << "the test device has several memory types";
    VkPhysicalDeviceMemoryProperties& memory = gpu.memory_properties;
    memory.memoryTypeCount = memory.memoryHeapCount = 2;
    memory.memoryTypes[1] = memory.memoryTypes[0];
    memory.memoryTypes[1].heapIndex = 1;
    memory.memoryTypes[1].propertyFlags &= ~VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    memory.memoryHeaps[1] = memory.memoryHeaps[0];
    driver_requirements = std::exchange(gpu.vk.vkGetBufferMemoryRequirements, &fits_both);
    driver_allocate = std::exchange(gpu.vk.vkAllocateMemory, &allocate_of_second);
    {
        const std::vector<uint32_t> numbers = {1, 2, 3, 4};
        const Buffer buffer = upload(device.gpu(), "numbers", numbers);
        EXPECT_EQ(download<uint32_t>(device.gpu(), buffer), numbers);
        memory.memoryTypeCount = 1;
        EXPECT_THROW(Buffer(device.gpu(), "more", 64 * kMiB, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT), Failure);
    }
    gpu.memory.clear();
    gpu.vk.vkAllocateMemory = driver_allocate;
    gpu.vk.vkGetBufferMemoryRequirements = driver_requirements;
}

// ---- Uploads

std::vector<uint32_t> random_numbers(size_t count, uint32_t seed) {
    std::vector<uint32_t> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = (static_cast<uint32_t>(i) + seed) * 2654435761u;
    return values;
}

TEST(Uploads, AreSubmittedTogether) {
    const std::shared_ptr<Gpu>& gpu = test_gpu();
    const uint64_t before = gpu->counts.submissions;
    std::vector<Buffer> buffers;
    Uploads uploads(gpu);
    for (uint32_t i = 0; i < 100; ++i) buffers.push_back(upload(uploads, "numbers", random_numbers(1 + 37 * i, i)));
    const Buffer empty = upload(uploads, "nothing", std::vector<uint32_t>());
    EXPECT_EQ(gpu->counts.submissions, before);
    uploads.finish();
    uploads.finish();
    EXPECT_EQ(gpu->counts.submissions, before + 1);
    for (uint32_t i = 0; i < buffers.size(); ++i)
        ASSERT_EQ(download<uint32_t>(gpu, buffers[i]).front(), random_numbers(1, i).front()) << i;
    // Replacing every other buffer leaves the others unchanged.
    for (uint32_t i = 0; i < buffers.size(); i += 2)
        buffers[i] = upload(gpu, "others", random_numbers(20 + 31 * i, 1000 + i));
    for (uint32_t i = 0; i < buffers.size(); ++i)
        ASSERT_EQ(download<uint32_t>(gpu, buffers[i]),
                  i % 2 == 0 ? random_numbers(20 + 31 * i, 1000 + i) : random_numbers(1 + 37 * i, i))
            << i;
    EXPECT_EQ(download<uint32_t>(gpu, empty), std::vector<uint32_t>(4, 0));
}

TEST(Uploads, ThatExceedTheStagingMemoryAreSubmittedEarly) {
    const std::shared_ptr<Gpu>& gpu = test_gpu();
    const uint64_t before = gpu->counts.submissions;
    const std::vector<size_t> counts{7 * kMiB, 7 * kMiB, 7 * kMiB, 18 * kMiB, 1000};  // words: 28, 28, 28, 72 MiB
    std::vector<Buffer> buffers;
    Uploads uploads(gpu);
    for (const size_t count : counts) buffers.push_back(upload(uploads, "numbers", random_numbers(count, 5)));
    uploads.finish();
    EXPECT_EQ(gpu->counts.submissions, before + 4);
    for (size_t i = 0; i < counts.size(); ++i)
        EXPECT_TRUE(download<uint32_t>(gpu, buffers[i]) == random_numbers(counts[i], 5)) << i;
}

// The validation layer would report a copy to a destroyed buffer.
TEST(Uploads, TheTargetMayBeDestroyedBeforeFinish) {
    Uploads uploads(test_gpu());
    Buffer buffer = upload(uploads, "numbers", random_numbers(100, 1));
    buffer = upload(uploads, "other numbers", random_numbers(200, 2));
    uploads.finish();
    EXPECT_EQ(download<uint32_t>(test_gpu(), buffer), random_numbers(200, 2));
}

TEST(Uploads, UnfinishedUploadsSubmitNothing) {
    const uint64_t before = test_gpu()->counts.submissions;
    {
        Uploads uploads(test_gpu());
        upload(uploads, "numbers", random_numbers(100, 1));
    }
    EXPECT_EQ(test_gpu()->counts.submissions, before);
}

// ---- Crowds

// Prints the tables of docs/performance.md, "Making a crowd".
void make_crowds(bool natively, const std::string& scan = "auto") {
    std::vector<Character> kinds;
    for (const CreatureKind kind : {CreatureKind::kDragon, CreatureKind::kWalker, CreatureKind::kWillow}) {
        const Result<Asset> asset = make_creature(creature_settings(kind));
        ASSERT_TRUE(asset) << asset.error().text();
        kinds.push_back(compile_character(*asset).value());
    }
    struct Case {
        const char* name;
        size_t group_count, kind_count;
        bool culls;
        uint64_t max_pipelines;
    };
    // Kernels that read rows are made for a rig and a set of its joints; those of software devices read keys.
    const bool has_rows = scan == "stream" || !test_gpu()->uses_software_kernels();
    std::printf("  scan %s:\n", scan.c_str());
    for (const Case& of : {Case{"1 group", 1, 1, false, 4},
                           {"10 groups of one rig", 10, 1, false, 4},
                           {"20 groups of three rigs", 20, 3, false, 8},
                           {"the same, culled", 20, 3, true, has_rows ? 28u : 18u}}) {
        const Device device = another_device();          // without pipelines of the case before
        if (!natively) device.gpu()->processor.reset();  // like hardware, which makes pipelines with the crowd
        const GpuCounts& counts = device.gpu()->counts;
        CrowdSettings settings{.scan = scan};
        if (of.culls) settings.culling = Culling{.reduces_joints = true};
        for (size_t i = 0; i < of.group_count; ++i) settings.groups.push_back({&kinds[i % of.kind_count], 10});
        // The first crowd is destroyed before the second is made. The second still exists while the third is made.
        std::optional<Crowd> second;
        for (const std::string when : {"", ", again", ", beside that"}) {
            const uint64_t allocations = counts.allocations, submissions = counts.submissions,
                           pipelines = counts.pipelines;
            const auto start = std::chrono::steady_clock::now();
            Result<Crowd> crowd = Crowd::create(device, settings);
            const std::chrono::duration<double, std::milli> taken_ms = std::chrono::steady_clock::now() - start;
            ASSERT_TRUE(crowd) << crowd.error().text();
            std::printf("  %s%s: %d allocations, %d submissions, %d pipelines, %.0f ms\n", of.name, when.c_str(),
                        static_cast<int>(counts.allocations - allocations),
                        static_cast<int>(counts.submissions - submissions),
                        static_cast<int>(counts.pipelines - pipelines), taken_ms.count());
            EXPECT_LE(counts.allocations - allocations, 4u) << of.name;
            EXPECT_EQ(counts.submissions - submissions, 0u) << of.name;
            EXPECT_LE(counts.pipelines - pipelines, !when.empty() || natively ? 0 : of.max_pipelines) << of.name;
            if (when == ", again") {
                second = std::move(*crowd);
                ASSERT_TRUE(second->update(0));
            }
        }
        second.reset();
        EXPECT_LE(device.gpu()->memory.block_count(), device.gpu()->memory_properties.memoryTypeCount)
            << "no more than an empty one of each memory type, which is kept";
    }
}

TEST(GpuMemory, ACrowdOfManyGroupsAsksLittleOfTheDriver) {
    make_crowds(false);
    if (test_gpu()->uses_software_kernels()) make_crowds(false, "stream");  // as on GPUs
}

TEST(GpuMemory, NativelyUpdatedCrowdsMakeNoPipelines) {
    if (!test_gpu()->processor) GTEST_SKIP() << "the test device is not a software device";
    make_crowds(true);
}

TEST(GpuMemory, ValidationMessagesNameBuffers) {
    Result<Device> validated = Device::create(
        {.select = test_device().info().name, .validation = Validation::kStandard, .pipeline_cache = false});
    if (!validated && validated.error().code == ErrorCode::kNoDevice) GTEST_SKIP() << validated.error().text();
    ASSERT_TRUE(validated) << validated.error().text();
    const std::shared_ptr<Gpu>& gpu = validated->gpu();
    const Buffer buffer(gpu, "Fox: key times", 64, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    testing::internal::CaptureStderr();
    VkBufferViewCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
    create.buffer = buffer.handle();  // its usage flags allow no view
    create.format = VK_FORMAT_R32_UINT;
    create.range = VK_WHOLE_SIZE;
    VkBufferView view = VK_NULL_HANDLE;
    gpu->vk.vkCreateBufferView(gpu->device, &create, nullptr, &view);
    gpu->vk.vkDestroyBufferView(gpu->device, view, nullptr);
    const std::string messages = testing::internal::GetCapturedStderr();
    EXPECT_GT(validated->validation_message_count(), 0u);
    EXPECT_TRUE(contains(messages, "Fox: key times")) << messages;
}

}  // namespace
}  // namespace throng
