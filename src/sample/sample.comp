#version 460
// sample: the pose of every joint of one of the two clips of each instance. Skips instances whose clip has no weight.
// One workgroup per instance, joints in strides. Reads 16 bytes of table and up to 6 keys of 16 bytes a joint, packed
// ones fewer; writes 48 bytes.
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"
#include "sample/sample_io.h"

layout(local_size_x = kSampleWorkgroupSize) in;
layout(set = 0, binding = kCursorsBuffer, std430) readonly buffer Cursors { InstanceCursor cursors[]; };
TABLE_OF_ROWS(kTracksBuffer, Tracks, tracks);
TABLE_OF_ROWS(kKeysBuffer, Keys, keys);
TABLE_OF_WORDS(kWordsBuffer, Words, words);
layout(set = 0, binding = kSampledPosesBuffer, std430) writeonly buffer Poses { JointPose poses[]; };
layout(constant_id = 1) const bool kPacked = false;
layout(push_constant) uniform Push { SamplePush push; };

#include "sample/sample.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    const InstanceCursor cursor = cursors[instance];
    const bool is_first = push.slot == 0;
    if ((is_first ? cursor.weight : 1 - cursor.weight) <= 0) return;
    const SlotCursor slot = is_first ? cursor.first : cursor.second;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kSampleWorkgroupSize)
        poses[instance * push.joint_count + joint] = sample_joint(ROW_AT(tracks, slot.first_track + joint), slot);
}
