#version 460
// sample: the pose of every joint of one of the two clips of each instance. Skips instances whose clip has no weight.
// One workgroup per instance, joints in strides. Reads 16 bytes of table and up to 6 keys of 16 bytes a joint, writes 48 bytes.
#include "sample/sample_io.h"

layout(local_size_x = kSampleWorkgroupSize) in;
layout(set = 0, binding = 0, std430) readonly buffer Cursors { InstanceCursor cursors[]; };
layout(set = 0, binding = 1, std430) readonly buffer Tracks { uvec4 tracks[]; };
layout(set = 0, binding = 2, std430) readonly buffer Keys { vec4 keys[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Poses { JointPose poses[]; };
layout(push_constant) uniform Push { SamplePush push; };

#include "sample/sample.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    const InstanceCursor cursor = cursors[instance];
    const bool is_first = push.slot == 0;
    if ((is_first ? cursor.weight : 1 - cursor.weight) <= 0) return;
    const SlotCursor slot = is_first ? cursor.first : cursor.second;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kSampleWorkgroupSize)
        poses[instance * push.joint_count + joint] = sample_joint(tracks[slot.first_track + joint], slot);
}
