// terrain: puts instances on the ground: sets the world y of their placements to the terrain's height there. One
//   invocation per instance. Cost: 48 bytes of a placement and four heights read, 16 bytes written.
#include "gpu/buffers_io.h"
#include "steer/terrain_io.h"

WORKGROUP(kTerrainWorkgroupSize);
// world_from_model, three rows each
BUFFER(kPlacementsBuffer, vec4, placements);
READONLY_BUFFER(kHeightsBuffer, float, heights);
CONSTANT(1, bool, kVaries, false);
PUSH(TerrainPush);

#include "control/births.glsl"

// Bilinear between four points. Places beyond the edges are clamped to them.
float height_at(vec2 place) {
    const vec2 last = vec2(push.columns - 1, push.rows - 1);
    const vec2 at = clamp((place - vec2(push.x, push.z)) * push.inverse_spacing, vec2(0), last);
    const vec2 share = fract(at);
    const uvec2 end = uvec2(push.columns - 1, push.rows - 1);  // `last` may have been rounded up
    const uvec2 l = min(uvec2(at), end), h = min(l + 1, end);
    return mix(mix(heights[l.y * push.columns + l.x], heights[l.y * push.columns + h.x], share.x),
               mix(heights[h.y * push.columns + l.x], heights[h.y * push.columns + h.x], share.x), share.y);
}

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || (kVaries && is_free(instance))) return;
    const vec2 place = vec2(placements[3 * instance].w, placements[3 * instance + 2].w);
    placements[3 * instance + 1].w = height_at(place);
}
