// The spaces that a character's rows are brought into (native_rig.h).
#pragma once

#include "native/rows.h"

#include <vector>

namespace throng::native {

struct RowSpaces {
    RowSpaces(const Character& character, bool may_scale_unevenly);

    bool uniform_scale = false;       // one scale a joint: else all spaces are the identity
    std::vector<RowJoint> of_joints;  // [joint_count]
};

// Whether a matrix differs too little from the identity to be seen; `size` is the character's.
bool is_identity(const AffineT<double>& m, double size);

}  // namespace throng::native
