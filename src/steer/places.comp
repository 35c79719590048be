// places: stores the positions of all agents, and links the agents of each bucket into a list. The order within a list
// is nondeterministic; it can affect results only where a bucket has more than kMaxMet agents (docs/steering.md). One
// invocation per agent. Cost: 8 bytes of a placement read, 16 written, one atomic exchange. Source: S. Green, Particle
// Simulation using CUDA, NVIDIA 2008 (the grid by atomics). Difference: lists instead of a fixed number of places for
// each cell.
#include "gpu/buffers_io.h"
#include "control/births.glsl"
#include "steer/grid.glsl"

WORKGROUP(kSteerWorkgroupSize);
// world_from_model, three rows each
READONLY_BUFFER(kPlacementsBuffer, vec4, placements);
WRITEONLY_BUFFER(kAgentPlacesBuffer, AgentPlace, places);
BUFFER(kAgentBucketsBuffer, uint, heads);
PUSH(PlacesPush);

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
    const vec2 place = vec2(placements[3 * instance].w, placements[3 * instance + 2].w);
    const uint agent = push.first_agent + instance;
    const uint next = atomicExchange(heads[bucket_of(push.grid, cell_of(place, push.inverse_cell), push.bucket_mask)],
                                     agent);
    places[agent] = AgentPlace(place.x, place.y, push.radius, next);
}
