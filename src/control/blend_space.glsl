// The clips of a play and their weights: step 4 of docs/controller.md. C++ too (gpu/glsl.h). The includer declares
// parameter_at(index), `layout_of_group`, the functions of control/tables.glsl and those of control/rounded.glsl.

// Up to three clips that share a phase. Unused ones have weight 0; if a state plays nothing, all of them do.
struct ClipMix {
    uvec3 clips;
    vec3 weights;
    float rate;  // cycles a second
    uint loop;
    uint sync;
    bool backwards;  // the state's speed is negative, so it begins at its end
};

// A `do` loop that begins with a `break`: on a software device, a `while` loop runs one extra round for all
// invocations. Without the `break`, invocations that have left the loop get values of its further rounds on SwiftShader
// (docs/devices.md).
void mix_line(INOUT(ClipMix) clip_mix, ControlState state, float x) {
    uint i = 0, k = 1;
    do {
        if (k >= state.point_count) break;
        if (load_point(state.first_point + k).x <= x) i = k;
    } while (++k < state.point_count);
    const ControlPoint point = load_point(state.first_point + i);
    const float t = clamp(product(difference(x, point.x), point.inverse_span), 0, 1);
    clip_mix.clips = uvec3(i, min(i + 1, state.point_count - 1), 0);
    clip_mix.weights = vec3(difference(1, t), t, 0);
}

const float kCrack = 1.0 / 65536;  // rounding must open no crack between two triangles

// The first triangle around (x, y), if there is one.
bool mix_triangle(INOUT(ClipMix) clip_mix, ControlState state, float x, float y) {
    uint k = 0;
    do {
        if (k >= state.triangle_count) break;
        const ControlTriangle triangle = load_triangle(state.first_triangle + k);
        const float u = sum(sum(product(triangle.ax, x), product(triangle.ay, y)), triangle.a0);
        const float v = sum(sum(product(triangle.bx, x), product(triangle.by, y)), triangle.b0);
        const float w = difference(difference(1, u), v);
        if (u >= -kCrack && v >= -kCrack && w >= -kCrack) {
            clip_mix.clips = uvec3(triangle.a, triangle.b, triangle.c);
            clip_mix.weights = max(vec3(u, v, w), vec3(0));
            return true;
        }
    } while (++k < state.triangle_count);
    return false;
}

// The nearest place on the hull.
void mix_edge(INOUT(ClipMix) clip_mix, ControlState state, float x, float y) {
    float nearest = uintBitsToFloat(0x7F800000u);
    uint k = 0;
    do {
        if (k >= state.edge_count) break;
        const ControlEdge edge = load_edge(state.first_edge + k);
        const ControlPoint a = load_point(state.first_point + edge.a), b = load_point(state.first_point + edge.b);
        const float dx = difference(x, a.x), dy = difference(y, a.y);
        const float t = clamp(sum(product(dx, edge.dx), product(dy, edge.dy)), 0, 1);
        const float ex = difference(dx, product(t, difference(b.x, a.x)));
        const float ey = difference(dy, product(t, difference(b.y, a.y)));
        const float squared = sum(product(ex, ex), product(ey, ey));
        if (squared < nearest) {
            nearest = squared;
            clip_mix.clips = uvec3(edge.a, edge.b, 0);
            clip_mix.weights = vec3(difference(1, t), t, 0);
        }
    } while (++k < state.edge_count);
}

bool plays_nothing(ControlState state) { return load_point(state.first_point).clip == layout_of_group.clip_count; }

ClipMix mix_of_state(ControlState state) {
    ClipMix clip_mix = {uvec3(0), vec3(1, 0, 0), 0, state.loop, state.sync, state.speed < 0};
    if (state.y_parameter != kNone) {
        const float x = parameter_at(state.x_parameter), y = parameter_at(state.y_parameter);
        if (!mix_triangle(clip_mix, state, x, y)) mix_edge(clip_mix, state, x, y);
    } else if (state.x_parameter != kNone) {
        mix_line(clip_mix, state, parameter_at(state.x_parameter));
    }
    float rate = 0;
    for (uint k = 0; k < 3; ++k) {
        clip_mix.clips[k] = load_point(state.first_point + clip_mix.clips[k]).clip;
        rate = sum(rate, product(clip_mix.weights[k], load_clip(clip_mix.clips[k]).rate));
    }
    rate = product(rate, state.speed);
    if (state.speed_parameter != kNone) rate = product(rate, parameter_at(state.speed_parameter));
    clip_mix.rate = rate;
    if (plays_nothing(state)) clip_mix.weights.x = 0;
    return clip_mix;
}

ClipMix mix_of_play(ControlLayer layer, LayerPlay play) {
    ClipMix clip_mix = {uvec3(play.motion, 0, 0), vec3(1, 0, 0), play.speed, play.loop, kNone, false};
    if (layer.state_count > 0)
        clip_mix = mix_of_state(load_state(layer.first_state + play.motion));
    else
        clip_mix.rate = product(play.speed, load_clip(play.motion).rate);
    return clip_mix;
}

// The clip with the largest weight; the first of equals.
uint heaviest(ClipMix clip_mix) {
    uint k = 0;
    if (clip_mix.weights.y > clip_mix.weights[k]) k = 1;
    if (clip_mix.weights.z > clip_mix.weights[k]) k = 2;
    return clip_mix.clips[k];
}
