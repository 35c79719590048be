// The part of the sun's light that arrives; C++ too (gpu/glsl.h). The includer declares what light_model.glsl asks for,
// and two functions. vec4 heights_at(Whole column, Whole row) returns four neighbouring texels of a row of the shadow
// map, starting at `column`, clamped to the map's edge. Mask has_heights(Whole column, Whole row) is false only where
// the 4 x 4 texels from there on are all empty.

// The mean of nine neighbouring comparisons, each interpolated between four texels: a tent over sixteen texels.
Real sun_at(vec3 world, vec3 normal) {
    if (scene.shadow.z == 0) return Real(1);
    const Real kShift = 1.5;  // texels, so that a surface does not shadow itself
    const Real n_l = dot(normal, xyz(scene.to_sun)), slope = sqrt(max(1 - n_l * n_l, 0));
    const vec4 point = vec4(world + normal * (scene.shadow.y * (0.5 + kShift * slope)), 1);
    const Real x = dot(vec4(scene.map_from_world[0]), point) * scene.shadow.x - 0.5,
               y = dot(vec4(scene.map_from_world[1]), point) * scene.shadow.x - 0.5;
    const Mask inside = x >= 0 && y >= 0 && x <= scene.shadow.x - 1 && y <= scene.shadow.x - 1;
    // The ground may lie below everything that throws a shadow
    const Real height = max(dot(vec4(scene.map_from_world[2]), point), 0);
    const Real x_part = fract(x), y_part = fract(y);
    const Whole column = truncated(floor(x)) - 1, row = truncated(floor(y)) - 1, last = truncated(scene.shadow.x) - 1;
    if (!some(inside && has_heights(column, row))) return Real(1);
    const Real down[4] = {1 - y_part, Real(1), Real(1), y_part};
    Real lit = 0;
    for (int i = 0; i < 4; ++i) {
        const vec4 nearest = heights_at(column, clamp(row + i, 0, last));
        const Real of_row = choose(height >= nearest.x, 1 - x_part, Real(0)) +
                            choose(height >= nearest.y, Real(1), Real(0)) +
                            choose(height >= nearest.z, Real(1), Real(0)) +
                            choose(height >= nearest.w, x_part, Real(0));
        lit += down[i] * of_row;
    }
    return choose(inside, lit / 9, Real(1));
}
