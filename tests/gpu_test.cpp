// Buffers, kernels, SPIR-V, and the structs that C++ and shaders share.
#include "bench/on_chip_shaders.h"
#include "io_headers.inc"
#include "base/failure.h"
#include "bind/bind.kernel.h"
#include "blend/blend.kernel.h"
#include "control/control.h"
#include "control/control.kernel.h"
#include "sample/sample.kernel.h"
#include "scan/scan.h"
#include "scan/scan_shaders.h"
#include "skin/skin.kernel.h"
#include "tests/files.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"
#include "tests/text.h"

#include <throng/transform.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <tuple>

namespace throng {
namespace {

const test::InSubset kGpuInSubsets({test::Subset::kNative},
                                   {"Gpu.BuffersKeepTheirBytes", "Gpu.AnEmptyUploadGivesZeros", "Gpu.BuffersMove"});

using namespace test;

constexpr uint32_t kLayoutSpirv[] = {
#include "io_structs.comp.inc"
};
constexpr uint32_t kCharacterSpirv[] = {
#include "draw/character.frag.inc"
};

// The Failure that `body` throws. The test fails if it throws none.
Error error_of(const std::function<void()>& body) {
    const Result<void> result = as_result(body);
    if (!result) return result.error();
    ADD_FAILURE() << "nothing was refused";
    return {};
}

// ---- Buffers

TEST(Gpu, BuffersKeepTheirBytes) {
    std::vector<uint32_t> values(100'003);
    for (uint32_t i = 0; i < values.size(); ++i) values[i] = i * 2654435761u;
    const Buffer buffer = upload(test_gpu(), "values", values);
    EXPECT_EQ(buffer.size_bytes(), values.size() * 4);
    EXPECT_EQ(download<uint32_t>(test_gpu(), buffer), values);
    EXPECT_EQ(download<uint32_t>(test_gpu(), BufferRange(buffer, 4000, 8)), (std::vector{values[1000], values[1001]}));
    EXPECT_EQ(download<uint32_t>(test_gpu(), BufferRange(buffer, 0, 0)), std::vector<uint32_t>{});
}

TEST(Gpu, AnEmptyUploadGivesZeros) {
    const Buffer buffer = upload(test_gpu(), "nothing", std::vector<uint32_t>{});
    EXPECT_EQ(download<uint32_t>(test_gpu(), buffer), std::vector<uint32_t>(4, 0));
}

TEST(Gpu, BuffersMove) {
    Buffer a = upload(test_gpu(), "a", std::vector<uint32_t>{1, 2, 3, 4}),
           b = upload(test_gpu(), "b", std::vector<uint32_t>{5, 6, 7, 8});
    const VkBuffer handle = a.handle();
    Buffer c = std::move(a);
    EXPECT_EQ(c.handle(), handle);
    EXPECT_FALSE(a.handle());
    c = std::move(b);
    EXPECT_EQ(download<uint32_t>(test_gpu(), c), (std::vector<uint32_t>{5, 6, 7, 8}));
}

TEST(Gpu, AStorageBufferBeyondTheDevicesRangeIsRefused) {
    const uint64_t limit = test_gpu()->properties.limits.maxStorageBufferRange;
    const Error error = error_of(
        [&] { Buffer(test_gpu(), "the keys", limit + 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT); });
    EXPECT_EQ(error.code, ErrorCode::kLimit);
    for (const std::string& part : {std::string("the keys"), std::to_string(limit + 16), std::to_string(limit)})
        EXPECT_TRUE(contains(error.text(), part)) << error.text();
    const uint64_t allocation = test_gpu()->max_allocation_bytes;
    const Error larger = error_of([&] { Buffer(test_gpu(), "a copy", allocation + 16, 0); });
    EXPECT_EQ(larger.code, ErrorCode::kLimit);
    EXPECT_TRUE(contains(larger.text(), std::to_string(allocation))) << larger.text();
}

// ---- Kernels

TEST(Gpu, AWrongDispatchIsRefused) {
    const Kernel kernel = control_kernel(test_gpu());
    EXPECT_EQ(kernel.workgroup_size(), io::kControlWorkgroupSize);
    const Buffer buffer = make_table<uint32_t>(test_gpu(), "test", 64);
    const Bindings bindings = kernel.bind(BufferTable{{io::kPlaybacksBuffer, buffer},
                                                      {io::kTimelineBuffer, buffer},
                                                      {io::kTimesBuffer, buffer},
                                                      {io::kBirthsBuffer, buffer},
                                                      {io::kCursorsBuffer, buffer}});
    const Error push = error_of([&] {
        run_on_gpu([&](VkCommandBuffer commands) { kernel.dispatch_invocations(commands, bindings, uint64_t{0}, 1); });
    });
    EXPECT_EQ(push.code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(contains(push.text(), "control") && contains(push.text(), "16 bytes of push constants, not 8"))
        << push.text();

    const uint32_t limit = test_gpu()->properties.limits.maxComputeWorkGroupCount[0];
    if (limit < UINT32_MAX) {
        const Error count = error_of([&] {
            run_on_gpu([&](VkCommandBuffer commands) {
                kernel.dispatch_workgroups(commands, bindings, io::ControlPush{}, limit + 1);
            });
        });
        EXPECT_EQ(count.code, ErrorCode::kLimit);
        EXPECT_TRUE(contains(count.text(), std::to_string(limit + 1)) && contains(count.text(), std::to_string(limit)))
            << count.text();
    }
    const Error missing = error_of([&] {
        (void)kernel.bind({{io::kPlaybacksBuffer, buffer}, {io::kTimelineBuffer, buffer}});
    });
    EXPECT_EQ(missing.code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(missing.text(), "control: buffer 'times' is missing");
}

TEST(Gpu, TheWorkgroupSizeIsGivenExactlyWhereTheShaderLeavesItOpen) {
    EXPECT_EQ(error_of([] {
                  Kernel(test_gpu(), {.name = "control", .spirv = kernels::control.plain, .workgroup_size = 64});
              }).code,
              ErrorCode::kInvalidArgument);
    const ScanMethod& method = scan_table()[0];
    EXPECT_EQ(
        error_of([&] { Kernel(test_gpu(), {.name = method.name, .spirv = scan_shaders(method.name).plain}); }).code,
        ErrorCode::kInvalidArgument);
}

// `are_for_software`: there tables (gpu/table.glsl) are texel buffers.
std::vector<uint32_t> storage_bindings(const SpirvInfo& info, bool are_for_software = false) {
    std::vector<uint32_t> out;
    for (const BindingInfo& binding : info.bindings) {
        const bool is_table = are_for_software && binding.binding == io::kBirthsBuffer;
        EXPECT_EQ(binding.kind, is_table ? BindingKind::kTexels : BindingKind::kStorage);
        out.push_back(binding.binding);
    }
    return out;
}

TEST(Gpu, SpirvInfoHasWhatAShaderNeeds) {
    const auto expect = [](const char* name, std::span<const uint32_t> spirv, const std::vector<uint32_t>& bindings,
                           size_t push_bytes, uint32_t local_size, bool is_for_software = false) {
        const SpirvInfo info = read_spirv(spirv);
        EXPECT_EQ(storage_bindings(info, is_for_software), bindings) << name;
        EXPECT_EQ(info.push_constant_bytes, push_bytes) << name;
        EXPECT_EQ(info.local_size_is_specialized, local_size == 0) << name;
        if (local_size != 0) {
            EXPECT_EQ(info.local_size_x, local_size) << name;
        }
    };
    expect("control", kernels::control.plain,
           {io::kTimelineBuffer, io::kTimesBuffer, io::kBirthsBuffer, io::kPlaybacksBuffer, io::kCursorsBuffer},
           sizeof(io::ControlPush), io::kControlWorkgroupSize);
    expect("sample", kernels::sample.plain,
           {io::kTracksBuffer, io::kKeysBuffer, io::kWordsBuffer, io::kBirthsBuffer, io::kCursorsBuffer,
            io::kSampledPosesBuffer},
           sizeof(io::SamplePush), io::kSampleWorkgroupSize);
    expect("blend", kernels::blend.plain,
           {io::kSetPosesBuffer, io::kBirthsBuffer, io::kCursorsBuffer, io::kPoseOverridesBuffer, io::kFirstPosesBuffer,
            io::kSecondPosesBuffer, io::kLocalBuffer},
           sizeof(io::BlendPush), io::kBlendWorkgroupSize);
    expect("bind", kernels::bind.plain,
           {io::kPaletteJointsBuffer, io::kJointFromBindBuffer, io::kBirthsBuffer, io::kModelBuffer, io::kSkinBuffer},
           sizeof(io::BindPush), io::kBindWorkgroupSize);
    expect("skin", kernels::skin.plain,
           {io::kVerticesBuffer, io::kInfluencesBuffer, io::kSkinSectionsBuffer, io::kListedVerticesBuffer,
            io::kMorphDeltasBuffer, io::kActiveMorphsBuffer, io::kSkinBuffer, io::kSkinRowsBuffer, io::kSkinnedBuffer,
            io::kVerdictsBuffer, io::kListBuffer},
           sizeof(io::SkinPush), io::kSkinWorkgroupSize);
    for (const ScanMethod& method : scan_table()) {
        const ScanShaders& shaders = scan_shaders(method.name);
        const bench::OnChipShaders& on_chip = bench::on_chip_shaders(method.name);
        for (const auto& [spirv, is_software] : {std::pair{shaders.plain, false},
                                                 {shaders.software, true},
                                                 {on_chip.plain, false},
                                                 {on_chip.software, true}}) {
            const std::vector<uint32_t> bindings = storage_bindings(read_spirv(spirv), is_software),
                                        all{io::kScanLinksBuffer, io::kBirthsBuffer, io::kLocalBuffer, io::kModelBuffer,
                                            io::kScratchBuffer};
            EXPECT_TRUE(std::includes(all.begin(), all.end(), bindings.begin(), bindings.end())) << method.name;
            expect(std::string(method.name).c_str(), spirv, bindings, sizeof(io::ScanPush), 0, is_software);
        }
    }
    EXPECT_EQ(error_of([] { scan_shaders("no such method"); }).code, ErrorCode::kInvalidArgument);
}

TEST(Gpu, SpirvInfoHasSetsAndKinds) {
    using Found = std::tuple<uint32_t, uint32_t, BindingKind>;
    const SpirvInfo info = read_spirv(kCharacterSpirv);
    std::vector<Found> found;
    for (const BindingInfo& binding : info.bindings) found.emplace_back(binding.set, binding.binding, binding.kind);
    std::vector<Found> expected{{1, 0, BindingKind::kImage}, {1, io::kSceneBuffer, BindingKind::kUniform}};
    for (uint32_t texture = 0; texture < 5; ++texture) expected.emplace_back(2, texture, BindingKind::kImage);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(info.push_constant_bytes, sizeof(io::DrawPush));
    const SpirvInfo software = read_spirv(kernels::sample.software);
    const auto keys = std::ranges::find(software.bindings, uint32_t{io::kKeysBuffer}, &BindingInfo::binding);
    ASSERT_NE(keys, software.bindings.end());
    EXPECT_EQ(keys->kind, BindingKind::kTexels);
}

TEST(Gpu, InvalidSpirvIsRefused) {
    EXPECT_EQ(error_of([] { read_spirv({}); }).code, ErrorCode::kInvalidArgument);
    std::vector<uint32_t> words(kernels::control.plain.begin(), kernels::control.plain.end());
    EXPECT_EQ(error_of([&] { read_spirv(std::span(words).first(6)); }).code, ErrorCode::kInvalidArgument)
        << "cut off within its first instruction";
    words[0] ^= 1;
    EXPECT_EQ(error_of([&] { read_spirv(words); }).code, ErrorCode::kInvalidArgument);
    words[0] ^= 1;
    words[5] &= 0xFFFF;  // an instruction of zero words
    EXPECT_EQ(error_of([&] { read_spirv(words); }).code, ErrorCode::kInvalidArgument);
}

// ---- The structs that both sides share

struct Layout {
    size_t size_bytes = 0;
    std::vector<std::pair<std::string, size_t>> members;  // name and offset
};

#define MEMBER(type, member) \
    { #member, offsetof(io::type, member) }

std::map<std::string, Layout> layouts_in_cpp() {
    return {
        {"Affine",
         {sizeof(Affine), {{"row0", 0}, {"row1", sizeof(Affine::row) / 3}, {"row2", sizeof(Affine::row) / 3 * 2}}}},
#include "io_structs.inc"
    };
}

// Names, offsets and array strides of the structs in a SPIR-V module. Enumerants are from the SPIR-V specification,
// version 1.6, section 3.
std::map<std::string, Layout> layouts_in_spirv(std::span<const uint32_t> words) {
    enum : uint32_t {
        kOpName = 5,
        kOpMemberName = 6,
        kOpTypeRuntimeArray = 29,
        kOpDecorate = 71,
        kOpMemberDecorate = 72
    };
    enum : uint32_t { kArrayStride = 6, kOffset = 35 };
    struct Struct {
        std::string name;
        std::map<uint32_t, std::pair<std::string, size_t>> members;
    };
    std::map<uint32_t, Struct> structs;
    std::map<uint32_t, size_t> strides;
    std::map<std::string, Layout> out;
    for (size_t at = 5; at < words.size(); at += words[at] >> 16) {
        const auto arg = words.subspan(at + 1, (words[at] >> 16) - 1);
        const auto text = [&](size_t first) { return std::string(reinterpret_cast<const char*>(&arg[first])); };
        switch (words[at] & 0xFFFF) {
            case kOpName: structs[arg[0]].name = text(1); break;
            case kOpMemberName: structs[arg[0]].members[arg[1]].first = text(2); break;
            case kOpMemberDecorate:
                if (arg[2] == kOffset) structs[arg[0]].members[arg[1]].second = arg[3];
                break;
            case kOpDecorate:
                if (arg[1] == kArrayStride) strides[arg[0]] = arg[2];
                break;
            case kOpTypeRuntimeArray: {
                Layout layout{.size_bytes = strides[arg[0]]};
                for (const auto& [index, member] : structs[arg[1]].members) layout.members.push_back(member);
                out[structs[arg[1]].name] = layout;
                break;
            }
            default: break;
        }
    }
    return out;
}

TEST(Gpu, StructLayoutsMatchInCppAndShaders) {
    const std::map<std::string, Layout> cpp = layouts_in_cpp(), spirv = layouts_in_spirv(kLayoutSpirv);
    for (const auto& [name, layout] : cpp) {
        const auto found = spirv.find(name);
        ASSERT_NE(found, spirv.end()) << name;
        EXPECT_EQ(layout.size_bytes, found->second.size_bytes) << name;
        EXPECT_EQ(layout.members, found->second.members) << name;
    }
    EXPECT_EQ(cpp.size(), spirv.size());
    std::printf("  %zu structs, offsets and sizes equal\n", cpp.size());
}

TEST(Gpu, EveryStructOfTheIoHeadersIsCompared) {
    const std::filesystem::path source = source_file("src");
    THRONG_SKIP_WITHOUT(source);
    const std::map<std::string, Layout> compared = layouts_in_cpp();
    size_t found = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(source)) {
        if (!file.path().filename().string().ends_with("_io.h")) continue;
        const std::string content = read_file(file.path());
        const std::regex declaration("struct (\\w+) \\{");
        for (auto match = std::sregex_iterator(content.begin(), content.end(), declaration);
             match != std::sregex_iterator(); ++match) {
            EXPECT_TRUE(compared.contains((*match)[1]))
                << (*match)[1] << " of " << file.path() << " was not found by io_structs.cmake";
            ++found;
        }
    }
    EXPECT_EQ(found + 1, compared.size()) << "all but Affine come from the io headers";
}

}  // namespace
}  // namespace throng
