// Each invocation controls one character: it is born in the middle, walks outwards in its own direction, and is gone
// after four seconds, when another is born with the same number.
#version 460
#extension GL_GOOGLE_include_directive : require
#define THRONG_COMMAND_SET 0
#define THRONG_COMMAND_BINDING 0
#include "throng/commands.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
    uint count, clip_count;
    float time_s, time_step_s;
    float size;  // of a character
};

const float kLife_s = 4;

// A pseudo-random value for each number, 0..1.
float chance_of(uint number) {
    uint bits = number * 747796405u + 2891336453u;
    bits = (bits >> (bits >> 28) + 4 ^ bits) * 277803737u;
    return float(bits >> 8) / 16777216.0;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    const float age_s = time_s - kLife_s * chance_of(i);  // of its first life, which begins in the first four seconds
    if (age_s < 0) return;
    const uint life = uint(age_s / kLife_s);
    const float since_s = age_s - kLife_s * float(life);
    const float angle = 6.2831853 * chance_of(i + 7919 * life + 1), c = cos(angle), s = sin(angle);
    const float way = size * (1 + since_s);
    const vec4 world_from_model[3] = vec4[3](vec4(c, 0, s, s * way), vec4(0, 1, 0, 0), vec4(-s, 0, c, c * way));
    if (since_s >= time_step_s) {
        throng_set_placement(i, world_from_model);
    } else {
        throng_spawn(i, world_from_model);
        const uint clip = clip_count > 0 ? i % clip_count : kThrongRestPose;
        throng_set_playback(i, throng_clip(clip, true, since_s, 1), throng_clip(kThrongRestPose, false, 0, 0), 1);
    }
    if (since_s > 0.95 * kLife_s) throng_despawn(i);
}
