// Recording the draws of a crowd: every batch, every section, every level of detail; and the lines over it.
#pragma once

#include "draw/group_bindings.h"
#include "draw/pipeline.h"

namespace throng {

enum class DrawPass { kShadow, kOccluders, kPicture };

// A crowd and what it is drawn with. Draws are recorded within a pass, with the scene bound.
struct CrowdDrawing {
    const CrowdState& crowd;
    std::vector<const GroupBindings*> groups;
    const ShaderLayout& layout;
    const CharacterPipelines& characters;
    const CharacterPipelines* with_looks;  // for groups with CrowdGroup::outfits, if there are any
    const LinePipelines* lines;            // if any are drawn
    uint32_t first_layer = 0;              // coverage_layer()'s number of the crowd's first instance
    std::vector<bool> mirrors{};           // [batch], whether some of its instances are mirrored

    // Call it before the first draw(). Goes through all instances.
    void find_mirrors();
    void draw(VkCommandBuffer commands, DrawPass pass) const;
    // For all instances, or those that are listed. Skeletons need CrowdSettings::keep_model_matrices.
    void draw_skeletons(VkCommandBuffer commands) const;
    void draw_bounds(VkCommandBuffer commands) const;

private:
    void bind(VkCommandBuffer commands, uint32_t set_number, VkDescriptorSet set) const;
    void draw_section(VkCommandBuffer commands, const Batch& batch, size_t section, uint32_t material, DrawPass pass,
                      bool has_mirrored) const;
    template <class PushOf>
    void draw_lines(VkCommandBuffer commands, const OwnedPipeline& pipeline, const PushOf& push_of) const;
};

}  // namespace throng
