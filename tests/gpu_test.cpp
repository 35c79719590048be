// Buffers, kernels, SPIR-V, and the structs that C++ and the shaders share.
#include "base/failure.h"
#include "bind/bind_io.h"
#include "fused/fused_io.h"
#include "blend/blend_io.h"
#include "bind/sockets_io.h"
#include "blend/inertia_io.h"
#include "blend/layered_io.h"
#include "blend/posed_io.h"
#include "control/controller_io.h"
#include "control/control.h"
#include "cull/cull_io.h"
#include "pace/pace_io.h"
#include "draw/draw_io.h"
#include "morph/morph_io.h"
#include "procedural/procedural_io.h"
#include "sample/sample_io.h"
#include "scan/scan.h"
#include "scan/scan_shaders.h"
#include "skin/skin_io.h"
#include "tests/files.h"
#include "steer/steer_io.h"
#include "tests/kernel_runner.h"
#include "tests/text.h"

#include <throng/transform.h>

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>

namespace throng {
namespace {

using namespace test;

constexpr uint32_t kLayoutSpirv[] = {
#include "layout.comp.inc"
};
constexpr uint32_t kControlSpirv[] = {
#include "control/control.comp.inc"
};
constexpr uint32_t kSampleSpirv[] = {
#include "sample/sample.comp.inc"
};
constexpr uint32_t kBlendSpirv[] = {
#include "blend/blend.comp.inc"
};
constexpr uint32_t kBindSpirv[] = {
#include "bind/bind.comp.inc"
};
constexpr uint32_t kSkinSpirv[] = {
#include "skin/skin.comp.inc"
};

// The Failure that `body` throws; the test fails where it throws none.
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
    EXPECT_EQ(download<uint32_t>(test_gpu(), BufferRange(buffer.handle(), 4000, 8)),
              (std::vector{values[1000], values[1001]}));
    EXPECT_EQ(download<uint32_t>(test_gpu(), BufferRange(buffer.handle(), 0, 0)), std::vector<uint32_t>{});
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

TEST(Gpu, AStorageBufferBeyondTheDevicesRangeIsRefusedWithBothNumbers) {
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
                                                      {io::kCursorsBuffer, buffer}});
    const Error push = error_of([&] {
        run_on_gpu([&](VkCommandBuffer commands) { kernel.dispatch_invocations(commands, bindings, uint64_t{0}, 1); });
    });
    EXPECT_EQ(push.code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(contains(push.text(), "control") && contains(push.text(), "12 bytes, not 8")) << push.text();

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
    EXPECT_EQ(missing.text(), "control: there is no buffer of times");
}

TEST(Gpu, TheWorkgroupSizeIsGivenExactlyWhereTheShaderLeavesItOpen) {
    EXPECT_EQ(
        error_of([] { Kernel(test_gpu(), {.name = "control", .spirv = kControlSpirv, .workgroup_size = 64}); }).code,
        ErrorCode::kInvalidArgument);
    const ScanMethod& method = scan_table()[0];
    EXPECT_EQ(
        error_of([&] { Kernel(test_gpu(), {.name = method.name, .spirv = scan_shaders(method.name).plain}); }).code,
        ErrorCode::kInvalidArgument);
}

std::vector<uint32_t> storage_bindings(const SpirvInfo& info) {
    std::vector<uint32_t> out;
    for (const BindingInfo& binding : info.bindings) {
        EXPECT_EQ(binding.kind, BindingKind::kStorage);
        out.push_back(binding.binding);
    }
    return out;
}

TEST(Gpu, SpirvTellsWhatAShaderNeeds) {
    const auto expect = [](const char* name, std::span<const uint32_t> spirv, const std::vector<uint32_t>& bindings,
                           size_t push_bytes, uint32_t local_size) {
        const SpirvInfo info = read_spirv(spirv);
        EXPECT_EQ(storage_bindings(info), bindings) << name;
        EXPECT_EQ(info.push_constant_bytes, push_bytes) << name;
        EXPECT_EQ(info.local_size_is_specialized, local_size == 0) << name;
        if (local_size != 0) {
            EXPECT_EQ(info.local_size_x, local_size) << name;
        }
    };
    expect("control", kControlSpirv, {io::kTimelineBuffer, io::kTimesBuffer, io::kPlaybacksBuffer, io::kCursorsBuffer},
           sizeof(io::ControlPush), io::kControlWorkgroupSize);
    expect("sample", kSampleSpirv,
           {io::kTracksBuffer, io::kKeysBuffer, io::kWordsBuffer, io::kCursorsBuffer, io::kSampledPosesBuffer},
           sizeof(io::SamplePush), io::kSampleWorkgroupSize);
    expect("blend", kBlendSpirv,
           {io::kSetPosesBuffer, io::kCursorsBuffer, io::kPosedBuffer, io::kFirstPosesBuffer, io::kSecondPosesBuffer,
            io::kLocalBuffer},
           sizeof(io::BlendPush), io::kBlendWorkgroupSize);
    expect("bind", kBindSpirv, {io::kPaletteJointsBuffer, io::kJointFromBindBuffer, io::kModelBuffer, io::kSkinBuffer},
           sizeof(io::BindPush), io::kBindWorkgroupSize);
    expect("skin", kSkinSpirv,
           {io::kVerticesBuffer, io::kInfluencesBuffer, io::kSkinSectionsBuffer, io::kListedVerticesBuffer,
            io::kMorphDeltasBuffer, io::kActiveMorphsBuffer, io::kSkinBuffer, io::kSkinnedBuffer, io::kVerdictsBuffer,
            io::kListBuffer},
           sizeof(io::SkinPush), io::kSkinWorkgroupSize);
    for (const ScanMethod& method : scan_table()) {
        const ScanShaders& shaders = scan_shaders(method.name);
        for (const auto& spirv : {shaders.plain, shaders.wide, shaders.on_chip, shaders.on_chip_wide}) {
            const std::vector<uint32_t> bindings = storage_bindings(read_spirv(spirv)),
                                        all{io::kScanLinksBuffer, io::kLocalBuffer, io::kModelBuffer,
                                            io::kScratchBuffer};
            EXPECT_TRUE(std::includes(all.begin(), all.end(), bindings.begin(), bindings.end())) << method.name;
            expect(std::string(method.name).c_str(), spirv, bindings, sizeof(io::ScanPush), 0);
        }
    }
    EXPECT_EQ(error_of([] { scan_shaders("no such method"); }).code, ErrorCode::kInvalidArgument);
}

TEST(Gpu, WhatIsNoSpirvIsRefused) {
    EXPECT_EQ(error_of([] { read_spirv({}); }).code, ErrorCode::kInvalidArgument);
    std::vector<uint32_t> words(std::begin(kControlSpirv), std::end(kControlSpirv));
    EXPECT_EQ(error_of([&] { read_spirv(std::span(words).first(6)); }).code, ErrorCode::kInvalidArgument)
        << "cut off within its first instruction";
    words[0] ^= 1;
    EXPECT_EQ(error_of([&] { read_spirv(words); }).code, ErrorCode::kInvalidArgument);
    words[0] ^= 1;
    words[5] &= 0xFFFF;  // an instruction of no words
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
        {"SlotPlayback",
         {sizeof(io::SlotPlayback),
          {MEMBER(SlotPlayback, clip), MEMBER(SlotPlayback, loop), MEMBER(SlotPlayback, time_s),
           MEMBER(SlotPlayback, speed)}}},
        {"InstancePlayback",
         {sizeof(io::InstancePlayback),
          {MEMBER(InstancePlayback, first), MEMBER(InstancePlayback, second), MEMBER(InstancePlayback, weight)}}},
        {"ClipAxis",
         {sizeof(io::ClipAxis),
          {MEMBER(ClipAxis, first_time), MEMBER(ClipAxis, row_count), MEMBER(ClipAxis, row_stride),
           MEMBER(ClipAxis, first_row), MEMBER(ClipAxis, duration_s)}}},
        {"SlotCursor",
         {sizeof(io::SlotCursor),
          {MEMBER(SlotCursor, first_track), MEMBER(SlotCursor, earlier), MEMBER(SlotCursor, later),
           MEMBER(SlotCursor, fraction)}}},
        {"InstanceCursor",
         {sizeof(io::InstanceCursor),
          {MEMBER(InstanceCursor, first), MEMBER(InstanceCursor, second), MEMBER(InstanceCursor, weight)}}},
        {"ControlPush",
         {sizeof(io::ControlPush),
          {MEMBER(ControlPush, instance_count), MEMBER(ControlPush, joint_count), MEMBER(ControlPush, time_step_s)}}},
        {"JointPose",
         {sizeof(io::JointPose),
          {MEMBER(JointPose, rotation), MEMBER(JointPose, translation), MEMBER(JointPose, scale)}}},
        {"SamplePush", {sizeof(io::SamplePush), {MEMBER(SamplePush, joint_count), MEMBER(SamplePush, slot)}}},
        {"BlendPush", {sizeof(io::BlendPush), {MEMBER(BlendPush, joint_count)}}},
        {"LayeredPush",
         {sizeof(io::LayeredPush), {MEMBER(LayeredPush, joint_count), MEMBER(LayeredPush, voice_limit)}}},
        {"InertiaJoint",
         {sizeof(io::InertiaJoint),
          {MEMBER(InertiaJoint, rotation), MEMBER(InertiaJoint, translation), MEMBER(InertiaJoint, scale)}}},
        {"ScanPush",
         {sizeof(io::ScanPush),
          {MEMBER(ScanPush, joint_count), MEMBER(ScanPush, instance_count), MEMBER(ScanPush, repeat_count)}}},
        {"FusedPush",
         {sizeof(io::FusedPush),
          {MEMBER(FusedPush, joint_count), MEMBER(FusedPush, rig_joint_count), MEMBER(FusedPush, instance_count),
           MEMBER(FusedPush, palette_count), MEMBER(FusedPush, rest_track), MEMBER(FusedPush, voice_limit),
           MEMBER(FusedPush, section)}}},
        {"BindPush", {sizeof(io::BindPush), {MEMBER(BindPush, joint_count), MEMBER(BindPush, palette_count)}}},
        {"VertexRows",
         {sizeof(io::VertexRows), {MEMBER(VertexRows, position_normal), MEMBER(VertexRows, texcoord_color_delta)}}},
        {"SkinSection",
         {sizeof(io::SkinSection),
          {MEMBER(SkinSection, first_vertex), MEMBER(SkinSection, first_influences),
           MEMBER(SkinSection, influence_sets), MEMBER(SkinSection, first_morph), MEMBER(SkinSection, morph_count),
           MEMBER(SkinSection, first_listed), MEMBER(SkinSection, listed_count), MEMBER(SkinSection, unused)}}},
        {"SkinPush",
         {sizeof(io::SkinPush),
          {MEMBER(SkinPush, section_count), MEMBER(SkinPush, vertex_count), MEMBER(SkinPush, palette_count),
           MEMBER(SkinPush, first_instance), MEMBER(SkinPush, influence_offset), MEMBER(SkinPush, only_animated)}}},
        {"DrawScene",
         {sizeof(io::DrawScene),
          {MEMBER(DrawScene, clip_from_world), MEMBER(DrawScene, map_from_world), MEMBER(DrawScene, eye),
           MEMBER(DrawScene, forward), MEMBER(DrawScene, right), MEMBER(DrawScene, down), MEMBER(DrawScene, to_sun),
           MEMBER(DrawScene, ground), MEMBER(DrawScene, fog), MEMBER(DrawScene, picture), MEMBER(DrawScene, shadow),
           MEMBER(DrawScene, sun_light), MEMBER(DrawScene, sky_light), MEMBER(DrawScene, bounce_light),
           MEMBER(DrawScene, horizon), MEMBER(DrawScene, zenith), MEMBER(DrawScene, ground_albedo)}}},
        {"DrawPush",
         {sizeof(io::DrawPush),
          {MEMBER(DrawPush, first_vertex), MEMBER(DrawPush, first_influences), MEMBER(DrawPush, influence_sets),
           MEMBER(DrawPush, palette_count), MEMBER(DrawPush, base_color), MEMBER(DrawPush, emissive),
           MEMBER(DrawPush, alpha_cutoff), MEMBER(DrawPush, double_sided), MEMBER(DrawPush, first_morph),
           MEMBER(DrawPush, morph_count), MEMBER(DrawPush, detail), MEMBER(DrawPush, metallic),
           MEMBER(DrawPush, roughness), MEMBER(DrawPush, normal_scale), MEMBER(DrawPush, vertex_count)}}},
        {"LinePush",
         {sizeof(io::LinePush),
          {MEMBER(LinePush, box_centre), MEMBER(LinePush, box_half_extent), MEMBER(LinePush, joint_count),
           MEMBER(LinePush, level_count), MEMBER(LinePush, instance_count), MEMBER(LinePush, unused0)}}},
        {"CullView",
         {sizeof(io::CullView),
          {MEMBER(CullView, planes), MEMBER(CullView, clip_from_world), MEMBER(CullView, eye), MEMBER(CullView, shadow),
           MEMBER(CullView, update_number), MEMBER(CullView, occlusion), MEMBER(CullView, ground),
           MEMBER(CullView, unused)}}},
        {"CullPush",
         {sizeof(io::CullPush),
          {MEMBER(CullPush, centre), MEMBER(CullPush, half_extent), MEMBER(CullPush, detail_errors),
           MEMBER(CullPush, instance_count), MEMBER(CullPush, detail_count), MEMBER(CullPush, joint_set_count),
           MEMBER(CullPush, keeps_previous), MEMBER(CullPush, may_skip), MEMBER(CullPush, unused0),
           MEMBER(CullPush, unused1), MEMBER(CullPush, unused2)}}},
        {"RevealPush",
         {sizeof(io::RevealPush),
          {MEMBER(RevealPush, cull), MEMBER(RevealPush, width), MEMBER(RevealPush, height), MEMBER(RevealPush, sign),
           MEMBER(RevealPush, unused)}}},
        {"PyramidPush",
         {sizeof(io::PyramidPush),
          {MEMBER(PyramidPush, width), MEMBER(PyramidPush, height), MEMBER(PyramidPush, first_read),
           MEMBER(PyramidPush, first_written), MEMBER(PyramidPush, sign)}}},
        {"AgentPlace",
         {sizeof(io::AgentPlace),
          {MEMBER(AgentPlace, x), MEMBER(AgentPlace, z), MEMBER(AgentPlace, radius), MEMBER(AgentPlace, next)}}},
        {"AgentState",
         {sizeof(io::AgentState),
          {MEMBER(AgentState, speed), MEMBER(AgentState, patience), MEMBER(AgentState, stands)}}},
        {"PlacesPush",
         {sizeof(io::PlacesPush),
          {MEMBER(PlacesPush, instance_count), MEMBER(PlacesPush, first_agent), MEMBER(PlacesPush, radius),
           MEMBER(PlacesPush, inverse_cell), MEMBER(PlacesPush, bucket_mask)}}},
        {"SteerPush",
         {sizeof(io::SteerPush),
          {MEMBER(SteerPush, instance_count), MEMBER(SteerPush, first_agent), MEMBER(SteerPush, inverse_cell),
           MEMBER(SteerPush, bucket_mask), MEMBER(SteerPush, speed), MEMBER(SteerPush, turn_cos),
           MEMBER(SteerPush, turn_sin), MEMBER(SteerPush, time_step_s), MEMBER(SteerPush, is_carried),
           MEMBER(SteerPush, parameter_count), MEMBER(SteerPush, speed_parameter)}}},
        {"PacePush",
         {sizeof(io::PacePush),
          {MEMBER(PacePush, section), MEMBER(PacePush, palette_count), MEMBER(PacePush, unused0),
           MEMBER(PacePush, unused1), MEMBER(PacePush, entry_counts)}}},
        {"OffsetsPush",
         {sizeof(io::OffsetsPush),
          {MEMBER(OffsetsPush, workgroup_count), MEMBER(OffsetsPush, section_count), MEMBER(OffsetsPush, unused0),
           MEMBER(OffsetsPush, unused1), MEMBER(OffsetsPush, instances_of_workgroup)}}},
        {"DrawCommand",
         {sizeof(io::DrawCommand),
          {MEMBER(DrawCommand, index_count), MEMBER(DrawCommand, instance_count), MEMBER(DrawCommand, first_index),
           MEMBER(DrawCommand, vertex_offset), MEMBER(DrawCommand, first_instance)}}},
        {"ControlClip",
         {sizeof(io::ControlClip),
          {MEMBER(ControlClip, rate), MEMBER(ControlClip, first_event), MEMBER(ControlClip, event_count),
           MEMBER(ControlClip, first_root), MEMBER(ControlClip, root_count)}}},
        {"ControlLayer",
         {sizeof(io::ControlLayer),
          {MEMBER(ControlLayer, first_state), MEMBER(ControlLayer, state_count), MEMBER(ControlLayer, mode),
           MEMBER(ControlLayer, mask), MEMBER(ControlLayer, weight), MEMBER(ControlLayer, weight_parameter),
           MEMBER(ControlLayer, model_rotations)}}},
        {"ControlState",
         {sizeof(io::ControlState),
          {MEMBER(ControlState, first_point), MEMBER(ControlState, point_count), MEMBER(ControlState, first_triangle),
           MEMBER(ControlState, triangle_count), MEMBER(ControlState, first_edge), MEMBER(ControlState, edge_count),
           MEMBER(ControlState, x_parameter), MEMBER(ControlState, y_parameter), MEMBER(ControlState, speed_parameter),
           MEMBER(ControlState, speed), MEMBER(ControlState, loop), MEMBER(ControlState, sync),
           MEMBER(ControlState, first_transition), MEMBER(ControlState, transition_count)}}},
        {"ControlPoint",
         {sizeof(io::ControlPoint),
          {MEMBER(ControlPoint, clip), MEMBER(ControlPoint, x), MEMBER(ControlPoint, y),
           MEMBER(ControlPoint, inverse_span)}}},
        {"ControlTriangle",
         {sizeof(io::ControlTriangle),
          {MEMBER(ControlTriangle, a), MEMBER(ControlTriangle, b), MEMBER(ControlTriangle, c),
           MEMBER(ControlTriangle, ax), MEMBER(ControlTriangle, ay), MEMBER(ControlTriangle, a0),
           MEMBER(ControlTriangle, bx), MEMBER(ControlTriangle, by), MEMBER(ControlTriangle, b0)}}},
        {"ControlEdge",
         {sizeof(io::ControlEdge),
          {MEMBER(ControlEdge, a), MEMBER(ControlEdge, b), MEMBER(ControlEdge, dx), MEMBER(ControlEdge, dy)}}},
        {"ControlTransition",
         {sizeof(io::ControlTransition),
          {MEMBER(ControlTransition, to), MEMBER(ControlTransition, first_condition),
           MEMBER(ControlTransition, condition_count), MEMBER(ControlTransition, exit_loops),
           MEMBER(ControlTransition, exit_phase), MEMBER(ControlTransition, fade_rate),
           MEMBER(ControlTransition, flags)}}},
        {"ControlCondition",
         {sizeof(io::ControlCondition),
          {MEMBER(ControlCondition, parameter), MEMBER(ControlCondition, test), MEMBER(ControlCondition, value)}}},
        {"ControlEvent", {sizeof(io::ControlEvent), {MEMBER(ControlEvent, phase), MEMBER(ControlEvent, event)}}},
        {"ControllerLayout",
         {sizeof(io::ControllerLayout),
          {MEMBER(ControllerLayout, clips), MEMBER(ControllerLayout, layers), MEMBER(ControllerLayout, states),
           MEMBER(ControllerLayout, points), MEMBER(ControllerLayout, triangles), MEMBER(ControllerLayout, edges),
           MEMBER(ControllerLayout, transitions), MEMBER(ControllerLayout, conditions),
           MEMBER(ControllerLayout, events), MEMBER(ControllerLayout, layer_count),
           MEMBER(ControllerLayout, parameter_count), MEMBER(ControllerLayout, clip_count)}}},
        {"LayerPlay",
         {sizeof(io::LayerPlay),
          {MEMBER(LayerPlay, motion), MEMBER(LayerPlay, phase), MEMBER(LayerPlay, loops), MEMBER(LayerPlay, fade),
           MEMBER(LayerPlay, fade_rate), MEMBER(LayerPlay, speed), MEMBER(LayerPlay, loop)}}},
        {"LayerState",
         {sizeof(io::LayerState),
          {MEMBER(LayerState, plays), MEMBER(LayerState, play_count), MEMBER(LayerState, weight),
           MEMBER(LayerState, weight_goal), MEMBER(LayerState, weight_rate), MEMBER(LayerState, mode),
           MEMBER(LayerState, mask), MEMBER(LayerState, taken), MEMBER(LayerState, inertial_rate)}}},
        {"Voice",
         {sizeof(io::Voice),
          {MEMBER(Voice, first_track), MEMBER(Voice, earlier), MEMBER(Voice, later), MEMBER(Voice, fraction),
           MEMBER(Voice, weight), MEMBER(Voice, layer_weight), MEMBER(Voice, reference_row), MEMBER(Voice, flags)}}},
        {"InstanceInertia",
         {sizeof(io::InstanceInertia),
          {MEMBER(InstanceInertia, elapsed_s), MEMBER(InstanceInertia, duration_s),
           MEMBER(InstanceInertia, shown_step_s), MEMBER(InstanceInertia, shown_count), MEMBER(InstanceInertia, begins),
           MEMBER(InstanceInertia, time_step_s)}}},
        {"ActiveMorph", {sizeof(io::ActiveMorph), {MEMBER(ActiveMorph, morph), MEMBER(ActiveMorph, weight)}}},
        {"MorphPush",
         {sizeof(io::MorphPush),
          {MEMBER(MorphPush, instance_count), MEMBER(MorphPush, morph_count), MEMBER(MorphPush, joint_count),
           MEMBER(MorphPush, voice_limit)}}},
        {"RootState",
         {sizeof(io::RootState), {MEMBER(RootState, move), MEMBER(RootState, place), MEMBER(RootState, base)}}},
        {"EventHead",
         {sizeof(io::EventHead),
          {MEMBER(EventHead, count), MEMBER(EventHead, unused0), MEMBER(EventHead, unused1),
           MEMBER(EventHead, unused2)}}},
        {"EventRecord",
         {sizeof(io::EventRecord),
          {MEMBER(EventRecord, instance), MEMBER(EventRecord, event), MEMBER(EventRecord, layer),
           MEMBER(EventRecord, time_s)}}},
        {"ControlCommand",
         {sizeof(io::ControlCommand),
          {MEMBER(ControlCommand, instance), MEMBER(ControlCommand, kind), MEMBER(ControlCommand, target),
           MEMBER(ControlCommand, motion), MEMBER(ControlCommand, phase), MEMBER(ControlCommand, loop),
           MEMBER(ControlCommand, value), MEMBER(ControlCommand, fade_rate)}}},
        {"ControllerPush",
         {sizeof(io::ControllerPush),
          {MEMBER(ControllerPush, instance_count), MEMBER(ControllerPush, first_instance),
           MEMBER(ControllerPush, joint_count), MEMBER(ControllerPush, voice_limit),
           MEMBER(ControllerPush, event_capacity), MEMBER(ControllerPush, time_step_s),
           MEMBER(ControllerPush, flags)}}},
        {"CommandPush",
         {sizeof(io::CommandPush),
          {MEMBER(CommandPush, command_count), MEMBER(CommandPush, layer_count),
           MEMBER(CommandPush, parameter_count)}}},
        {"InertiaState",
         {sizeof(io::InertiaState),
          {MEMBER(InertiaState, shown), MEMBER(InertiaState, shown_before), MEMBER(InertiaState, offset)}}},
        {"SocketPush",
         {sizeof(io::SocketPush),
          {MEMBER(SocketPush, instance_count), MEMBER(SocketPush, joint_count), MEMBER(SocketPush, socket_count),
           MEMBER(SocketPush, flags)}}},
        {"ProceduralChain",
         {sizeof(io::ProceduralChain),
          {MEMBER(ProceduralChain, rule), MEMBER(ProceduralChain, first_joint), MEMBER(ProceduralChain, joint_count),
           MEMBER(ProceduralChain, first_generation), MEMBER(ProceduralChain, first_spring)}}},
        {"ProceduralJoint",
         {sizeof(io::ProceduralJoint),
          {MEMBER(ProceduralJoint, joint), MEMBER(ProceduralJoint, bone_x), MEMBER(ProceduralJoint, bone_y),
           MEMBER(ProceduralJoint, bone_z)}}},
        {"WindSettings",
         {sizeof(io::WindSettings),
          {MEMBER(WindSettings, bend_rad), MEMBER(WindSettings, sway_rad), MEMBER(WindSettings, sway_hz)}}},
        {"SpringSettings",
         {sizeof(io::SpringSettings),
          {MEMBER(SpringSettings, stiffness), MEMBER(SpringSettings, damping), MEMBER(SpringSettings, gravity_x),
           MEMBER(SpringSettings, gravity_y), MEMBER(SpringSettings, gravity_z), MEMBER(SpringSettings, drag),
           MEMBER(SpringSettings, radius), MEMBER(SpringSettings, first_collider),
           MEMBER(SpringSettings, collider_count)}}},
        {"ColliderShape",
         {sizeof(io::ColliderShape),
          {MEMBER(ColliderShape, joint), MEMBER(ColliderShape, ax), MEMBER(ColliderShape, ay),
           MEMBER(ColliderShape, az), MEMBER(ColliderShape, bx), MEMBER(ColliderShape, by), MEMBER(ColliderShape, bz),
           MEMBER(ColliderShape, radius)}}},
        {"LookAtSettings",
         {sizeof(io::LookAtSettings),
          {MEMBER(LookAtSettings, forward_x), MEMBER(LookAtSettings, forward_y), MEMBER(LookAtSettings, forward_z),
           MEMBER(LookAtSettings, limit_rad), MEMBER(LookAtSettings, weight), MEMBER(LookAtSettings, target)}}},
        {"ReachSettings",
         {sizeof(io::ReachSettings),
          {MEMBER(ReachSettings, pole_x), MEMBER(ReachSettings, pole_y), MEMBER(ReachSettings, pole_z),
           MEMBER(ReachSettings, weight), MEMBER(ReachSettings, target)}}},
        {"SpringState",
         {sizeof(io::SpringState),
          {MEMBER(SpringState, place), MEMBER(SpringState, velocity), MEMBER(SpringState, origin)}}},
        {"ProceduralPush",
         {sizeof(io::ProceduralPush),
          {MEMBER(ProceduralPush, instance_count), MEMBER(ProceduralPush, first_instance),
           MEMBER(ProceduralPush, joint_count), MEMBER(ProceduralPush, spring_count),
           MEMBER(ProceduralPush, target_count), MEMBER(ProceduralPush, first_chain),
           MEMBER(ProceduralPush, workgroups), MEMBER(ProceduralPush, time_step_s), MEMBER(ProceduralPush, sway_time_s),
           MEMBER(ProceduralPush, wind_speed), MEMBER(ProceduralPush, wind_x), MEMBER(ProceduralPush, wind_y),
           MEMBER(ProceduralPush, wind_z), MEMBER(ProceduralPush, gust), MEMBER(ProceduralPush, gust_rate),
           MEMBER(ProceduralPush, gust_phase0), MEMBER(ProceduralPush, gust_phase1),
           MEMBER(ProceduralPush, gust_phase2)}}},
        {"InstancePose", {sizeof(io::InstancePose), {MEMBER(InstancePose, slot), MEMBER(InstancePose, weight)}}},
        {"LayeredInOrderPush",
         {sizeof(io::LayeredInOrderPush),
          {MEMBER(LayeredInOrderPush, instance_count), MEMBER(LayeredInOrderPush, joint_count),
           MEMBER(LayeredInOrderPush, voice_limit), MEMBER(LayeredInOrderPush, first_joint),
           MEMBER(LayeredInOrderPush, joint_end)}}},
        {"ModelRotations",
         {sizeof(io::ModelRotations),
          {MEMBER(ModelRotations, below), MEMBER(ModelRotations, layer), MEMBER(ModelRotations, blended)}}},
        {"Affine",
         {sizeof(Affine), {{"row0", 0}, {"row1", sizeof(Affine::row) / 3}, {"row2", sizeof(Affine::row) / 3 * 2}}}},
    };
}

// Names, offsets and array strides of a module's structs. Numbers from the SPIR-V specification, version 1.6,
// section 3.
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

TEST(Gpu, StructsLieAlikeInCppAndInTheShaders) {
    const std::map<std::string, Layout> cpp = layouts_in_cpp(), spirv = layouts_in_spirv(kLayoutSpirv);
    for (const auto& [name, layout] : cpp) {
        const auto found = spirv.find(name);
        ASSERT_NE(found, spirv.end()) << name << " is missing in tests/layout.comp";
        EXPECT_EQ(layout.size_bytes, found->second.size_bytes) << name;
        EXPECT_EQ(layout.members, found->second.members) << name;
    }
    EXPECT_EQ(cpp.size(), spirv.size());
    std::printf("  %zu structs, offsets and sizes equal\n", cpp.size());
}

TEST(Gpu, EveryStructOfTheIoHeadersIsCompared) {
    const std::filesystem::path source = THRONG_SOURCE_DIR "/src";
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
                << (*match)[1] << " of " << file.path() << " is missing in gpu_test.cpp and layout.comp";
            ++found;
        }
    }
    EXPECT_EQ(found + 1, compared.size()) << "all but Affine come from the io headers";
}

}  // namespace
}  // namespace throng
