#include "draw/pipeline.h"

namespace throng {
namespace {

constexpr uint32_t kCharacterVertex[] = {
#include "draw/character.vert.inc"
};
constexpr uint32_t kCharacterFragment[] = {
#include "draw/character.frag.inc"
};
constexpr uint32_t kShadowFragment[] = {
#include "draw/shadow.frag.inc"
};
constexpr uint32_t kCoveringCharacterFragment[] = {
#include "draw/character_covering.frag.inc"
};
constexpr uint32_t kCoveringShadowFragment[] = {
#include "draw/shadow_covering.frag.inc"
};
constexpr uint32_t kGroundVertex[] = {
#include "draw/ground.vert.inc"
};
constexpr uint32_t kGroundFragment[] = {
#include "draw/ground.frag.inc"
};
constexpr uint32_t kSkeletonVertex[] = {
#include "draw/skeleton.vert.inc"
};
constexpr uint32_t kBoundsVertex[] = {
#include "draw/bounds.vert.inc"
};
constexpr uint32_t kFarthestVertex[] = {
#include "draw/farthest.vert.inc"
};
constexpr uint32_t kFarthestFragment[] = {
#include "draw/farthest.frag.inc"
};
constexpr uint32_t kLineFragment[] = {
#include "draw/line.frag.inc"
};

enum class Depth { kNone, kTested, kAlone, kShadowMap };  // kAlone, kShadowMap: depth is the only output

struct Program {
    std::string_view name;
    std::span<const uint32_t> vertex, fragment;  // without a fragment shader only depth is written
    std::array<uint32_t, 6> vertex_constants{};
    std::array<uint32_t, 4> fragment_constants{};
    Depth depth = Depth::kNone;
    bool has_depth = true;
};

OwnedPipeline make_pipeline(const PipelineSettings& settings, const Program& program) {
    const std::shared_ptr<Gpu>& gpu = settings.gpu;
    const ShaderStage vertex(gpu, {VK_SHADER_STAGE_VERTEX_BIT, program.vertex}, program.vertex_constants);
    std::optional<ShaderStage> fragment;
    std::vector stages{vertex.info()};
    if (!program.fragment.empty()) {
        fragment.emplace(gpu, ShaderCode{VK_SHADER_STAGE_FRAGMENT_BIT, program.fragment}, program.fragment_constants);
        stages.push_back(fragment->info());
    }
    const bool is_shadow_map = program.depth == Depth::kShadowMap,
               depth_alone = is_shadow_map || program.depth == Depth::kAlone;

    // Vertices are fetched by the shader.
    const VkPipelineVertexInputStateCreateInfo vertex_input{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo assembly{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE,
        // Moves surfaces that the sun grazes farther from it, so that they do not shadow themselves between texels.
        .depthBiasEnable = is_shadow_map,
        .depthBiasSlopeFactor = -1.5f,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo multisample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = is_shadow_map ? VK_SAMPLE_COUNT_1_BIT : settings.samples};
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = program.depth != Depth::kNone,
        .depthWriteEnable = program.depth != Depth::kNone,
        .depthCompareOp = VK_COMPARE_OP_GREATER};  // reversed depth
    const VkPipelineColorBlendAttachmentState attachment{
        .colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                          VK_COLOR_COMPONENT_A_BIT};
    const VkPipelineColorBlendStateCreateInfo blend{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                    .attachmentCount = depth_alone ? 0u : 1u,
                                                    .pAttachments = &attachment};
    constexpr std::array kDynamic{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR, VK_DYNAMIC_STATE_CULL_MODE};
    const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                   .dynamicStateCount = kDynamic.size(),
                                                   .pDynamicStates = kDynamic.data()};
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .colorAttachmentCount = blend.attachmentCount,
        .pColorAttachmentFormats = &settings.color_format,
        .depthAttachmentFormat = program.has_depth ? kDepthFormat : VK_FORMAT_UNDEFINED};
    OwnedPipeline pipeline{
        gpu, gpu->make_pipeline(VkGraphicsPipelineCreateInfo{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                                             .pNext = &rendering,
                                                             .stageCount = static_cast<uint32_t>(stages.size()),
                                                             .pStages = stages.data(),
                                                             .pVertexInputState = &vertex_input,
                                                             .pInputAssemblyState = &assembly,
                                                             .pViewportState = &viewport,
                                                             .pRasterizationState = &rasterization,
                                                             .pMultisampleState = &multisample,
                                                             .pDepthStencilState = &depth,
                                                             .pColorBlendState = &blend,
                                                             .pDynamicState = &dynamic,
                                                             .layout = settings.layout})};
    if (gpu->on_pipeline) gpu->on_pipeline({program.name, 0, pipeline.get()});
    return pipeline;
}

