// Lines of some pixels' width, as two triangles each. The includer declares `DrawScene scene`.
const uint kLineVertices = 6;

// The clip position of one of the six vertices of the line between two points in clip coordinates, as wide as `width`
// at a distance of 1 but 1.5 to 3 pixels.
vec4 line_vertex(vec4 from, vec4 to, uint vertex, float width) {
    // In front of the eye: depth is reversed and without end, so that z is the distance of the near plane.
    const float near = scene.clip_from_world[2].w;
    const bool seen = max(from.w, to.w) > near;
    const vec4 low = from.w < near ? mix(from, to, clamp((near - from.w) / (to.w - from.w), 0, 1)) : from;
    const vec4 high = to.w < near ? mix(to, from, clamp((near - to.w) / (from.w - to.w), 0, 1)) : to;
    const uint corner = vertex == 0 ? 0 : vertex == 1 || vertex == 3 ? 1 : vertex == 5 ? 3 : 2;
    vec4 end = corner < 2 ? low : high;
    const vec2 half_picture = 0.5 * scene.picture.xy;
    const vec2 along = (high.xy / high.w - low.xy / low.w) * half_picture;
    const vec2 across = vec2(-along.y, along.x) * inversesqrt(max(dot(along, along), 1e-12));
    const float pixels = clamp(width * half_picture.y / (length(scene.down.xyz) * end.w), 1.5, 3.0);
    end.xy += across / half_picture * end.w * ((corner & 1) == 0 ? pixels : -pixels) * 0.5;
    return seen ? end : vec4(2, 2, 0, 1);
}

vec4 to_clip(vec3 world) {
    const vec4 point = vec4(world, 1);
    return vec4(dot(scene.clip_from_world[0], point), dot(scene.clip_from_world[1], point),
                dot(scene.clip_from_world[2], point), dot(scene.clip_from_world[3], point));
}
