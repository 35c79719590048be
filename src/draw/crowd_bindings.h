// What drawing a crowd needs beside the crowd: made once for each, and kept while it lives.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/materials.h"

#include <array>
#include <string>
#include <vector>

namespace throng {

struct CrowdBindings {
    // Decodes and uploads textures: submits and waits.
    CrowdBindings(const ShaderLayout& layout, const MaterialSampling& sampling, const CrowdState& crowd);

    bool is_of(const CrowdState& crowd) const { return life_.lock() == crowd.life; }
    bool is_of_none() const { return life_.expired(); }
    VkDescriptorSet set_of(const CrowdState& crowd, uint32_t batch) const {
        return batches_[batch][crowd.batches[batch].current_skin].set();
    }

    std::vector<GroupMaterials> materials;  // [group_count]
    std::vector<std::string> warnings;

private:
    std::weak_ptr<const CrowdLife> life_;
    std::vector<Buffer> joint_levels_;              // [group_count], where model matrices are kept
    std::vector<std::array<Bindings, 2>> batches_;  // [batch_count][current_skin]
};

// Bindings of all crowds that a renderer has drawn and that still live. What belonged to others may go: their commands
// have finished before them.
class CrowdBindingsCache {
public:
    // Submits and waits where the crowd is new.
    const CrowdBindings& of(const ShaderLayout& layout, const MaterialSampling& sampling, const CrowdState& crowd);

private:
    std::vector<std::unique_ptr<CrowdBindings>> entries_;
};

}  // namespace throng
