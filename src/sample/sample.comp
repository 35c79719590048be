// sample: the pose of every joint of one of the two clips of each instance. Skips instances whose clip has no weight.
// One workgroup per instance, joints in strides. Per joint it reads 16 bytes of table and up to 6 keys of 16 bytes
// (less if packed), and writes 48 bytes.
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"
#include "sample/sample_io.h"

WORKGROUP(kSampleWorkgroupSize);
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
TABLE_OF_ROWS(kTracksBuffer, tracks);
TABLE_OF_ROWS(kKeysBuffer, keys);
TABLE_OF_WORDS(kWordsBuffer, words);
WRITEONLY_BUFFER(kSampledPosesBuffer, JointPose, poses);
CONSTANT(1, bool, kPacked, false);
CONSTANT(2, bool, kVaries, false);
PUSH(SamplePush);

#include "control/births.glsl"
#include "sample/sample.glsl"

void main() {
    const uint instance = gl_WorkGroupID.x;
    if (kVaries && is_free(instance)) return;
    const InstanceCursor cursor = cursors[instance];
    const bool is_first = push.is_second == 0;
    if ((is_first ? cursor.weight : 1 - cursor.weight) <= 0) return;
    const ClipCursor chosen = is_first ? cursor.first : cursor.second;
    for (uint joint = gl_LocalInvocationID.x; joint < push.joint_count; joint += kSampleWorkgroupSize)
        poses[instance * push.joint_count + joint] = sample_joint(ROW_AT(tracks, chosen.first_track + joint), chosen);
}
