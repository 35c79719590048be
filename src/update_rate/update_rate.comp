// update_rate: interpolates the skin matrices of instances that are not animated in this update towards those of a
// later pose that was computed ahead; defined by update_rate_reference.h. One workgroup per instance. Cost: 100 bytes
// read and 48 written for each affine matrix of the joints that the instance's level of detail has.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"
#include "bind/bind_io.h"
#include "gpu/stored.glsl"
#include "gpu/table.glsl"
#include "update_rate/update_rate_io.h"

WORKGROUP_OF_STRIDE(kUpdateRateWorkgroupSize);
TABLE_OF_WORDS(kWorkBuffer, work);
READONLY_BUFFER(kStatesBuffer, uint, states);
// [instance][row]: rows of four floats, or of four halves, of which a row of the table holds two. If previous matrices
// are not kept, previous and current are the same buffer.
TABLE_OF_ROWS(kPreviousSkinBuffer, previous_rows);
TABLE_OF_ROWS(kSkinTargetBuffer, target_rows);
WRITEONLY_BUFFER(kSkinBuffer, StoredRow, current_rows);
WRITEONLY_BUFFER(kSkinBuffer, StoredPair, current_halves);
TABLE_OF_WORDS(kPaletteBySetBuffer, entries);
CONSTANT(1, uint, kSkinFormat, kSkinAffine);
PUSH(UpdateRatePush);

vec4 floats(uvec4 two, uint at) {
    const uvec2 pair = (at & 1) != 0 ? two.zw : two.xy;
    return vec4(unpackHalf2x16(pair.x), unpackHalf2x16(pair.y));
}

// `step`: 0 returns `previous`, 1 returns `target`; the operand that is not returned may hold anything. Otherwise goes
// 1 / step of the way.
vec4 interpolated(vec4 previous, vec4 target, uint step, bool is_rotation) {
    if (step == 0) return previous;
    if (step == 1) return target;
    const float side = is_rotation && dot(previous, target) < 0 ? -1 : 1;
    const vec4 row = previous + (side * target - previous) / float(step);
    return is_rotation ? row * inversesqrt(dot(row, row)) : row;
}

void main() {
    const uint instance = WORD_AT(work, WORD_AT(work, 2 * push.section) + gl_WorkGroupID.x);
    const uint step = push.section == kInterpolated ? states[instance] >> kStateStepShift & kStateStepMask : 0;
    const uint rows = kSkinFormat == kSkinSimilarity ? 2 : 3;  // of a matrix
    const uint row_count = push.entry_counts[states[instance] >> kStateSetShift] * rows;
    for (uint i = gl_LocalInvocationID.x; i < row_count; i += kStride) {
        const uint row = i % rows, at = (instance * push.palette_count + WORD_AT(entries, i / rows)) * rows + row;
        if (kSkinFormat == kSkinHalfAffine) {
            const vec4 halves = interpolated(floats(ROW_AT(previous_rows, at / 2), at),
                                             floats(ROW_AT(target_rows, at / 2), at), step, false);
            current_halves[at] = pack(uvec2(packHalf2x16(halves.xy), packHalf2x16(halves.zw)));
        } else {
            current_rows[at] = pack(interpolated(uintBitsToFloat(ROW_AT(previous_rows, at)),
                                                 uintBitsToFloat(ROW_AT(target_rows, at)), step,
                                                 kSkinFormat == kSkinSimilarity && row == 0));
        }
    }
}
