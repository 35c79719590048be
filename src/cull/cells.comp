// cells: the box around the boxes of consecutive instances. One invocation for each cell; cost: 48 bytes an instance.
#include "gpu/buffers_io.h"
#include "cull/cull_io.h"
#include "gpu/affine.glsl"
#include "gpu/table.glsl"

WORKGROUP(kCullWorkgroupSize);
TABLE_OF_ROWS(kPlacementsBuffer, placement_rows);  // world_from_model
WRITEONLY_BUFFER(kCellsBuffer, Cell, cells);
PUSH(CullPush);

void main() {
    const uint first = gl_GlobalInvocationID.x * kCullWorkgroupSize,
               end = min(first + kCullWorkgroupSize, push.instance_count);
    if (first >= end) return;
    const float most = 1e30, rounding = 1e-5;
    vec3 low = vec3(most), high = vec3(-most);
    for (uint instance = first; instance < end; ++instance) {
        const Affine placement = AFFINE_AT(placement_rows, instance);
        const vec3 middle = affine_point(placement, push.centre.xyz),
                   reach = vec3(dot(abs(placement.row0.xyz), push.half_extent.xyz),
                                dot(abs(placement.row1.xyz), push.half_extent.xyz),
                                dot(abs(placement.row2.xyz), push.half_extent.xyz));
        low = min(low, middle - reach);
        high = max(high, middle + reach);
    }
    const vec3 middle = 0.5 * low + 0.5 * high, reach = 0.5 * high - 0.5 * low;
    cells[gl_GlobalInvocationID.x] = Cell(vec4(middle, push.placements_version),
                                          vec4(reach + rounding * (abs(middle) + reach), 0));
}
