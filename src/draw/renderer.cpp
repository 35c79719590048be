#include <throng/draw.h>

#include "base/failure.h"
#include "crowd/crowd_state.h"
#include "draw/camera.h"
#include "draw/draw_io.h"
#include "draw/materials.h"
#include "draw/pipeline.h"
#include "gpu/buffer.h"

#include <algorithm>

namespace throng {
namespace {

constexpr Access kColorWrite{VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
constexpr Access kDepthAccess{VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr Access kDrawRead{VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                           VK_ACCESS_2_INDEX_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};

VkSampleCountFlagBits lower_samples(const Gpu& gpu, uint32_t wanted) {
    const VkSampleCountFlags available = gpu.properties.limits.framebufferColorSampleCounts & gpu.properties.limits.framebufferDepthSampleCounts;
    for (uint32_t samples = VK_SAMPLE_COUNT_64_BIT; samples > 1; samples /= 2)
        if (samples <= wanted && (available & samples)) return static_cast<VkSampleCountFlagBits>(samples);
    return VK_SAMPLE_COUNT_1_BIT;
}

io::vec4 to_vec4(const Vec3<float>& v, float w = 0) { return {v.x, v.y, v.z, w}; }

// Where characters stand: at the lowest point of their rest poses, or at the origin of their model space where that is a little lower,
// since a rest pose may float above the floor that the clips walk on.
float ground_height(const CrowdState& state, const Bounds& bounds) {
    float height = bounds.min.y;
    for (const Batch& batch : state.batches) {
        const Group& group = state.groups[batch.group];
        const float floating = group.bounds_min.y;
        if (floating <= 0 || floating > 0.25f * (group.bounds_max.y - group.bounds_min.y)) continue;
        for (uint32_t i = 0; i < batch.instance_count; ++i) height = std::min(height, state.placements[batch.first_instance + i].row[1][3]);
    }
    return height;
}

// Everything is measured in the crowd's own size: a file's unit may be a metre or a centimetre.
io::DrawScene make_scene(const CrowdState& state, const Bounds& bounds, const Camera& camera, float aspect_ratio) {
    const View view = make_view(camera, aspect_ratio);
    const Vec3<float> centre = (bounds.min + bounds.max) * 0.5f;
    const float half_diagonal = length(bounds.max - bounds.min) / 2;
    const float farthest = std::max(length(camera.eye - centre) + half_diagonal, 1e-6f);
    float character_size = 0;  // of the largest
    for (const Batch& batch : state.batches) {
        const Group& group = state.groups[batch.group];
        const float scale = std::cbrt(std::abs(determinant(state.placements[batch.first_instance])));
        character_size = std::max(character_size, length(group.bounds_max - group.bounds_min) * scale);
    }
    character_size = std::max(character_size, 1e-6f);

    io::DrawScene scene{};
    for (size_t r = 0; r < 4; ++r) {
        const auto& row = view.clip_from_world[r];
        scene.clip_from_world[r] = {row[0], row[1], row[2], row[3]};
    }
    scene.eye = to_vec4(camera.eye);
    scene.forward = to_vec4(view.forward);
    scene.right = to_vec4(view.right * view.half_width);
    scene.down = to_vec4(view.up * -view.half_height);
    scene.to_light = to_vec4(direction_to_light());
    scene.ground = {centre.x, ground_height(state, bounds), centre.z, half_diagonal * 2.2f + character_size};
    scene.scale = {character_size, farthest * 2.5f, character_size * 0.25f, 0};
    return scene;
}

bool has_mirrored_instances(const CrowdState& state, const Batch& batch) {
    const auto first = state.placements.begin() + batch.first_instance;
    return std::any_of(first, first + batch.instance_count, [](const Affine& placement) { return determinant(placement) < 0; });
}

// The scene in a descriptor set.
struct SceneBinding {
    SceneBinding(const std::shared_ptr<Gpu>& gpu, VkDescriptorSetLayout layout, const io::DrawScene& scene)
        : buffer(upload(gpu, "scene", std::vector{scene}, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT)) {
        const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1};
        VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
        create.maxSets = 1;
        create.poolSizeCount = 1;
        create.pPoolSizes = &size;
        pool = OwnedPool(gpu, gpu->vk.vkCreateDescriptorPool, create, "vkCreateDescriptorPool");
        VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
        allocate.descriptorPool = pool.get();
        allocate.descriptorSetCount = 1;
        allocate.pSetLayouts = &layout;
        check(gpu->vk.vkAllocateDescriptorSets(gpu->device, &allocate, &set), "vkAllocateDescriptorSets");
        const VkDescriptorBufferInfo info{buffer.handle(), 0, buffer.size_bytes()};
        VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        write.dstSet = set;
        write.descriptorCount = 1;
        write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        write.pBufferInfo = &info;
        gpu->vk.vkUpdateDescriptorSets(gpu->device, 1, &write, 0, nullptr);
    }

    Buffer buffer;
    OwnedPool pool;
    VkDescriptorSet set = VK_NULL_HANDLE;
};

}  // namespace

struct RendererState {
    RendererState(std::shared_ptr<Gpu> gpu, const RendererSettings& settings);
    RenderResult render(const Crowd& crowd, const Camera& camera);

private:
    // What lives for one picture.
    struct Frame {
        const CrowdState& crowd;
        SceneBinding scene;
        std::vector<GroupMaterials> materials;  // [group_count]
        std::vector<Bindings> batches;          // [batch_count]
    };
    void record(VkCommandBuffer commands, const Frame& frame) const;
    void begin_rendering(VkCommandBuffer commands) const;
    void draw(VkCommandBuffer commands, const Frame& frame) const;
    void draw_batch(VkCommandBuffer commands, const Frame& frame, uint32_t batch_index, bool shadow) const;
    void copy_picture(VkCommandBuffer commands) const;
    double read_draw_ms() const;

