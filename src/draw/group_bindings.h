// What drawing a group of a crowd needs besides the group itself: made once for each group, and kept while it lives.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/materials.h"

#include <string>
#include <vector>

namespace throng {

struct GroupBindings {
    // Makes the textures that are not yet among `textures`, the renderer's, and subtracts the size of all textures that
    // the group needs from `room_bytes`. Draw with it only behind the uploads, in the same commands or later.
    GroupBindings(Uploads& uploads, const ShaderLayout& layout, const MaterialSampling& sampling,
                  const CrowdState& crowd, uint32_t group, uint64_t& room_bytes, SharedValues& textures);

    VkDescriptorSet set_of(const Batch& batch) const { return batches_[batch.of_group][batch.slot].set(); }

    std::vector<std::string> warnings;
    GroupMaterials materials;

private:
    Buffer joint_levels_;                         // if model matrices are kept
    std::vector<std::vector<Bindings>> batches_;  // [batch of the group][frame slot]
};

}  // namespace throng
