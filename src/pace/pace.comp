#version 460
// pace: takes the skin matrices of instances that are not animated in this update towards those of the pose that they were animated ahead to; defined by pace_reference.h. One workgroup per instance.
// Cost: 96 bytes read and 48 written for each affine matrix.
#include "cull/cull_io.h"
#include "bind/bind_io.h"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"
#include "pace/pace_io.h"

layout(local_size_x = kPaceWorkgroupSize) in;
TABLE_OF_WORDS(0, Work, work);
layout(set = 0, binding = 1, std430) readonly buffer States { uint states[]; };
// [instance][row]: rows of four floats, or of four halves. Where previous matrices are not kept, current is previous.
layout(set = 0, binding = 2, std430) readonly buffer PreviousRows { StoredRow previous_rows[]; };
layout(set = 0, binding = 2, std430) readonly buffer PreviousHalves { StoredPair previous_halves[]; };
layout(set = 0, binding = 3, std430) readonly buffer AheadRows { StoredRow ahead_rows[]; };
layout(set = 0, binding = 3, std430) readonly buffer AheadHalves { StoredPair ahead_halves[]; };
layout(set = 0, binding = 4, std430) writeonly buffer CurrentRows { StoredRow current_rows[]; };
layout(set = 0, binding = 4, std430) writeonly buffer CurrentHalves { StoredPair current_halves[]; };
layout(constant_id = 1) const uint kSkinFormat = kSkinAffine;
layout(push_constant) uniform Push { PacePush push; };

vec4 floats(StoredPair row) {
    const uvec2 pair = unpack(row);
    return vec4(unpackHalf2x16(pair.x), unpackHalf2x16(pair.y));
}

// `step`: 0 stays, 1 arrives; what it does not go to may hold anything.
vec4 went_on(vec4 previous, vec4 ahead, uint step, bool is_rotation) {
    if (step == 0) return previous;
    if (step == 1) return ahead;
    const float side = is_rotation && dot(previous, ahead) < 0 ? -1 : 1;
    const vec4 row = previous + (side * ahead - previous) / float(step);
    return is_rotation ? row * inversesqrt(dot(row, row)) : row;
}

void main() {
    const uint instance = WORD_AT(work, WORD_AT(work, 2 * push.section) + gl_WorkGroupID.x);
    const uint step = push.section == kGoingOn ? states[instance] >> kStateStepShift & kStateStepMask : 0;
    for (uint row = gl_LocalInvocationID.x; row < push.row_count; row += kPaceWorkgroupSize) {
        const uint at = instance * push.row_count + row;
        if (kSkinFormat == kSkinHalfAffine) {
            const vec4 halves = went_on(floats(previous_halves[at]), floats(ahead_halves[at]), step, false);
            current_halves[at] = pack(uvec2(packHalf2x16(halves.xy), packHalf2x16(halves.zw)));
        } else {
            current_rows[at] = pack(went_on(unpack(previous_rows[at]), unpack(ahead_rows[at]), step, kSkinFormat == kSkinSimilarity && row % 2 == 0));
        }
    }
}
