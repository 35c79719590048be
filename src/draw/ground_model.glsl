// The ground and the sky; C++ too (gpu/glsl.h). The includer also includes light_model.glsl and sun_model.glsl.

// 1 on the lines of a grid across x, filtered over a pixel of some width.
Real line_across(Real x, Real pixel) {
    const Real kHalfWidth = 0.006;  // of a cell
    return 1 - smoothstep(kHalfWidth, kHalfWidth + pixel * 1.5, abs(fract(x - 0.5) - 0.5));
}

// The lines of a square grid, 0 where its cells are no longer resolved.
Real grid_line(vec2 position, vec2 pixel) {
    const Real width = max(pixel.x, pixel.y), kGone = 0.25;
    if (!some(width < kGone)) return Real(0);
    return max(line_across(position.x, pixel.x), line_across(position.y, pixel.y)) *
           (1 - smoothstep(0.02, kGone, width));
}

// A number for each cell, 0..1 (the hash pcg3d's first round: M. Jarzynski and M. Olano, Hash Functions for GPU
// Rendering, 2020).
Real cell_value(Whole column, Whole row) {
    uint h = uint(column) * 1664525u + uint(row) * 1013904223u + 374761393u;
    h = h ^ h >> 16;
    h = h * 2246822519u;
    h = h ^ h >> 13;
    return Real(h & 0xFFFFu) * (1 / 65535.0);
}

// Soft patches, -1..1, faded out where a pixel covers a whole patch.
Real patches(vec2 position, vec2 pixel) {
    const Real width = max(pixel.x, pixel.y);
    if (!some(width < 1)) return Real(0);
    const Real x = clamp(position.x, -1e6, 1e6), y = clamp(position.y, -1e6, 1e6);
    const Real x_part = smoothstep(0.0, 1.0, fract(x)), y_part = smoothstep(0.0, 1.0, fract(y));
    const Whole column = truncated(floor(x)), row = truncated(floor(y));
    const Real value = mix(mix(cell_value(column, row), cell_value(column + 1, row), x_part),
                           mix(cell_value(column, row + 1), cell_value(column + 1, row + 1), x_part), y_part);
    return (2 * value - 1) * (1 - smoothstep(0.3, 1.0, width));
}

// Where a ray from the eye meets the ground. One that misses it gets a point too, so that derivatives are defined for
// its neighbours.
vec3 ground_point(vec3 ray) { return xyz(scene.eye) + (scene.ground.y - scene.eye.y) / min(ray.y, -1e-6) * ray; }

// In cells of the grid.
vec2 ground_position(vec3 world) { return vec2(world.x - scene.ground.x, world.z - scene.ground.z) / scene.ground.w; }

vec3 ground_light(vec3 world, vec2 pixel) {
    const vec2 position = ground_position(world);
    const Real shade = 1 + 0.08 * patches(position * 0.6, pixel * 0.6) +
                       0.05 * patches(position * 4 + 17.3, pixel * 4) +
                       0.05 * patches(position * 17 + 5.1, pixel * 17) + 0.11 * grid_line(position, pixel);
    return xyz(scene.ground_albedo) * shade *
           (xyz(scene.sky_light) + xyz(scene.sun_light) * (scene.to_sun.y * sun_at(world, vec3(0, 1, 0))));
}

// The picture's colour at a pixel without a character. `ray`: through the pixel's centre; `pixel`: its width and height
// in ground_position().
vec3 background(vec3 ray, vec2 pixel) {
    const Mask misses = ray.y >= 0 || Real(scene.eye.y) <= scene.ground.y;
    vec3 color = vec3(0);
    if (some(!misses)) {
        const vec3 world = ground_point(ray);
        color = through_fog(ground_light(world, pixel), world);
    }
    if (some(misses)) color = choose(misses, sky_color(normalize(ray)), color);
    return tone_mapped(color);
}
