// The light of the scene: a sun, a sky, what the ground reflects, and fog; light_reference.h defines it, and
// docs/drawing.md names the sources. The includer declares `DrawScene scene` and `shadow_map`.
const float kPi = 3.14159265;

vec3 sky_color(vec3 direction) {
    const float glow = pow(max(dot(direction, scene.to_sun.xyz), 0), 8);
    return mix(scene.horizon.rgb, scene.zenith.rgb, sqrt(max(direction.y, 0))) + 0.12 * glow * scene.sun_light.rgb;
}

// What comes from all sides onto a surface that looks along `normal`.
vec3 ambient_light(vec3 normal) { return mix(scene.bounce_light.rgb, scene.sky_light.rgb, 0.5 + 0.5 * normal.y); }

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

struct Surface {
    vec3 albedo;
    float metallic;
    float roughness;
    vec3 normal;
    float occlusion;  // the part of the ambient light that arrives
    vec3 emissive;
};

// The light that leaves the surface towards the eye.
vec3 reflected_light(Surface surface, vec3 to_eye, float sun) {
    const float kLeastRoughness = 0.089;
    const float roughness = clamp(surface.roughness, kLeastRoughness, 1), alpha = roughness * roughness,
                alpha2 = alpha * alpha;
    const vec3 normal = surface.normal, half_way = normalize(to_eye + scene.to_sun.xyz);
    const float n_v = max(abs(dot(normal, to_eye)), 1e-4), n_l = max(dot(normal, scene.to_sun.xyz), 0),
                n_h = max(dot(normal, half_way), 0), v_h = max(dot(to_eye, half_way), 0);
    const vec3 diffuse = surface.albedo * (1 - surface.metallic),
               f0 = mix(vec3(0.04), surface.albedo, surface.metallic);

    const float falloff = n_h * n_h * (alpha2 - 1) + 1;
    const float distribution = alpha2 / (kPi * falloff * falloff);
    const float visibility = 0.5 / max(n_l * sqrt(n_v * n_v * (1 - alpha2) + alpha2) +
                                           n_v * sqrt(n_l * n_l * (1 - alpha2) + alpha2),
                                       1e-4);
    const vec3 fresnel = f0 + (1 - f0) * pow(max(1 - v_h, 0), 5);
    const vec3 from_sun = (diffuse * (1 - fresnel) + kPi * distribution * visibility * fresnel) * scene.sun_light.rgb *
                          (n_l * sun);

    const vec4 r = roughness * vec4(-1, -0.0275, -0.572, 0.022) + vec4(1, 0.0425, 1.04, -0.04);
    const float grazing = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    const vec3 mirrored = reflect(-to_eye, normal);
    const vec3 from_mirror = mix(mix(scene.bounce_light.rgb, sky_color(mirrored), smoothstep(-0.1, 0.1, mirrored.y)),
                                 ambient_light(mirrored), roughness);
    const vec3 reflected = from_mirror * (f0 * (-1.04 * grazing + r.z) + (1.04 * grazing + r.w));
    return from_sun + (diffuse * ambient_light(normal) + reflected) * surface.occlusion + surface.emissive;
}

vec3 through_fog(vec3 color, vec3 world) {
    const vec3 way = world - scene.eye.xyz;
    const float depth = scene.fog.x * length(way);
    const vec3 horizon = sky_color(normalize(vec3(way.x, 0, way.z) + vec3(1e-10, 0, 0)));
    return mix(horizon, color, exp(-depth * depth));
}

// The Khronos PBR Neutral tone mapper: below 0.76 colours stay what they are.
vec3 tone_mapped(vec3 color) {
    color *= scene.eye.w;
    const float kStart = 0.8 - 0.04, kDesaturation = 0.15;
    const float least = min(color.r, min(color.g, color.b));
    color -= least < 0.08 ? least - 6.25 * least * least : 0.04;
    const float peak = max(color.r, max(color.g, color.b)), room = 1 - kStart;
    const float lower_peak = 1 - room * room / (max(peak, kStart) + room - kStart);
    const float white = 1 - 1 / (kDesaturation * (peak - lower_peak) + 1);
    return peak < kStart ? color : mix(color * (lower_peak / peak), vec3(lower_peak), white);
}
