#include "draw/scene.h"

#include "draw/camera.h"
#include "gpu/barrier.h"

#include <algorithm>

namespace throng {
namespace {

constexpr Access kSceneRead{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_UNIFORM_READ_BIT};

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

}  // namespace

io::DrawScene make_scene(const CrowdState& state, const Bounds& bounds, const Camera& camera, float aspect_ratio, const DrawOptions& options) {
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
    scene.to_light = to_vec4(direction_to_sun(options));
    scene.ground = {centre.x, ground_height(state, bounds), centre.z, half_diagonal * 2.2f + character_size};
    scene.scale = {character_size, farthest * 2.5f, character_size * 0.25f, 0};
    scene.light = {options.exposure, options.fog ? 1.0f : 0.0f, 0, 0};
    return scene;
}

SceneBinding::SceneBinding(const std::shared_ptr<Gpu>& gpu, VkDescriptorSetLayout layout)
    : gpu_(gpu), buffer_(gpu, "scene", sizeof(io::DrawScene), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT) {
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1};
    VkDescriptorPoolCreateInfo create{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    create.maxSets = 1;
    create.poolSizeCount = 1;
    create.pPoolSizes = &size;
    pool_ = OwnedPool(gpu, gpu->vk.vkCreateDescriptorPool, create, "vkCreateDescriptorPool");
    VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    allocate.descriptorPool = pool_.get();
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &layout;
    check(gpu->vk.vkAllocateDescriptorSets(gpu->device, &allocate, &set_), "vkAllocateDescriptorSets");
    const VkDescriptorBufferInfo info{buffer_.handle(), 0, buffer_.size_bytes()};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set_;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    write.pBufferInfo = &info;
    gpu->vk.vkUpdateDescriptorSets(gpu->device, 1, &write, 0, nullptr);
}

void SceneBinding::record(VkCommandBuffer commands, const io::DrawScene& scene) const {
    memory_barrier(*gpu_, commands, kSceneRead, kTransferWrite);
    record_update(*gpu_, commands, buffer_, 0, std::span(&scene, 1));
    memory_barrier(*gpu_, commands, kTransferWrite, kSceneRead);
}

}  // namespace throng
