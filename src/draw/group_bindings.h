// What drawing a group of a crowd needs beside the group: made once for each, and kept while it lives.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/materials.h"

#include <string>
#include <vector>

namespace throng {

struct GroupBindings {
    // Makes what `textures`, the renderer's, lack, and takes what all need from `room_bytes`. To be drawn with when the
    // uploads have finished.
    GroupBindings(Uploads& uploads, const ShaderLayout& layout, const MaterialSampling& sampling,
                  const CrowdState& crowd, uint32_t group, uint64_t& room_bytes, SharedValues& textures);

    VkDescriptorSet set_of(const Batch& batch) const { return batches_[batch.of_group][batch.slot].set(); }

    std::vector<std::string> warnings;
    GroupMaterials materials;

private:
    Buffer joint_levels_;                         // where model matrices are kept
    std::vector<std::vector<Bindings>> batches_;  // [batch of the group][frame slot]
};

}  // namespace throng
