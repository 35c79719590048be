// fill: writes as many bytes as an update's skin matrices have, and reads nothing: the floor under every update.
// Neighbouring invocations write neighbouring rows, which is fastest on a GPU; the GPU_SOFTWARE variant is fastest on a
// software device.
#include "gpu/stored.glsl"

#ifdef GPU_SOFTWARE
#define Row u64vec2
#else
#define Row uvec4
#endif

WORKGROUP_OF_CONSTANT;
CONSTANT(1, uint, kRowsPerInvocation, 4);
WRITEONLY_BUFFER(0, Row, to);
layout(push_constant) uniform Push { uint row_count; };

void main() {
    uint row = gl_WorkGroupID.x * gl_WorkGroupSize.x * kRowsPerInvocation + gl_LocalInvocationID.x;
    for (uint i = 0; i < kRowsPerInvocation && row < row_count; ++i, row += gl_WorkGroupSize.x) to[row] = Row(row);
}
