#include "draw/draw_crowd.h"

#include "cull/cull_io.h"
#include "draw/draw_io.h"

#include <algorithm>

namespace throng {
namespace {

bool has_mirrored_instances(const CrowdState& crowd, const Batch& batch) {
    const auto first = crowd.placements->all().begin() + batch.first_instance;
    return std::any_of(first, first + batch.instance_count,
                       [](const Affine& placement) { return determinant(placement) < 0; });
}

constexpr VkShaderStageFlags kBothStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

io::DrawPush push_of(const Group& group, const MeshSection& section, const DrawMaterial& material) {
    const AssetMaterial& f = material.factors;
    return {.first_vertex = section.first_vertex,
            .first_influences = section.first_influences,
            .influence_sets = section.influence_sets,
            .palette_count = group.palette_count,
            .base_color = {f.base_color[0], f.base_color[1], f.base_color[2], f.base_color[3]},
            .emissive = {f.emissive[0], f.emissive[1], f.emissive[2],
                         f.occlusion_image == kNone ? 0 : f.occlusion_strength},
            .alpha_cutoff = material.alpha_cutoff,
            .double_sided = f.double_sided ? 1u : 0u,
            .first_morph = section.first_morph,
            .morph_count = section.morph_count,
            .metallic = f.metallic,
            .roughness = f.roughness,
            .normal_scale = f.normal_image == kNone ? 0 : f.normal_scale,
            .vertex_count = group.vertex_count};
}

constexpr uint32_t kLineVertices = 6;  // two triangles

void draw_lines(VkCommandBuffer commands, const CrowdState& crowd, uint32_t batch_index, VkDescriptorSet set,
                VkPipelineLayout layout, io::LinePush push, uint32_t line_count) {
    const VolkDeviceTable& vk = crowd.gpu->vk;
    push.instance_count = crowd.batches[batch_index].instance_count;
    vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1, &set, 0, nullptr);
    vk.vkCmdPushConstants(commands, layout, kBothStages, 0, sizeof push, &push);
    vk.vkCmdDraw(commands, kLineVertices * line_count, push.instance_count, 0, 0);
}

}  // namespace

void draw_crowd(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                VkPipelineLayout layout, const CharacterPipelines& pipelines, DrawPass pass) {
    const VolkDeviceTable& vk = crowd.gpu->vk;
    for (uint32_t batch_index = 0; batch_index < crowd.batches.size(); ++batch_index) {
        const Batch& batch = crowd.batches[batch_index];
        const Group& group = crowd.groups[batch.group];
        // Mirrored, a front face winds the other way: then the fragment shader culls.
        const bool mirrors = has_mirrored_instances(crowd, batch);
        if (mirrors && pass == DrawPass::kOccluders) continue;  // it would take a shader that culls
        const VkDescriptorSet batch_set = bindings.set_of(crowd, batch_index);
        vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1, &batch_set, 0, nullptr);
        vk.vkCmdBindIndexBuffer(commands, group.indices.handle(), 0, VK_INDEX_TYPE_UINT32);
        for (size_t section_index = 0; section_index < group.sections.size(); ++section_index) {
            const MeshSection& section = group.sections[section_index];
            if (section.index_count == 0) continue;
            const DrawMaterial& material = bindings.materials[batch.group].of(section);
            const bool is_shadow = pass == DrawPass::kShadow;
            const OwnedPipeline& pipeline = is_shadow ? pipelines.shadow[material.masked]
                                            : pass == DrawPass::kOccluders
                                                ? pipelines.occluder[material.masked]
                                                : pipelines.into_picture[material.masked || mirrors][material.has_maps];
            vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
            vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 2, 1, &material.set, 0,
                                       nullptr);
            vk.vkCmdSetCullMode(commands, is_shadow || material.factors.double_sided || mirrors
                                              ? VK_CULL_MODE_NONE
                                              : VK_CULL_MODE_BACK_BIT);
            io::DrawPush push = push_of(group, section, material);
            const auto set_push = [&] { vk.vkCmdPushConstants(commands, layout, kBothStages, 0, sizeof push, &push); };
            if (!batch[io::kDrawsBuffer].handle()) {
                set_push();
                vk.vkCmdDrawIndexed(commands, section.index_count, batch.instance_count, section.first_index, 0, 0);
                continue;
            }
            for (push.lod = 0; push.lod <= group.lods.size(); ++push.lod) {
                push.first_influences = section.first_influences +
                                        group.influence_set_of(push.lod) * group.influence_count;
                set_push();
                vk.vkCmdDrawIndexedIndirect(commands, batch[io::kDrawsBuffer].handle(),
                                            (section_index * io::kLodCount + push.lod) * sizeof(io::DrawCommand), 1,
                                            sizeof(io::DrawCommand));
            }
        }
    }
}

void draw_skeletons(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                    VkPipelineLayout layout, const LinePipelines& pipelines) {
    crowd.gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.skeletons.get());
    for (uint32_t i = 0; i < crowd.batches.size(); ++i) {
        const Group& group = crowd.groups[crowd.batches[i].group];
        draw_lines(commands, crowd, i, bindings.skeleton_set_of(i), layout,
                   {.joint_count = group.joint_count, .level_count = group.level_count}, group.joint_count);
    }
}

void draw_bounds(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings,
                 VkPipelineLayout layout, const LinePipelines& pipelines) {
    constexpr uint32_t kEdges = 12;
    crowd.gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines.bounds.get());
    for (uint32_t i = 0; i < crowd.batches.size(); ++i) {
        const Group& group = crowd.groups[crowd.batches[i].group];
        const Vec3<float> centre = (group.posed_min + group.posed_max) * 0.5f,
                          half = (group.posed_max - group.posed_min) * 0.5f;
        draw_lines(commands, crowd, i, bindings.set_of(crowd, i), layout,
                   {.box_centre = {centre.x, centre.y, centre.z, 0}, .box_half_extent = {half.x, half.y, half.z, 0}},
                   kEdges);
    }
}

}  // namespace throng