    std::shared_ptr<Gpu> gpu_;
    uint32_t width_, height_;
    VkSampleCountFlagBits samples_;
    DrawPipelines pipelines_;
    Image color_, depth_;
    Image resolved_;  // of color_, where that has several samples
    Buffer readback_;
    Image white_;
    OwnedSampler sampler_;
    OwnedQueries queries_;
};

RendererState::RendererState(std::shared_ptr<Gpu> gpu, const RendererSettings& settings)
    : gpu_(std::move(gpu)), width_(settings.width), height_(settings.height), samples_(lower_samples(*gpu_, settings.samples)) {
    if (!gpu_->has_graphics()) throw Failure(ErrorCode::kNoDevice, "renderer", "queue family " + std::to_string(gpu_->queue_family) + " of " + gpu_->info.name + " has no graphics");
    const VkPhysicalDeviceLimits& limits = gpu_->properties.limits;
    if (width_ > limits.maxFramebufferWidth || height_ > limits.maxFramebufferHeight)
        throw Failure(ErrorCode::kLimit, "picture", std::to_string(width_) + " x " + std::to_string(height_) + " exceeds the device's largest framebuffer of " +
                                                        std::to_string(limits.maxFramebufferWidth) + " x " + std::to_string(limits.maxFramebufferHeight));
    color_ = Image(gpu_, {.what = "picture", .width = width_, .height = height_, .format = kColorFormat,
                          .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, .samples = samples_});
    depth_ = Image(gpu_, {.what = "depth", .width = width_, .height = height_, .format = kDepthFormat, .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, .samples = samples_});
    if (samples_ != VK_SAMPLE_COUNT_1_BIT)
        resolved_ = Image(gpu_, {.what = "resolved picture", .width = width_, .height = height_, .format = kColorFormat,
                                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    readback_ = Buffer(gpu_, "picture read-back", uint64_t{width_} * height_ * 4, 0, MemoryKind::kReadback);
    pipelines_ = DrawPipelines(gpu_, samples_, SkinFormat::kAffine, false);
    white_ = make_white_texture(gpu_);

    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
    sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
    sampler.maxLod = VK_LOD_CLAMP_NONE;
    sampler_ = OwnedSampler(gpu_, gpu_->vk.vkCreateSampler, sampler, "vkCreateSampler");
    if (gpu_->has_timestamps()) {
        VkQueryPoolCreateInfo queries{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
        queries.queryCount = 2;
        queries_ = OwnedQueries(gpu_, gpu_->vk.vkCreateQueryPool, queries, "vkCreateQueryPool");
    }
}

RenderResult RendererState::render(const Crowd& crowd, const Camera& camera) {
    const CrowdState& state = crowd.state();
    if (state.gpu != gpu_) throw Failure(ErrorCode::kInvalidArgument, "render", "the crowd lives on another device");
    if (pipelines_.skin_format != state.skin_format || pipelines_.is_listed != state.cull.has_value())
        pipelines_ = DrawPipelines(gpu_, samples_, state.skin_format, state.cull.has_value());
    const float aspect_ratio = static_cast<float>(width_) / static_cast<float>(height_);
    Frame frame{state, SceneBinding(gpu_, pipelines_.scene_set.get(), make_scene(state, world_bounds(crowd), camera, aspect_ratio)), {}, {}};
    std::vector<std::string> warnings;
    for (const Group& group : state.groups) frame.materials.emplace_back(gpu_, group, pipelines_.material_set.get(), sampler_.get(), white_.view(), warnings);
    for (const Batch& batch : state.batches) {
        const Group& group = state.groups[batch.group];
        const std::array<BufferRange, kBatchBindings.size()> ranges{group.vertices, group.influences, batch.skin(), batch.placements,
                                                                    group.morphs ? group.morphs->deltas : group.vertices, batch.morphs.or_else(group.vertices), batch.list.or_else(group.vertices)};
        frame.batches.emplace_back(gpu_, pipelines_.batch_set.get(), group.name, kBatchBindings, ranges);
    }
    gpu_->submit_and_wait([&](VkCommandBuffer commands) { record(commands, frame); });

    RenderResult result{.picture = {.width = width_, .height = height_}, .draw_ms = read_draw_ms(), .warnings = std::move(warnings)};
    const auto* bytes = reinterpret_cast<const uint8_t*>(readback_.mapped());
    result.picture.rgba.assign(bytes, bytes + readback_.size_bytes());
    return result;
}

void RendererState::record(VkCommandBuffer commands, const Frame& frame) const {
    const VkQueryPool queries = queries_.get();
    if (queries) gpu_->vk.vkCmdResetQueryPool(commands, queries, 0, 2);
    memory_barrier(*gpu_, commands, kShaderWrite | kTransferWrite, kDrawRead);
    if (queries) gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, 0);
    begin_rendering(commands);
    draw(commands, frame);
    gpu_->vk.vkCmdEndRendering(commands);
    if (queries) gpu_->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries, 1);
    copy_picture(commands);
}

void RendererState::begin_rendering(VkCommandBuffer commands) const {
    const auto prepare = [&](const Image& image, VkImageAspectFlags aspect, VkImageLayout layout, Access access) {
        transition(*gpu_, commands, {.image = image.handle(), .aspect = aspect, .to = layout, .before = access, .after = access});
    };
    prepare(color_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kColorWrite);
    prepare(depth_, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, kDepthAccess);
    const bool resolves = resolved_.handle() != VK_NULL_HANDLE;
    if (resolves) prepare(resolved_, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kColorWrite);

    VkRenderingAttachmentInfo color{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    color.imageView = color_.view();
    color.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    color.loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;  // the ground covers all of it
    color.storeOp = resolves ? VK_ATTACHMENT_STORE_OP_DONT_CARE : VK_ATTACHMENT_STORE_OP_STORE;
    if (resolves) {
        color.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
        color.resolveImageView = resolved_.view();
        color.resolveImageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    depth.imageView = depth_.view();
    depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    depth.clearValue.depthStencil = {0, 0};  // infinitely far
    VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
    rendering.renderArea = {{0, 0}, {width_, height_}};
    rendering.layerCount = 1;
    rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &color;
    rendering.pDepthAttachment = &depth;
    gpu_->vk.vkCmdBeginRendering(commands, &rendering);
    const VkViewport viewport{0, 0, static_cast<float>(width_), static_cast<float>(height_), 0, 1};
    gpu_->vk.vkCmdSetViewport(commands, 0, 1, &viewport);
    gpu_->vk.vkCmdSetScissor(commands, 0, 1, &rendering.renderArea);
}

// Ground, shadows on it, characters over both.
void RendererState::draw(VkCommandBuffer commands, const Frame& frame) const {
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.layout.get(), 0, 1, &frame.scene.set, 0, nullptr);
    gpu_->vk.vkCmdSetCullMode(commands, VK_CULL_MODE_NONE);
    gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.ground.get());
    gpu_->vk.vkCmdDraw(commands, 3, 1, 0, 0);
    for (const bool shadow : {true, false})
        for (uint32_t batch = 0; batch < frame.batches.size(); ++batch) draw_batch(commands, frame, batch, shadow);
}

void RendererState::draw_batch(VkCommandBuffer commands, const Frame& frame, uint32_t batch_index, bool shadow) const {
    const Batch& batch = frame.crowd.batches[batch_index];
    const Group& group = frame.crowd.groups[batch.group];
    const GroupMaterials& materials = frame.materials[batch.group];
    // Mirrored, a front face winds the other way: then the fragment shader culls.
    const bool mirrors = has_mirrored_instances(frame.crowd, batch);
    const VkDescriptorSet batch_set = frame.batches[batch_index].set();
    const VkPipelineLayout layout = pipelines_.layout.get();
    gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1, &batch_set, 0, nullptr);
    gpu_->vk.vkCmdBindIndexBuffer(commands, group.indices.handle(), 0, VK_INDEX_TYPE_UINT32);
    for (size_t section_index = 0; section_index < group.sections.size(); ++section_index) {
        const MeshSection& section = group.sections[section_index];
        if (section.index_count == 0) continue;
        const DrawMaterial& material = materials.of(section);
        const OwnedPipeline& pipeline = shadow ? pipelines_.shadow : material.masked || mirrors ? pipelines_.character_discards : pipelines_.character;
        gpu_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
        gpu_->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 2, 1, &material.set, 0, nullptr);
        gpu_->vk.vkCmdSetCullMode(commands, material.double_sided || mirrors ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
        const auto& c = material.base_color;
        io::DrawPush push{.first_vertex = section.first_vertex,
                          .first_influences = section.first_influences,
                          .influence_sets = section.influence_sets,
                          .palette_count = group.palette_count,
                          .base_color = {c[0], c[1], c[2], c[3]},
                          .alpha_cutoff = material.alpha_cutoff,
                          .double_sided = material.double_sided ? 1u : 0u,
                          .first_morph = section.first_morph,
                          .morph_count = section.morph_count};
        const auto set_push = [&] { gpu_->vk.vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof push, &push); };
        if (!batch.draws.handle()) {
            set_push();
            gpu_->vk.vkCmdDrawIndexed(commands, section.index_count, batch.instance_count, section.first_index, 0, 0);
            continue;
        }
        for (push.detail = 0; push.detail <= group.details.size(); ++push.detail) {
            set_push();
            gpu_->vk.vkCmdDrawIndexedIndirect(commands, batch.draws.handle(), (section_index * io::kDetailLevels + push.detail) * sizeof(io::DrawCommand), 1, sizeof(io::DrawCommand));
        }
    }
}

void RendererState::copy_picture(VkCommandBuffer commands) const {
    const Image& picture = resolved_.handle() ? resolved_ : color_;
    transition(*gpu_, commands, {.image = picture.handle(), .from = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, .to = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                 .before = kColorWrite, .after = kTransferRead});
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {width_, height_, 1};
    gpu_->vk.vkCmdCopyImageToBuffer(commands, picture.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_.handle(), 1, &copy);
    memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
}

double RendererState::read_draw_ms() const {
    if (!queries_.get()) return 0;
    std::array<uint64_t, 2> ticks{};
    check(gpu_->vk.vkGetQueryPoolResults(gpu_->device, queries_.get(), 0, 2, sizeof ticks, ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT), "vkGetQueryPoolResults");
    const uint64_t mask = gpu_->timestamp_valid_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << gpu_->timestamp_valid_bits) - 1;
    return static_cast<double>((ticks[1] - ticks[0]) & mask) * double{gpu_->properties.limits.timestampPeriod} * 1e-6;
}

Result<Renderer> Renderer::create(const Device& device, const RendererSettings& settings) {
    return as_result([&] { return Renderer(std::make_unique<RendererState>(device.gpu(), settings)); }, "renderer");
}

Renderer::Renderer(std::unique_ptr<RendererState> state) : state_(std::move(state)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<RenderResult> Renderer::render(const Crowd& crowd, const Camera& camera) {
    return as_result([&] { return state_->render(crowd, camera); }, "render");
}

}  // namespace throng
