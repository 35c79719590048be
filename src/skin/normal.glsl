// Packs, unpacks and transforms normals.
// Source of the octahedral map: Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors,
// JCGT 2014.
#include "gpu/affine.glsl"

vec3 unpack_normal(uint packed) {
    const vec2 octahedral = unpackSnorm2x16(packed);
    const float z = 1 - abs(octahedral.x) - abs(octahedral.y);
    const vec2 folded = (1 - abs(octahedral.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(octahedral, vec2(0)));
    return vec3(z < 0 ? folded : octahedral, z);
}

// `normal` may have any length but 0.
uint pack_normal(vec3 normal) {
    const vec3 octahedral = normal / max(abs(normal.x) + abs(normal.y) + abs(normal.z), 1e-30);
    const vec2 folded = (1 - abs(octahedral.yx)) * mix(vec2(-1), vec2(1), greaterThanEqual(octahedral.xy, vec2(0)));
    return packSnorm2x16(octahedral.z < 0 ? folded : octahedral.xy);
}

// In bind space, of any length. `difference`: the sum of the morphs' differences; used only if the section has morphs.
vec3 morphed_normal(uint packed, uint morph_count, vec3 difference) {
    const vec3 normal = unpack_normal(packed);
    return morph_count > 0 ? normalize(normal) + difference : normal;
}

// Multiplies by the inverse transpose of m's linear part, up to a positive factor, so that non-uniform scale and
// mirrors give correct normals.
vec3 transform_normal(Affine m, vec3 normal) {
    const vec3 c0 = cross(m.row1.xyz, m.row2.xyz), c1 = cross(m.row2.xyz, m.row0.xyz),
               c2 = cross(m.row0.xyz, m.row1.xyz);
    const vec3 cofactor = vec3(dot(c0, normal), dot(c1, normal), dot(c2, normal));
    return dot(m.row0.xyz, c0) < 0 ? -cofactor : cofactor;
}
