#include "scan/scan_reference.h"

namespace throng {

std::vector<AffineT<double>> scan_reference(std::span<const uint32_t> parents,
                                            std::span<const AffineT<double>> parent_from_joint) {
    std::vector<AffineT<double>> model_from_joint;
    model_from_joint.reserve(parents.size());
    for (size_t joint = 0; joint < parents.size(); ++joint)
        model_from_joint.push_back(parents[joint] == kNone
                                       ? parent_from_joint[joint]
                                       : model_from_joint[parents[joint]] * parent_from_joint[joint]);
    return model_from_joint;
}

}  // namespace throng
