// What an agent wants, and how much of that the others leave it: docs/steering.md.

// Others are met from so many times the distance at which they touch; the width of a cell is that of its largest two
const float kReach = 2;
// As a part of its speed: how strongly it goes out of the way of one that it all but coincides with
const float kShyness = 6;
const float kPassing = 1.5;     // as a part of that: how strongly it passes on the right
const float kHorizon_s = 0.25;  // of the way that there is to somebody, it takes half in so many seconds
const float kArrival_s = 1;     // it slows down so long before it arrives
const float kAcceleration = 2;  // of its speed, a second
const float kLeastWish = 0.05;  // of its speed: less counts as none
const float kFast = 10;         // radii a second, beyond which speed does not count for that
const float kHeldUp = 0.3;      // of the speed that it wants
const float kPatience_s = 3.3333333, kRecovery_s = 2;  // until none is left, until all is there again
const float kSlimmest = 0.75;  // of the distance at which agents touch, for one without patience
const float kFixed = 1048576;  // steps in 1: integers add up to the same in any order

struct Agent {
    uint index;
    vec2 place, heading;
    float radius;
    vec2 ahead;     // to the destination, of length 1; of one that stands 0
    float comfort;  // how far from touching others it wants to be, 0..1
    float width;    // of the distance at which agents touch
    float time_step_s;
};

// What the others do to it, in whatever order they are met.
struct Met {
    ivec2 push;  // in 1 / kFixed
    float speed_limit;
};

// For those that share a place.
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
