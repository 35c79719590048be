// The lines over a crowd, some pixels wide, as two triangles each. C++ too (gpu/glsl.h). The includer declares
// `DrawScene scene` and includes gpu/affine.glsl.

// The corners of the two triangles.
const uint kLineVertices = 6;
uint line_corner_of(uint vertex) { return vertex == 0 ? 0 : vertex == 1 || vertex == 3 ? 1 : vertex == 5 ? 3 : 2; }

vec4 to_clip(vec3 world) {
    const vec4 point = vec4(world, 1);
    return vec4(dot(scene.clip_from_world[0], point), dot(scene.clip_from_world[1], point),
                dot(scene.clip_from_world[2], point), dot(scene.clip_from_world[3], point));
}

struct WorldLine {
    vec3 from, to;
    float width;  // at a distance of 1, in sizes of a character; clamped to 1.5 to 3 pixels
    vec3 color;
};

// One of its four corners in clip coordinates, the first two at `from`.
vec4 line_corner(WorldLine line, uint corner) {
    const vec4 from = to_clip(line.from), to = to_clip(line.to);
    // Clips at the near plane. Its distance is clip-space z, since depth is reversed and has no far plane.
    const float near = scene.clip_from_world[2].w;
    const bool seen = max(from.w, to.w) > near;
    const vec4 low = from.w < near ? mix(from, to, clamp((near - from.w) / (to.w - from.w), 0, 1)) : from;
    const vec4 high = to.w < near ? mix(to, from, clamp((near - to.w) / (from.w - to.w), 0, 1)) : to;
    vec4 end = corner < 2 ? low : high;
    const vec2 half_picture = 0.5 * scene.picture.xy;
    const vec2 along = (high.xy / high.w - low.xy / low.w) * half_picture;
    const vec2 across = vec2(-along.y, along.x) * inversesqrt(max(dot(along, along), 1e-12));
    const float pixels = clamp(line.width * scene.ground.w * half_picture.y / (length(scene.down.xyz) * end.w), 1.5,
                               3.0);
    end.xy += across / half_picture * end.w * ((corner & 1) == 0 ? pixels : -pixels) * 0.5;
    return seen ? end : vec4(2, 2, 0, 1);
}

// One of the twelve edges of a box in model space: four along each axis, from its low side to its high one.
WorldLine box_edge(Affine world_from_model, vec3 centre, vec3 half_extent, uint edge) {
    const uint axis = edge / 4;
    vec3 low = vec3(-1);
    low[(axis + 1) % 3] = (edge & 1) == 0 ? -1 : 1;
    low[(axis + 2) % 3] = (edge & 2) == 0 ? -1 : 1;
    vec3 high = low;
    high[axis] = 1;
    return WorldLine(affine_point(world_from_model, centre + low * half_extent),
                     affine_point(world_from_model, centre + high * half_extent), 0.006, vec3(1.0, 0.75, 0.1));
}

// A line from a joint to its parent, both given as `model_from_joint`. Coloured by the joint's level: hues from red at
// level 0 (roots, which have no line) via yellow, green and blue to violet at the last level.
WorldLine bone_line(Affine world_from_model, Affine joint, Affine parent, uint level, uint level_count) {
    const float hue = 0.8 * float(level) / max(level_count - 1, 1);
    const vec3 color = clamp(abs(fract(hue + vec3(0, 2, 1) / 3.0) * 6 - 3) - 1, vec3(0), vec3(1));
    return WorldLine(affine_point(world_from_model, affine_column(joint, 3)),
                     affine_point(world_from_model, affine_column(parent, 3)), 0.012, color);
}
