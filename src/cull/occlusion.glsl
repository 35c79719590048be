// Whether a box is hidden; defined by occlusion_reference.h. The includer declares `pyramid` (cull/cull_io.h) and
// `push.width`, `push.height`, the size of the picture.

vec4 to_clip(CullView view, vec4 point) {
    return vec4(dot(view.clip_from_world[0], point), dot(view.clip_from_world[1], point),
                dot(view.clip_from_world[2], point), dot(view.clip_from_world[3], point));
}

vec4 column_to_clip(CullView view, Affine m, uint k) { return to_clip(view, vec4(affine_column(m, k), 0)); }

// The box and its shadow's path cover a rectangle of the picture, and no part of them is nearer than `nearest`. They
// are hidden if everything drawn there is nearer still.
bool is_hidden(CullView view, Affine world_from_model, vec3 centre, vec3 half_extent) {
    const vec4 middle = to_clip(view, vec4(affine_point(world_from_model, centre), 1)),
               shadow = to_clip(view, vec4(shadow_of(view, world_from_model, centre, half_extent), 0));
    const vec4 x = column_to_clip(view, world_from_model, 0) * half_extent.x,
               y = column_to_clip(view, world_from_model, 1) * half_extent.y,
               z = column_to_clip(view, world_from_model, 2) * half_extent.z;
    const float kNothing = 3e38;
    vec2 low = vec2(kNothing), high = vec2(-kNothing);
    float nearest = -kNothing;
    bool is_in_front = true;
    for (uint corner = 0; corner < 16; ++corner) {
        const vec4 point = middle + ((corner & 1) != 0 ? x : -x) + ((corner & 2) != 0 ? y : -y) +
                           ((corner & 4) != 0 ? z : -z) + ((corner & 8) != 0 ? shadow : vec4(0));
        is_in_front = is_in_front && point.w > 1e-6;
        const vec3 seen = point.xyz / max(point.w, 1e-6);
        low = min(low, seen.xy);
        high = max(high, seen.xy);
        nearest = max(nearest, push.sign * seen.z);
    }
    if (!is_in_front) return false;
    // In texels of the picture, with one more on each side, since it was drawn with different rounding.
    const vec2 size = vec2(push.width, push.height);
    const ivec2 first = ivec2(clamp((low * 0.5 + 0.5) * size - 1, vec2(0), size - 1)),
                last = ivec2(clamp((high * 0.5 + 0.5) * size + 1, vec2(0), size - 1));
    // The finest level in which at most 4 x 4 texels cover them.
    uint width = (push.width + 1) / 2, height = (push.height + 1) / 2, begin = 0, level = 1;
    while (any(greaterThan((last >> level) - (first >> level), ivec2(3)))) {
        begin += width * height;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        ++level;
    }
    const ivec2 from = first >> level, to = last >> level;
    float farthest = kNothing;
    for (int row = from.y; row <= to.y; ++row)
        for (int column = from.x; column <= to.x; ++column)
            farthest = min(farthest, pyramid[begin + uint(row) * width + uint(column)]);
    return nearest < farthest;
}
