// The light of the scene: a sun and its shadows, a sky, what the ground reflects, and fog. The includer declares
// `DrawScene scene` and `shadow_map`.
vec3 xyz(vec4 v) { return v.xyz; }
#include "draw/light_model.glsl"

// The part of the sun that arrives. Nine neighbouring comparisons, each between four texels: a tent of sixteen.
float sun_at(vec3 world, vec3 normal) {
    const float kShift = 1.5;  // texels: a surface does not shadow itself
    const float slope = sqrt(max(1 - dot(normal, scene.to_sun.xyz) * dot(normal, scene.to_sun.xyz), 0));
    const vec4 point = vec4(world + normal * (scene.shadow.y * (0.5 + kShift * slope)), 1);
    const vec2 place = vec2(dot(scene.map_from_world[0], point), dot(scene.map_from_world[1], point)) * scene.shadow.x -
                       0.5;
    // Below all that throws a shadow there may be ground
    const float height = max(dot(scene.map_from_world[2], point), 0);
    const vec2 part = fract(place);
    const ivec2 corner = ivec2(floor(place)) - 1, last = ivec2(scene.shadow.x) - 1;
    const vec4 across = vec4(1 - part.x, 1, 1, part.x), down = vec4(1 - part.y, 1, 1, part.y);
    float lit = 0;
    for (int y = 0; y < 4; ++y) {
        vec4 heights;
        for (int x = 0; x < 4; ++x)
            heights[x] = texelFetch(shadow_map, clamp(corner + ivec2(x, y), ivec2(0), last), 0).r;
        lit += down[y] * dot(across, vec4(greaterThanEqual(vec4(height), heights)));
    }
    const bool outside = any(lessThan(place, vec2(0))) || any(greaterThan(place, vec2(last)));
    return outside || scene.shadow.z == 0 ? 1 : lit / 9;
}
