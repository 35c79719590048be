// ground: where the ray meets the ground, or the sky.
#include "draw/scene.glsl"

layout(set = 1, binding = 0) uniform sampler2D shadow_map;
layout(location = 0) in vec3 in_ray;
layout(location = 0) out vec4 out_color;

#include "draw/light.glsl"

// 1 on the lines of a square grid, filtered over the pixel, 0 where its cells are no longer resolved.
float grid_line(vec2 position) {
    const float kHalfWidth = 0.006;  // of a cell
    const vec2 pixel = fwidth(position);
    const vec2 distance_to_line = abs(fract(position - 0.5) - 0.5);
    const vec2 line = 1 - smoothstep(vec2(kHalfWidth), kHalfWidth + pixel * 1.5, distance_to_line);
    return max(line.x, line.y) * (1 - smoothstep(0.02, 0.25, max(pixel.x, pixel.y)));
}

// A number for each cell, 0..1 (the hash pcg3d's first round: M. Jarzynski and M. Olano, Hash Functions for GPU
// Rendering, 2020).
float cell_value(ivec2 cell) {
    uint h = uint(cell.x) * 1664525u + uint(cell.y) * 1013904223u + 374761393u;
    h ^= h >> 16;
    h *= 2246822519u;
    h ^= h >> 13;
    return float(h & 0xFFFFu) / 65535.0;
}

// Soft patches, -1..1, gone where a pixel holds a whole one.
float patches(vec2 position) {
    const vec2 at = clamp(position, vec2(-1e6), vec2(1e6)), part = smoothstep(0.0, 1.0, fract(at)),
               pixel = fwidth(position);
    const ivec2 cell = ivec2(floor(at));
    const float value = mix(mix(cell_value(cell), cell_value(cell + ivec2(1, 0)), part.x),
                            mix(cell_value(cell + ivec2(0, 1)), cell_value(cell + ivec2(1, 1)), part.x), part.y);
    return (2 * value - 1) * (1 - smoothstep(0.3, 1.0, max(pixel.x, pixel.y)));
}

vec3 ground_color(vec3 world) {
    const vec2 position = (world.xz - scene.ground.xz) / scene.ground.w;
    const float shade = 1 + 0.08 * patches(position * 0.6) + 0.05 * patches(position * 4 + 17.3) +
                        0.05 * patches(position * 17 + 5.1) + 0.11 * grid_line(position);
    const vec3 up = vec3(0, 1, 0);
    return scene.ground_albedo.rgb * shade *
           (scene.sky_light.rgb + scene.sun_light.rgb * (scene.to_sun.y * sun_at(world, up)));
}

void main() {
    // Rays that miss the ground get a point of it too, so that its derivatives are defined for their neighbours.
    const bool meets = in_ray.y < 0 && scene.eye.y > scene.ground.y;
    const float reach = (scene.ground.y - scene.eye.y) / min(in_ray.y, -1e-6);
    const vec3 world = scene.eye.xyz + reach * in_ray;
    const vec3 ground = through_fog(ground_color(world), world);
    out_color = vec4(tone_mapped(meets ? ground : sky_color(normalize(in_ray))), 1);
}
