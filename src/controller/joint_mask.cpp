#include "controller/joint_mask.h"

#include <algorithm>

namespace throng {

std::vector<float> mask_weights(const JointMask& mask, const Rig& rig) {
    std::vector<float> weights(rig.joint_count(), 0.0f);
    for (const MaskItem& item : mask.items) {
        const auto top = static_cast<uint32_t>(std::ranges::find(rig.names, item.joint) - rig.names.begin());
        std::vector<uint32_t> generations(rig.joint_count(), kNone);  // below the item's joint, which is generation 0
        for (uint32_t joint = top; joint < rig.joint_count(); ++joint) {  // parents come first
            const uint32_t parent = rig.parents[joint];
            if (joint == top)
                generations[joint] = 0;
            else if (parent != kNone && generations[parent] != kNone)
                generations[joint] = generations[parent] + 1;
            if (generations[joint] == kNone) continue;
            const double steps = std::min(generations[joint], item.ramp) + 1.0;
            weights[joint] = static_cast<float>(item.weight * (steps / (item.ramp + 1.0)));
        }
    }
    return weights;
}

}  // namespace throng
