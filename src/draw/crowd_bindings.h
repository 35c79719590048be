// What drawing a crowd needs beside the crowd: made once for each, and kept while it lives.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/materials.h"

#include <string>
#include <vector>

namespace throng {

struct CrowdBindings {
    // Decodes and uploads textures: submits and waits.
    CrowdBindings(const ShaderLayout& layout, const MaterialSampling& sampling, const CrowdState& crowd);

    VkDescriptorSet set_of(const CrowdState& crowd, uint32_t batch) const {
        return batches_[batch][crowd.batches[batch].slot].set();
    }

    std::vector<GroupMaterials> materials;  // [group_count]
    std::vector<std::string> warnings;

private:
    std::vector<Buffer> joint_levels_;            // [group_count], where model matrices are kept
    std::vector<std::vector<Bindings>> batches_;  // [batch_count][frame slot]
};

}  // namespace throng
