// The movement that an agent wants, and the limits that others set to it: docs/steering.md.

// An agent takes others into account within this many times the distance at which they touch. A cell of a grid is that
// wide for two of the grid's largest agents
const float kReach = 2;
// How strongly an agent avoids one that it nearly coincides with, as a multiple of its full speed
const float kAvoidance = 6;
const float kPassing = 1.5;         // how strongly it passes on the right, as a multiple of the avoidance
const float kHorizon_s = 0.25;      // in this time it covers at most half of the gap to another agent
const float kArrival_s = 1;         // it starts to slow down this long before it arrives
const float kAcceleration = 2;      // per second, as a multiple of its full speed
const float kMinWish = 0.05;        // fraction of its full speed: a weaker wish counts as none
const float kFastSpeed = 10;        // radii a second: caps the full speed that kMinWish is a fraction of
const float kHeldUpFraction = 0.3;  // fraction of the desired speed: an agent that is slower counts as held up
const float kPatience_s = 3.3333333, kRecovery_s = 2;  // time until patience runs out, and until it is restored
const float kMinWidth = 0.75;                          // Agent::width of an agent without patience
const float kFixed = 1048576;                          // fixed-point scale: sums of integers do not depend on the order

struct Agent {
    uint index;
    vec2 place, heading;
    float radius, full_speed, time_step_s;
    // Set by aim()
    bool stands;      // it has arrived
    float remaining;  // to the destination
    vec2 ahead;       // the direction to it, of length 1; 0 for an agent that stands
    float comfort;    // how much distance it keeps beyond touching, 0..1
    float width;      // the least distance that it keeps, as a fraction of that at which agents touch
};

// The effect of all other agents on one agent. Does not depend on the order in which they are met.
struct Met {
    ivec2 push;  // in 1 / kFixed
    float speed_limit;
};

// A pseudo-random direction for each agent, to separate agents at the same place.
vec2 direction_of(uint agent) {
    const uint mixed = agent * 2654435769u, both = mixed ^ mixed >> 15;
    return normalize(vec2(both & 0xFFFFu, both >> 16) - 32767.25);
}

void meet(Agent agent, vec2 other_place, float other_radius, INOUT(Met) met) {
    const vec2 way = other_place - agent.place;
    const float apart = length(way), touching = agent.radius + other_radius, closest = touching * agent.width;
    if (apart >= kReach * touching) return;
    const vec2 towards = apart > 0 ? way / apart : -direction_of(agent.index);
    const float approach = dot(agent.heading, towards);
    if (apart > 0 && approach > 0)
        met.speed_limit = min(met.speed_limit,
                              max(apart - closest, 0) / (2 * max(agent.time_step_s, kHorizon_s) * approach));
    const float nearness = max(1 - apart / (closest * (1 + (kReach - 1) * agent.comfort)), 0);
    const vec2 right = vec2(-towards.y, towards.x);
    met.push += ivec2(
        round((kPassing * max(dot(towards, agent.ahead), 0) * right - towards) * (nearness * nearness * kFixed)));
}

// `way`: from the agent to its destination. A standing agent moves again once it has been pushed two radii away.
void aim(INOUT(Agent) agent, vec2 way, AgentState state) {
    agent.remaining = length(way);
    agent.stands = agent.remaining < (state.stands != 0 ? 2 : 1) * agent.radius;
    agent.ahead = agent.stands ? vec2(0) : way / agent.remaining;
    agent.comfort = agent.stands ? 0 : min(agent.remaining / (3 * agent.radius), 1);
    agent.width = mix(kMinWidth, 1, state.patience);
}

// The speed at which it would go to its destination without other agents.
float hurry_of(Agent agent) { return agent.stands ? 0 : min(agent.full_speed, agent.remaining / kArrival_s); }

// The velocity that it wants, in world units a second over the ground.
vec2 wish_of(Agent agent, Met met) {
    vec2 wish = hurry_of(agent) * agent.ahead + vec2(met.push) * (kAvoidance * agent.full_speed / kFixed);
    const float eagerness = length(wish);
    if (eagerness < kMinWish * min(agent.full_speed, kFastSpeed * agent.radius)) wish = vec2(0);
    if (eagerness > agent.full_speed) wish *= agent.full_speed / eagerness;
    return wish;
}

// An agent moves only in the direction that it faces.
AgentState state_after(Agent agent, Met met, vec2 wish, AgentState before) {
    float speed = min(max(dot(wish, agent.heading), 0),
                      min(met.speed_limit, before.speed + kAcceleration * agent.full_speed * agent.time_step_s));
    speed = min(speed, (agent.stands ? agent.radius : min(agent.remaining, agent.radius)) / agent.time_step_s);
    const bool is_held_up = !agent.stands && speed < kHeldUpFraction * hurry_of(agent);
    const float change = agent.time_step_s * (is_held_up ? -1 / kPatience_s : 1 / kRecovery_s);
    return AgentState(speed, clamp(before.patience + change, 0, 1), agent.stands ? 1 : 0);
}

// A turn about +y of model space, as (cosine, sine), towards a direction over the ground; no further than `largest`.
vec2 turn_towards(vec2 world_direction, vec4 x_axis, vec4 z_axis, vec2 largest) {
    const float determinant = x_axis.x * z_axis.z - x_axis.z * z_axis.x;
    const vec2 model = vec2(z_axis.z * world_direction.x - z_axis.x * world_direction.y,
                            x_axis.x * world_direction.y - x_axis.z * world_direction.x) *
                       sign(determinant);
    const float size = length(model);
    if (!(size > 0)) return vec2(1, 0);
    const vec2 wanted = vec2(model.y, model.x) / size;
    return wanted.x >= largest.x ? wanted : vec2(largest.x, wanted.y < 0 ? -largest.y : largest.y);
}
