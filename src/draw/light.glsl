// The light of the scene: a bright haze, a sky, one warm sun, a ground that fades into the haze. Linear colours.
// The includer declares `DrawScene scene`.
const vec3 kHaze = vec3(0.66, 0.75, 0.84);
const vec3 kZenith = vec3(0.13, 0.30, 0.60);
const vec3 kSkyLight = vec3(0.40, 0.44, 0.50);     // on a surface that looks up
const vec3 kBounceLight = vec3(0.24, 0.21, 0.18);  // on one that looks down
const vec3 kSunLight = vec3(0.80, 0.73, 0.62);
const vec3 kGroundAlbedo = vec3(0.40, 0.41, 0.33);

vec3 sky_color(vec3 direction) {
    return scene.light.x * mix(kHaze, kZenith, smoothstep(0.0, 0.9, normalize(direction).y));
}

// 1 on the lines of a square grid, filtered over the pixel, 0 where its cells are no longer resolved.
float grid_line(vec2 position) {
    const float kHalfWidth = 0.006;  // of a cell
    const vec2 pixel = fwidth(position);
    const vec2 distance_to_line = abs(fract(position - 0.5) - 0.5);
    const vec2 line = 1 - smoothstep(vec2(kHalfWidth), kHalfWidth + pixel * 1.5, distance_to_line);
    return max(line.x, line.y) * (1 - smoothstep(0.02, 0.25, max(pixel.x, pixel.y)));
}

// `sun` is the part of the sun that arrives.
vec3 ground_color(vec3 world, float sun) {
    const vec3 albedo = kGroundAlbedo * (1 + 0.22 * grid_line((world.xz - scene.ground.xz) / scene.scale.x));
    const vec3 lit = albedo * (kSkyLight + kSunLight * scene.to_light.y * sun);
    const float reach = length(world.xz - scene.ground.xz) / scene.ground.w;
    return scene.light.x * mix(kHaze, lit, exp(-reach * reach * scene.light.y));
}

vec3 surface_color(vec3 albedo, vec3 world, vec3 normal) {
    const float kWrap = 0.2;  // light reaches a little around the edge, as on soft things
    const vec3 to_eye = normalize(scene.eye.xyz - world);
    const float sun = max((dot(normal, scene.to_light.xyz) + kWrap) / (1 + kWrap), 0);
    const float contact = mix(0.55, 1.0, smoothstep(0.0, 1.0, (world.y - scene.ground.y) / scene.scale.z));
    const vec3 ambient = mix(kBounceLight, kSkyLight, 0.5 + 0.5 * normal.y) * contact;
    const float rim = pow(1 - max(dot(normal, to_eye), 0), 4) * 0.25 * (0.5 + 0.5 * normal.y);
    const vec3 lit = albedo * (ambient + kSunLight * sun) + kSkyLight * rim * (0.3 + albedo);
    const float haze = length(scene.eye.xyz - world) / scene.scale.y;
    return scene.light.x * mix(kHaze, lit, exp(-haze * haze * scene.light.y));
}
