// What is computed of a character's joints and clips, once for all groups of a device that would have the same.
#pragma once

#include "gpu/gpu.h"
#include "native/native_rig.h"

#include <map>
#include <memory>
#include <vector>

namespace throng {

// While the groups of a crowd are made: their characters do not change meanwhile.
class SharedRigs {
public:
    explicit SharedRigs(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

    std::shared_ptr<const NativeRig> native(const Character& character, const NativeRigSettings& settings);
    // The key of something that depends on what rows (native/rows.h, native/gpu_rows.h) and the native walk depend on.
    SharedValues::Key key_of(SharedValue kind, const Character& character);

private:
    const SharedValues::Key& motion(const Character& character);

    std::shared_ptr<Gpu> gpu_;
    std::map<const Character*, SharedValues::Key> motions_;
    std::vector<std::shared_ptr<const NativeRig>> made_;  // which no group may keep
};

}  // namespace throng
