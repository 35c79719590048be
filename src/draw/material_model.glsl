// How a character's material reflects the light; C++ too (gpu/glsl.h). The includer also includes light_model.glsl and
// sun_model.glsl.

// The surface of a material without maps. `size`: of the character, in the world.
Surface plain_surface(vec3 color, Real metallic, Real roughness, vec3 emissive, vec3 world, vec3 normal, Real size) {
    Surface surface;
    surface.albedo = color;
    surface.metallic = metallic;
    surface.roughness = roughness;
    surface.normal = normal;
    // The nearer to the ground, the less of the sky is seen
    surface.occlusion = mix(0.5, 1.0, smoothstep(0.0, 0.25, (world.y - scene.ground.y) / size));
    surface.emissive = emissive;
    return surface;
}

// How a place and its texture coordinates change from a pixel to the next one on the right, and to the next one below.
struct PixelSteps {
    vec3 world_x, world_y;
    vec2 texcoord_x, texcoord_y;
};

// The normal map's normal. Its tangents are the derivatives of the place by the texture's coordinates (C. Schüler,
// Normal Mapping Without Precomputed Tangents, in ShaderX5, 2006); y of the map goes against v, as glTF has it.
vec3 mapped_normal(vec3 normal, vec3 texel, Real scale, PixelSteps steps) {
    const vec2 texture_x = steps.texcoord_x, texture_y = steps.texcoord_y;
    const Real area = texture_x.x * texture_y.y - texture_y.x * texture_x.y;
    const Real side = choose(area < 0, Real(-1), Real(1));
    vec3 u = (texture_y.y * steps.world_x - texture_x.y * steps.world_y) * side,
         v = (texture_x.x * steps.world_y - texture_y.x * steps.world_x) * side;
    u = u - normal * dot(normal, u);
    v = v - normal * dot(normal, v);
    const vec3 map = texel * 2 - 1;
    const vec3 tilted = normal * map.z + (map.x * scale) * u * inversesqrt(max(dot(u, u), 1e-30)) -
                        (map.y * scale) * v * inversesqrt(max(dot(v, v), 1e-30));
    return choose(scale != 0 && area != 0, normalize(tilted), normal);
}

// Texels of a material's maps; 1 where there is none.
struct MapTexels {
    Real metallic, roughness;
    vec3 normal;
    Real occlusion;
    vec3 emissive;
};

// `normal_scale` 0: there is no normal map.
Surface mapped_surface(Surface plain, MapTexels maps, Real normal_scale, Real occlusion_strength, PixelSteps steps) {
    Surface surface = plain;
    surface.metallic *= maps.metallic;
    surface.roughness *= maps.roughness;
    surface.normal = mapped_normal(plain.normal, maps.normal, normal_scale, steps);
    surface.occlusion *= mix(Real(1), maps.occlusion, occlusion_strength);
    surface.emissive = surface.emissive * maps.emissive;
    return surface;
}

// The picture's colour at a pixel of a character. `normal`: without the normal map. Both normals point to the front
// side.
vec3 pictured_surface(Surface front_surface, vec3 world, vec3 normal, Mask is_front) {
    Surface surface = front_surface;
    surface.normal = choose(is_front, surface.normal, -surface.normal);
    const Real sun = sun_at(world, choose(is_front, normal, -normal));
    const vec3 light = reflected_light(surface, normalize(xyz(scene.eye) - world), sun);
    return tone_mapped(through_fog(light, world));
}
