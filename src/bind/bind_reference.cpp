#include "bind/bind_reference.h"

namespace throng {

std::vector<AffineT<double>> bind_reference(std::span<const PaletteEntry> palette,
                                            std::span<const AffineT<double>> model_from_joint) {
    std::vector<AffineT<double>> model_from_bind;
    model_from_bind.reserve(palette.size());
    for (const PaletteEntry& entry : palette)
        model_from_bind.push_back(model_from_joint[entry.joint] * entry.joint_from_bind.as<double>());
    return model_from_bind;
}

}  // namespace throng
