// pyramid: a level of a depth pyramid from the one before it, or from the picture. One invocation for each texel that
// is written, or for several.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"

WORKGROUP(kCullWorkgroupSize);
READONLY_BUFFER(kDepthsBuffer, float, fine);
WRITEONLY_BUFFER(kCoarserDepthsBuffer, float, coarse);
PUSH(PyramidPush);

void main() {
    const uint width = (push.width + 1) / 2, count = width * ((push.height + 1) / 2),
               stride = gl_NumWorkGroups.x * kCullWorkgroupSize;
    for (uint i = gl_GlobalInvocationID.x; i < count; i += stride) {
        const uint column = 2 * (i % width), row = 2 * (i / width);
        const uint right = min(column + 1, push.width - 1), below = min(row + 1, push.height - 1);
        const uint first = push.first_read + row * push.width, second = push.first_read + below * push.width;
        const vec4 four = push.sign *
                          vec4(fine[first + column], fine[first + right], fine[second + column], fine[second + right]);
        coarse[push.first_written + i] = min(min(four.x, four.y), min(four.z, four.w));
    }
}
