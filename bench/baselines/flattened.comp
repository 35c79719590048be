// flattened: the hierarchy is removed offline, so that clips hold each joint's pose in model space; sampled, blended
//   and bound there.
// Source: J. Shopf, J. Barczak, C. Oat, N. Tatarchuk, March of the Froblins, SIGGRAPH course notes, 2008.
// Difference: rotation, translation and scale with throng's own interpolation (its functions, included), so that only
//   the space makes the difference.
// Input: keys[clip][row][track], model_from_joint as rotation, translation, scale.
// Output: skin[instance][entry], model_from_bind.
// Needs: rigs whose scales do not shear; up to 48 bytes a joint and row, tracks that stand still only once; no
//   hierarchy.
// Cost: reads two rows a clip, writes a matrix, one multiplication a palette entry; no barrier, and nothing between the
//   stages.
// Wins: speed, at any depth.
// Loses: shape: joints go from pose to pose on straight lines, each on its own, so that a chain that bends differently
//   in two clips comes apart and shrinks between them.
// Measured: bench/README.md#baselines
#include "gpu/buffers_io.h"
#include "baselines_io.h"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"
#include "blend/blend.glsl"

WORKGROUP(kBaselineWorkgroupSize);
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
TABLE_OF_ROWS(kTracksBuffer, tracks);
TABLE_OF_ROWS(kKeysBuffer, keys);
READONLY_BUFFER(kPaletteJointsBuffer, uint, palette_joints);
READONLY_BUFFER(kJointFromBindBuffer, StoredAffine, joint_from_bind);
WRITEONLY_BUFFER(kSkinBuffer, StoredAffine, skin);
PUSH(BaselinePush);

#include "sample/exact.glsl"

JointPose sample_clip(ClipCursor cursor, uint joint) {
    return sample_exact(ROW_AT(tracks, cursor.first_track + joint), cursor);
}

void main() {
    const uint instance = gl_WorkGroupID.x;
    const InstanceCursor cursor = cursors[instance];
    for (uint entry = gl_LocalInvocationID.x; entry < push.palette_count; entry += kBaselineWorkgroupSize) {
        const uint joint = palette_joints[entry];
        JointPose pose;
        if (cursor.weight >= 1)
            pose = sample_clip(cursor.first, joint);
        else if (cursor.weight <= 0)
            pose = sample_clip(cursor.second, joint);
        else
            pose = blend_joint(sample_clip(cursor.first, joint), sample_clip(cursor.second, joint), cursor.weight);
        const Affine model_from_joint = parent_from_joint(pose);  // its only parent is the model
        skin[instance * push.palette_count + entry] = pack(
            affine_multiply(model_from_joint, unpack(joint_from_bind[entry])));
    }
}
