// Model matrix -> skin matrix.
#include "bind/bind_io.h"
#include "gpu/affine.glsl"

// model_from_bind
Affine skin_matrix(Affine model_from_joint, Affine joint_from_bind) {
    return affine_multiply(model_from_joint, joint_from_bind);
}
