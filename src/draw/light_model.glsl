// The light that a surface reflects, and how much of it reaches the eye; docs/drawing.md names the sources. C++ too
// (gpu/glsl.h). The includer declares `DrawScene scene` and xyz(), the first three components of a vec4.
const Real kPi = 3.14159265;

vec3 sky_color(vec3 direction) {
    const Real glow = pow(max(dot(direction, xyz(scene.to_sun)), 0), 8);
    return mix(xyz(scene.horizon), xyz(scene.zenith), sqrt(max(direction.y, 0))) + 0.12 * glow * xyz(scene.sun_light);
}

// The light from all sides onto a surface that faces along `normal`.
vec3 ambient_light(vec3 normal) { return mix(xyz(scene.bounce_light), xyz(scene.sky_light), 0.5 + 0.5 * normal.y); }

struct Surface {
    vec3 albedo;
    Real metallic;
    Real roughness;
    vec3 normal;
    Real occlusion;  // the part of the ambient light that arrives
    vec3 emissive;
};

// The light that leaves the surface towards the eye.
vec3 reflected_light(Surface surface, vec3 to_eye, Real sun) {
    const Real kMinRoughness = 0.089;
    const Real roughness = clamp(surface.roughness, kMinRoughness, 1), alpha = roughness * roughness,
               alpha2 = alpha * alpha;
    const vec3 normal = surface.normal, half_way = normalize(to_eye + xyz(scene.to_sun));
    const Real n_v = max(abs(dot(normal, to_eye)), 1e-4), n_l = max(dot(normal, xyz(scene.to_sun)), 0),
               n_h = max(dot(normal, half_way), 0), v_h = max(dot(to_eye, half_way), 0);
    const vec3 diffuse = surface.albedo * (1 - surface.metallic),
               f0 = mix(vec3(0.04), surface.albedo, surface.metallic);

    const Real falloff = n_h * n_h * (alpha2 - 1) + 1;
    const Real distribution = alpha2 / (kPi * falloff * falloff);
    const Real visibility = 0.5 / max(n_l * sqrt(n_v * n_v * (1 - alpha2) + alpha2) +
                                          n_v * sqrt(n_l * n_l * (1 - alpha2) + alpha2),
                                      1e-4);
    const vec3 fresnel = f0 + (vec3(1) - f0) * pow(max(1 - v_h, 0), 5);
    const vec3 from_sun = (diffuse * (vec3(1) - fresnel) + kPi * distribution * visibility * fresnel) *
                          xyz(scene.sun_light) * (n_l * sun);

    const vec4 r = roughness * vec4(-1, -0.0275, -0.572, 0.022) + vec4(1, 0.0425, 1.04, -0.04);
    const Real grazing = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    const vec3 mirrored = reflect(-to_eye, normal);
    const vec3 from_mirror = mix(mix(xyz(scene.bounce_light), sky_color(mirrored), smoothstep(-0.1, 0.1, mirrored.y)),
                                 ambient_light(mirrored), roughness);
    const vec3 reflected = from_mirror * (f0 * (-1.04 * grazing + r.z) + vec3(1.04 * grazing + r.w));
    return from_sun + (diffuse * ambient_light(normal) + reflected) * surface.occlusion + surface.emissive;
}

vec3 through_fog(vec3 color, vec3 world) {
    const vec3 way = world - xyz(scene.eye);
    const Real depth = scene.fog.x * length(way);
    const vec3 horizon = sky_color(normalize(vec3(way.x, 0, way.z) + vec3(1e-10, 0, 0)));
    return mix(horizon, color, exp(-depth * depth));
}

// The Khronos PBR Neutral tone mapper: below 0.76 colours stay what they are.
vec3 tone_mapped(vec3 light) {
    const vec3 exposed = max(light, vec3(0)) * scene.eye.w;
    const Real kStart = 0.8 - 0.04, kDesaturation = 0.15;
    const Real least = min(exposed.x, min(exposed.y, exposed.z));
    const vec3 color = exposed - vec3(choose(least < 0.08, least - 6.25 * least * least, Real(0.04)));
    const Real peak = max(color.x, max(color.y, color.z)), room = 1 - kStart;
    if (!some(peak >= kStart)) return color;
    const Real lower_peak = 1 - room * room / (max(peak, kStart) + room - kStart);
    const Real white = 1 - 1 / (kDesaturation * (peak - lower_peak) + 1);
    return choose(peak < kStart, color, mix(color * (lower_peak / peak), vec3(lower_peak), white));
}
