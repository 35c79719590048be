// Computes a pose from skin matrices.
#pragma once

#include <throng/character.h>

#include <span>
#include <vector>

namespace throng {

class PoseOfSkin {
public:
    explicit PoseOfSkin(const Character& character);
    // Appends parent_from_joint[joint_count], computed from model_from_bind[palette_count]. Joints that no palette
    // entry uses, and joints below one that is scaled to zero, get their rest pose.
    void append(std::span<const Affine> model_from_bind, std::vector<Trs<float>>& pose) const;
    size_t joint_count() const { return joints_.size(); }

private:
    struct Joint {
        uint32_t parent = kNone;
        uint32_t entry = kNone;  // of the palette
        AffineT<double> bind_from_joint{};
        Trs<float> rest{};
    };
    std::vector<Joint> joints_;
    bool uniform_scale_ = false;  // Rig::uniform_scale
};

}  // namespace throng
