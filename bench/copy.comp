// copy: the same bytes as a scan of 3x4 matrices, 48 read and 48 written a joint, and nothing else: the floor under
// every method. Neighbouring invocations copy neighbouring rows, which is fastest on a GPU; the GPU_SOFTWARE variant is
// fastest on a software device.
#include "gpu/stored.glsl"

#ifdef GPU_SOFTWARE
#define Row u64vec2
#else
#define Row vec4
#endif

WORKGROUP_OF_CONSTANT;
CONSTANT(1, uint, kRowsPerInvocation, 3);
READONLY_BUFFER(0, Row, from);
WRITEONLY_BUFFER(1, Row, to);
layout(push_constant) uniform Push { uint row_count; };

void main() {
    uint row = gl_WorkGroupID.x * gl_WorkGroupSize.x * kRowsPerInvocation + gl_LocalInvocationID.x;
    for (uint i = 0; i < kRowsPerInvocation && row < row_count; ++i, row += gl_WorkGroupSize.x) to[row] = from[row];
}
