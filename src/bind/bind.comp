// bind: skin matrix = model_from_joint * joint_from_bind, for every palette entry of every instance.
// One workgroup per instance, entries in strides. Per entry it reads a model matrix of 48 bytes and writes 24 to 48
// bytes; its other inputs stay in caches.
#include "gpu/buffers_io.h"
#include "bind/bind.glsl"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"

WORKGROUP_OF_STRIDE(kBindWorkgroupSize);
READONLY_BUFFER(kModelBuffer, StoredAffine, model);
TABLE_OF_WORDS(kPaletteJointsBuffer, palette_joints);
TABLE_OF_ROWS(kJointFromBindBuffer, joint_from_bind);
CONSTANT(1, uint, kSkinFormat, kSkinAffine);
CONSTANT(2, bool, kVaries, false);
PUSH(BindPush);

#define SKIN_STORES
#include "bind/skin_format.glsl"
#include "control/births.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    if (kVaries && is_free(instance)) return;
    for (uint entry = gl_LocalInvocationID.x; entry < push.palette_count; entry += kStride) {
        const Affine model_from_joint = unpack(model[instance * push.joint_count + WORD_AT(palette_joints, entry)]);
        store_skin(instance * push.palette_count + entry,
                   skin_matrix(model_from_joint, AFFINE_AT(joint_from_bind, entry)));
    }
}
