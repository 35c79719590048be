#include "draw/draw_crowd.h"

#include "cull/cull_io.h"
#include "draw/crowd_bounds.h"
#include "draw/draw_io.h"

#include <algorithm>

namespace throng {
namespace {

bool has_mirrored_instances(const CrowdState& crowd, const Batch& batch) {
    const auto first = crowd.placements->known().begin() + batch.first_instance;
    return std::any_of(first, first + batch.instance_count,
                       [](const Affine& placement) { return determinant(placement) < 0; });
}

io::DrawPush push_of(const Group& group, const MeshSection& section, const TexturedMaterial<Image>& material) {
    const AssetMaterial& f = material.factors;
    // 0 where there is no mask: the pipeline that discards also draws opaque materials of mirrored instances, in full
    const float cutoff = f.alpha_mode == AlphaMode::kMask ? f.alpha_cutoff : 0;
    return {.first_vertex = section.first_vertex,
            .first_influences = section.first_influences,
            .influence_sets = section.influence_sets,
            .palette_count = group.palette_count,
            .base_color = {f.base_color[0], f.base_color[1], f.base_color[2], f.base_color[3]},
            .emissive = {f.emissive[0], f.emissive[1], f.emissive[2],
                         f.occlusion_image == kNone ? 0 : f.occlusion_strength},
            .alpha_cutoff = cutoff,
            .double_sided = f.double_sided ? 1u : 0u,
            .first_morph = section.first_morph,
            .morph_count = section.morph_count,
            .metallic = f.metallic,
            .roughness = f.roughness,
            .normal_scale = f.normal_image == kNone ? 0 : f.normal_scale,
            .vertex_count = group.vertex_count,
            .has_skin_pool = group.skin_pool.has_value(),
            .active_morph_limit = group.active_morph_limit,
            .size = size_at_rest(group)};
}

template <class Push>
void set_push(VkCommandBuffer commands, const CrowdState& crowd, const ShaderLayout& layout, const Push& push) {
    crowd.gpu->vk.vkCmdPushConstants(commands, layout.get(), layout.push().stageFlags, 0, sizeof push, &push);
}

}  // namespace

void CrowdDrawing::bind(VkCommandBuffer commands, uint32_t set_number, VkDescriptorSet set) const {
    crowd.gpu->vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout.get(), set_number, 1, &set,
                                          0, nullptr);
}

void CrowdDrawing::find_mirrors() {
    mirrors.clear();
    for (const Batch& batch : crowd.batches) mirrors.push_back(has_mirrored_instances(crowd, batch));
}

void CrowdDrawing::draw(VkCommandBuffer commands, DrawPass pass) const {
    for (size_t i = 0; i < crowd.batches.size(); ++i) {
        const Batch& batch = crowd.batches[i];
        if (!batch.has_outputs) continue;  // there are no matrices yet
        const Group& group = crowd.groups[batch.group];
        // Front faces of mirrored instances wind the other way: then the fragment shader culls.
        const bool has_mirrored = mirrors[i];
        if (has_mirrored && pass == DrawPass::kOccluders) continue;  // the occluder pipelines have no shader that culls
        bind(commands, kBatchSet, groups[batch.group]->set_of(batch));
        crowd.gpu->vk.vkCmdBindIndexBuffer(commands, group.indices.handle(), 0, VK_INDEX_TYPE_UINT32);
        for (size_t section = 0; section < group.sections.size(); ++section)
            if (group.sections[section].index_count > 0)
                for (const uint32_t material : group.section_materials[section])
                    draw_section(commands, batch, section, material, pass, has_mirrored);
    }
}

// The vertex shader leaves out instances that show the section in another material, or not at all.
void CrowdDrawing::draw_section(VkCommandBuffer commands, const Batch& batch, size_t section_index,
                                uint32_t material_index, DrawPass pass, bool has_mirrored) const {
    const VolkDeviceTable& vk = crowd.gpu->vk;
    const Group& group = crowd.groups[batch.group];
    const MeshSection& section = group.sections[section_index];
    const TexturedMaterial<Image>& material = groups[batch.group]->materials[material_index];
    const CharacterPipelines& pipelines = group.outfit_count > 0 ? *with_looks : characters;
    const auto mode = static_cast<size_t>(material.factors.alpha_mode);
    const size_t that_culls = std::max(mode, has_mirrored ? static_cast<size_t>(AlphaMode::kMask) : 0);
    const OwnedPipeline& pipeline = pass == DrawPass::kShadow ? pipelines.shadow[mode]
                                    : pass == DrawPass::kOccluders
                                        ? pipelines.occluder[mode]
                                        : pipelines.into_picture[that_culls][material.has_maps];
    const bool shows_back = pass == DrawPass::kShadow || material.factors.double_sided || has_mirrored;
    vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
    bind(commands, kMaterialSet, groups[batch.group]->materials.textures_of(material_index));
    vk.vkCmdSetCullMode(commands, shows_back ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
    io::DrawPush push = push_of(group, section, material);
    push.section = static_cast<uint32_t>(section_index);
    push.section_count = static_cast<uint32_t>(group.sections.size());
    push.material = material_index;
    push.first_layer = first_layer + batch.first_instance;
    const VkBuffer draws = batch.shown_in(batch.slot, io::kDrawsBuffer).handle();
    if (!draws) {
        set_push(commands, crowd, layout, push);
        vk.vkCmdDrawIndexed(commands, section.index_count, batch.instance_count, section.first_index,
                            static_cast<int32_t>(section.first_vertex), 0);
        return;
    }
    for (push.lod = 0; push.lod <= group.lods.size(); ++push.lod) {
        push.first_influences = group.section_lod(section_index, push.lod).first_influences;
        set_push(commands, crowd, layout, push);
        vk.vkCmdDrawIndexedIndirect(commands, draws,
                                    (section_index * io::kLodCount + push.lod) * sizeof(io::DrawCommand), 1,
                                    sizeof(io::DrawCommand));
    }
}

// push_of(group) returns the push constants of the lines of one group, and how many lines each instance has.
template <class PushOf>
void CrowdDrawing::draw_lines(VkCommandBuffer commands, const OwnedPipeline& pipeline, const PushOf& push_of) const {
    constexpr uint32_t kLineVertices = 6;  // two triangles
    crowd.gpu->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.get());
    for (const Batch& batch : crowd.batches) {
        if (!batch.has_outputs) continue;
        auto [push, line_count] = push_of(crowd.groups[batch.group]);
        push.instance_count = batch.instance_count;
        bind(commands, kBatchSet, groups[batch.group]->set_of(batch));
        set_push(commands, crowd, layout, push);
        crowd.gpu->vk.vkCmdDraw(commands, kLineVertices * line_count, batch.instance_count, 0, 0);
    }
}

void CrowdDrawing::draw_skeletons(VkCommandBuffer commands) const {
    draw_lines(commands, lines->skeletons, [](const Group& group) {
        return std::pair(io::LinePush{.joint_count = group.joint_count, .level_count = group.level_count},
                         group.joint_count);
    });
}

void CrowdDrawing::draw_bounds(VkCommandBuffer commands) const {
    draw_lines(commands, lines->bounds, [](const Group& group) {
        constexpr uint32_t kEdges = 12;
        const Vec3<float> centre = (group.posed_min + group.posed_max) * 0.5f,
                          half = (group.posed_max - group.posed_min) * 0.5f;
        return std::pair(io::LinePush{.box_centre = {centre.x, centre.y, centre.z, 0},
                                      .box_half_extent = {half.x, half.y, half.z, 0}},
                         kEdges);
    });
}

}  // namespace throng
