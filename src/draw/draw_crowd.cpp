#include "draw/draw_crowd.h"

#include "cull/cull_io.h"
#include "draw/draw_io.h"

#include <algorithm>

namespace throng {
namespace {

bool has_mirrored_instances(const CrowdState& crowd, const Batch& batch) {
    const auto first = crowd.placements.begin() + batch.first_instance;
    return std::any_of(first, first + batch.instance_count, [](const Affine& placement) { return determinant(placement) < 0; });
}

}  // namespace

void draw_crowd(VkCommandBuffer commands, const CrowdState& crowd, const CrowdBindings& bindings, VkPipelineLayout layout,
                const std::function<VkPipeline(const DrawnSection&)>& pipeline_of) {
    const VolkDeviceTable& vk = crowd.gpu->vk;
    for (uint32_t batch_index = 0; batch_index < crowd.batches.size(); ++batch_index) {
        const Batch& batch = crowd.batches[batch_index];
        const Group& group = crowd.groups[batch.group];
        const bool mirrors = has_mirrored_instances(crowd, batch);
        const VkDescriptorSet batch_set = bindings.set_of(crowd, batch_index);
        vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 1, 1, &batch_set, 0, nullptr);
        vk.vkCmdBindIndexBuffer(commands, group.indices.handle(), 0, VK_INDEX_TYPE_UINT32);
        for (size_t section_index = 0; section_index < group.sections.size(); ++section_index) {
            const MeshSection& section = group.sections[section_index];
            if (section.index_count == 0) continue;
            const DrawMaterial& material = bindings.materials[batch.group].of(section);
            vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_of({material, mirrors}));
            vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 2, 1, &material.set, 0, nullptr);
            vk.vkCmdSetCullMode(commands, material.double_sided || mirrors ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT);
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
            const auto set_push = [&] { vk.vkCmdPushConstants(commands, layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof push, &push); };
            if (!batch.draws.handle()) {
                set_push();
                vk.vkCmdDrawIndexed(commands, section.index_count, batch.instance_count, section.first_index, 0, 0);
                continue;
            }
            for (push.detail = 0; push.detail <= group.details.size(); ++push.detail) {
                set_push();
                vk.vkCmdDrawIndexedIndirect(commands, batch.draws.handle(), (section_index * io::kDetailLevels + push.detail) * sizeof(io::DrawCommand), 1, sizeof(io::DrawCommand));
            }
        }
    }
}

}  // namespace throng
