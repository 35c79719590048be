// steer: moves each agent a step towards its destination while avoiding others, and turns it towards where it wants to
// go. Agents that are carried by their clips only turn and output the speed that they want. One invocation per agent.
// Cost: docs/steering.md; 92 bytes read, 60 written, and 4 read for each bucket, 16 for each agent in it. Source: C.
// Reynolds, Steering Behaviors for Autonomous Characters, GDC 1999 (arrival, separation). Difference: a speed limit
// that keeps any two agents from touching, whatever they want (without patience they come as near as 0.75 of that
// distance); passing on the right; patience.
#include "gpu/buffers_io.h"
#include "control/births.glsl"
#include "gpu/ground.glsl"
#include "control/controller_io.h"
#include "steer/grid.glsl"
#include "steer/steer.glsl"

WORKGROUP(kSteerWorkgroupSize);
TABLE_OF_ROWS(kAgentPlacesBuffer, places);
TABLE_OF_WORDS(kAgentBucketsBuffer, heads);
READONLY_BUFFER(kDestinationsBuffer, vec4, destinations);
BUFFER(kAgentsBuffer, AgentState, states);
BUFFER(kPlacementsBuffer, vec4, placements);  // world_from_model, three rows each
BUFFER(kRootsBuffer, RootState, roots);
WRITEONLY_BUFFER(kParametersBuffer, float, parameters);
PUSH(SteerPush);

uint instance;

// A bucket may hold agents of other cells and grids, and two of the searched cells may share a bucket. So each agent's
// size and cell are checked.
void meet_cell(Agent agent, uint grid, ivec2 cell, INOUT(Met) met) {
    const float smaller = grid + 1 < push.grid_count ? push.largest[grid + 1] : 0;
    uint other = WORD_AT(heads, bucket_of(grid, cell, push.bucket_mask));
    for (uint count = 0; other != kNone && count < kMaxMet; ++count) {
        const uvec4 row = ROW_AT(places, other);
        const vec2 place = uintBitsToFloat(row.xy);
        const float radius = uintBitsToFloat(row.z);
        if (other != agent.index && radius > smaller && radius <= push.largest[grid] &&
            cell_of(place, push.inverse_cells[grid]) == cell)
            meet(agent, place, radius, met);
        other = row.w;
    }
}

// A cell is as wide as the distance at which two of its grid's largest agents meet. So in its own grid, and in grids of
// larger agents, an agent can only meet those in the nine cells around it. Grids of smaller agents have smaller cells;
// there it searches as many cells as its own size requires.
Met meet_all(Agent agent) {
    Met met = Met(ivec2(0), push.speed);
    for (uint grid = 0; grid < push.grid_count; ++grid) {
        const float largest = push.largest[grid], reach = kReach * (agent.radius + largest);
        const int cells = agent.radius <= largest
                              ? 1
                              : int(min(ceil(reach * push.inverse_cells[grid]), float(kAgentCellLimit)));
        const ivec2 centre = cell_of(agent.place, push.inverse_cells[grid]);
        for (int z = -cells; z <= cells; ++z)
            for (int x = -cells; x <= cells; ++x) meet_cell(agent, grid, centre + ivec2(x, z), met);
    }
    return met;
}

void report_speed(float model_speed) {
    if (push.speed_parameter != kNone) parameters[instance * push.parameter_count + push.speed_parameter] = model_speed;
}

void stop(AgentState state) {
    report_speed(0);
    if (state.speed == 0 && state.patience == 1 && state.stands == 0) return;
    states[instance] = AgentState(0, 1, 0);
}

// Rescales the turned axes, so that rounding does not change their lengths over many updates.
void write_placement(vec4 x_axis, vec4 z_axis, vec3 shift, vec2 turn) {
    const vec3 x = turn.x * x_axis.xyz - turn.y * z_axis.xyz, z = turn.y * x_axis.xyz + turn.x * z_axis.xyz;
    const float mend = sqrt((dot(x_axis.xyz, x_axis.xyz) + dot(z_axis.xyz, z_axis.xyz)) / (dot(x, x) + dot(z, z)));
    for (int row = 0; row < 3; ++row) {
        const vec4 before = placements[3 * instance + row];
        placements[3 * instance + row] = vec4(mend * x[row], before.y, mend * z[row], before.w + shift[row]);
    }
}

void main() {
    instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
    AgentState state = states[instance];
    if (is_newborn(instance, push.birth)) {
        state = AgentState(0, 1, 0);
        states[instance] = state;
    }
    if (!(push.time_step_s > 0)) return;
    const vec4 destination = destinations[instance];
    const vec4 row0 = placements[3 * instance], row1 = placements[3 * instance + 1],
               row2 = placements[3 * instance + 2];
    const vec4 x_axis = vec4(row0.x, row1.x, row2.x, 0), z_axis = vec4(row0.z, row1.z, row2.z, 0);
    Agent agent;
    agent.index = push.first_agent + instance;
    agent.place = vec2(row0.w, row2.w);
    agent.radius = uintBitsToFloat(ROW_AT(places, agent.index).z);
    agent.full_speed = push.speed;
    agent.time_step_s = push.time_step_s;
    const float scale = length(z_axis), upright = length(z_axis.xz);
    const vec2 way = destination.xz - agent.place;
    if (!(destination.w > 0) || !(length(way) < 1e30) || !(upright > 1e-6 * scale)) {
        stop(state);
        return;
    }
    agent.heading = z_axis.xz / upright;
    aim(agent, way, state);
    const Met met = meet_all(agent);
    const vec2 wish = wish_of(agent, met);
    state = state_after(agent, met, wish, state);
    states[instance] = state;
    report_speed(state.speed / scale);

    const vec2 turn = turn_towards(wish, x_axis, z_axis, vec2(push.turn_cos, push.turn_sin));
    if (push.is_carried != 0) {
        const vec4 place = turned_to_length_one(compose_places(roots[instance].place, vec4(0, 0, turn)));
        roots[instance].place = place;
        for (uint row = 0; row < 3; ++row)
            placements[3 * instance + row] = placed_row(roots[instance].base[row], place);
    } else {
        const vec2 shift = agent.heading * (state.speed * push.time_step_s);
        write_placement(x_axis, z_axis, vec3(shift.x, 0, shift.y), turn);
    }
}
