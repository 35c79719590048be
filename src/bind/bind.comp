#version 460
// bind: skin matrix = model_from_joint * joint_from_bind, for every palette entry of every instance.
// One workgroup per instance, entries in strides. Reads 48 bytes of model matrix an entry, writes 48; the rest stays in caches.
#include "bind/bind.glsl"

layout(local_size_x = kBindWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Model { Affine model[]; };
layout(set = 0, binding = 1, std430) readonly buffer PaletteJoints { uint palette_joints[]; };
layout(set = 0, binding = 2, std430) readonly buffer JointFromBind { Affine joint_from_bind[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Skin { Affine skin[]; };
layout(push_constant) uniform Push { BindPush push; };

void main() {
    const uint instance = gl_WorkGroupID.x;
    for (uint entry = gl_LocalInvocationID.x; entry < push.palette_count; entry += kBindWorkgroupSize) {
        const Affine model_from_joint = model[instance * push.joint_count + palette_joints[entry]];
        skin[instance * push.palette_count + entry] = skin_matrix(model_from_joint, joint_from_bind[entry]);
    }
}