ShaderLayout make_layout(const std::shared_ptr<Gpu>& gpu,
                         std::initializer_list<std::span<const uint32_t>> vertex_shaders,
                         std::initializer_list<std::span<const uint32_t>> fragment_shaders) {
    std::vector<ShaderCode> shaders;
    for (const auto spirv : vertex_shaders) shaders.push_back({VK_SHADER_STAGE_VERTEX_BIT, spirv});
    for (const auto spirv : fragment_shaders) shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, spirv});
    return ShaderLayout(gpu, shaders);
}

}  // namespace

ShaderLayout make_draw_layout(const std::shared_ptr<Gpu>& gpu) {
    ShaderLayout layout = make_layout(gpu, {kCharacterVertex, kGroundVertex, kSkeletonVertex, kBoundsVertex},
                                      {kCharacterFragment, kCoveringCharacterFragment, kShadowFragment,
                                       kCoveringShadowFragment, kGroundFragment, kLineFragment});
    check_storage_buffers(*gpu, "drawing", layout.set(kBatchSet).bindings);
    return layout;
}

ShaderLayout make_farthest_layout(const std::shared_ptr<Gpu>& gpu) {
    return make_layout(gpu, {kFarthestVertex}, {kFarthestFragment});
}

OwnedPipeline make_ground_pipeline(const PipelineSettings& settings) {
    return make_pipeline(settings, {.name = "draw ground", .vertex = kGroundVertex, .fragment = kGroundFragment});
}

OwnedPipeline make_farthest_pipeline(const std::shared_ptr<Gpu>& gpu, const ShaderLayout& layout) {
    return make_pipeline(
        {gpu, layout.get(), VK_SAMPLE_COUNT_1_BIT, kFarthestFormat},
        {.name = "draw farthest", .vertex = kFarthestVertex, .fragment = kFarthestFragment, .has_depth = false});
}

CharacterPipelines::CharacterPipelines(const PipelineSettings& settings, const CharacterKind& kind) {
    const auto make = [&](std::string_view name, std::span<const uint32_t> fragment, Depth depth, bool discards = false,
                          bool has_maps = false) {
        const uint32_t samples = depth == Depth::kShadowMap ? 1u : static_cast<uint32_t>(settings.samples);
        return make_pipeline(
            settings, {.name = name,
                       .vertex = kCharacterVertex,
                       .fragment = fragment,
                       .vertex_constants = {depth == Depth::kShadowMap, static_cast<uint32_t>(kind.format), kind.listed,
                                            static_cast<uint32_t>(kind.blend), kind.skinned, kind.has_looks},
                       .fragment_constants = {discards, has_maps, samples, depth == Depth::kShadowMap},
                       .depth = depth});
    };
    struct ModePrograms {
        std::string_view shadow_name, occluder_name;
        std::span<const uint32_t> depths, picture;
    };
    const std::array<ModePrograms, 3> modes{
        ModePrograms{"draw shadow", "draw occluders", {}, kCharacterFragment},
        ModePrograms{"draw shadow, masked", "draw occluders, masked", kShadowFragment, kCharacterFragment},
        ModePrograms{"draw shadow, blended", "draw occluders, blended", kCoveringShadowFragment,
                     kCoveringCharacterFragment}};
    for (size_t mode = 0; mode < modes.size(); ++mode) {
        if (mode == static_cast<size_t>(AlphaMode::kBlend) && !kind.has_blends) continue;
        const ModePrograms& programs = modes[mode];
        shadow[mode] = make(programs.shadow_name, programs.depths, Depth::kShadowMap);
        occluder[mode] = make(programs.occluder_name, programs.depths, Depth::kAlone);
        for (const bool has_maps : {false, true})
            into_picture[mode][has_maps] = make(has_maps ? "draw picture, maps" : "draw picture", programs.picture,
                                                Depth::kTested, mode != static_cast<size_t>(AlphaMode::kOpaque),
                                                has_maps);
    }
}

LinePipelines::LinePipelines(const PipelineSettings& settings, bool listed) {
    const auto make = [&](std::string_view name, std::span<const uint32_t> vertex, Depth depth) {
        return make_pipeline(
            settings,
            {.name = name, .vertex = vertex, .fragment = kLineFragment, .vertex_constants = {listed}, .depth = depth});
    };
    skeletons = make("draw skeletons", kSkeletonVertex, Depth::kNone);
    bounds = make("draw bounds", kBoundsVertex, Depth::kTested);
}

}  // namespace throng
