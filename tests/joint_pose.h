// Local transforms as kernels read them.
#pragma once

#include "sample/sample_io.h"

#include <throng/throng.h>

namespace throng::test {

inline io::JointPose to_pose(const Trs<double>& trs) {
    const Trs<float> t = trs.as<float>();
    return {.rotation = {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w},
            .translation = {t.translation.x, t.translation.y, t.translation.z, 0},
            .scale = {t.scale.x, t.scale.y, t.scale.z, 0}};
}

}  // namespace throng::test
