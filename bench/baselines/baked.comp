// baked: every frame of every clip is stored as skin matrices; two frames are fetched and interpolated, matrix by
//   matrix.
// Source: B. Dudash, Skinned Instancing, NVIDIA white paper, 2007.
// Difference: storage buffers and a compute shader, while the source fetches from a texture in the vertex shader; a
//   second clip can be blended in, as linearly as everything else here.
// Input: frames[clip][frame][entry], model_from_bind, affine 3x4.   Output: skin[instance][entry], model_from_bind.
// Needs: 48 bytes a palette entry and frame, in one buffer; no hierarchy.
// Cost: reads two matrices a clip and palette entry, writes one; no multiplication of matrices, no barrier.
// Wins: speed, at any depth.
// Loses: memory, and shape: a sum of rotations is no rotation, so limbs shrink between frames that lie far apart, and
//   above all between clips.
// Measured: bench/README.md#baselines
#include "gpu/buffers_io.h"
#include "baselines_io.h"
#include "gpu/stored.glsl"

WORKGROUP(kBaselineWorkgroupSize);
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
READONLY_BUFFER(kTracksBuffer, uvec4, tracks);  // one a clip: its first matrix
READONLY_BUFFER(kKeysBuffer, StoredAffine, frames);
WRITEONLY_BUFFER(kSkinBuffer, StoredAffine, skin);
PUSH(BaselinePush);

Affine mix_matrices(Affine a, Affine b, float w) {
    return Affine(mix(a.row0, b.row0, w), mix(a.row1, b.row1, w), mix(a.row2, b.row2, w));
}

Affine sample_clip(ClipCursor cursor, uint entry) {
    const uint first = tracks[cursor.first_track].x + entry;
    return mix_matrices(unpack(frames[first + cursor.earlier]), unpack(frames[first + cursor.later]), cursor.fraction);
}

void main() {
    const uint instance = gl_WorkGroupID.x;
    const InstanceCursor cursor = cursors[instance];
    for (uint entry = gl_LocalInvocationID.x; entry < push.palette_count; entry += kBaselineWorkgroupSize) {
        Affine model_from_bind;
        if (cursor.weight >= 1)
            model_from_bind = sample_clip(cursor.first, entry);
        else if (cursor.weight <= 0)
            model_from_bind = sample_clip(cursor.second, entry);
        else
            model_from_bind = mix_matrices(sample_clip(cursor.second, entry), sample_clip(cursor.first, entry),
                                           cursor.weight);
        skin[instance * push.palette_count + entry] = pack(model_from_bind);
    }
}
