// Native rigs and rows for GPUs take tens of milliseconds to compute, and images a lot of memory, so groups whose
// characters have the same content share them, across all crowds of a device.
#pragma once

#include "crowd/shared_images.h"
#include "gpu/gpu.h"
#include "native/native_rig.h"

#include <map>
#include <memory>
#include <vector>

namespace throng {

// Lives while the groups of one crowd are made. Their characters do not change meanwhile, so each is hashed once.
class SharedRigs {
public:
    explicit SharedRigs(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

    std::shared_ptr<const NativeRig> native(const Character& character, const NativeRigSettings& settings);
    const SharedImages& images(const Character& character);
    // Covers everything of the character that native rigs and rows are computed from; callers append what else matters.
    SharedValues::Key key_of(SharedValue kind, const Character& character);

private:
    const SharedValues::Key& motion(const Character& character);

    std::shared_ptr<Gpu> gpu_;
    std::map<const Character*, SharedValues::Key> motions_;
    std::map<const Character*, SharedImages> images_;
    // Kept until all groups are made, so that a later one can share what no group has kept.
    std::vector<std::shared_ptr<const NativeRig>> made_;
};

}  // namespace throng
