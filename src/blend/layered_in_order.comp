// layered, in order: like layered.comp, for layers that blend rotations in model space. These need the rotations of a
// joint's ancestors, so each invocation walks its instance's joints, parents before children. On top of layered.comp's
// traffic it reads and writes 96 bytes per joint and layer in model space. A dispatch handles as many joints as the
// loop limit of a software device allows (record_layered_in_order()); rotations pass between dispatches in memory.
#include "gpu/buffers_io.h"
#include "blend/layered_io.h"
#include "gpu/table.glsl"

PUSH(LayeredInOrderPush);
TABLE_OF_WORDS(kParentsBuffer, parents);
BUFFER(kRotationsBuffer, ModelRotations, rotations);
#define ACTIVE_CLIPS_IN_ORDER
#include "blend/layered.glsl"

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || (kVaries && is_free(instance))) return;
    for (uint joint = push.first_joint; joint < push.joint_end; ++joint) pose_joint(instance, joint);
}
