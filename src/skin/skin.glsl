// Influences and skin matrices -> the transform of a vertex; defined by skin_reference.h. The includer declares `uvec2
// influences[]` (throng::Influences as three 8-byte words: two of weights, one of four 16-bit palette entries) and the
// constant kSkinBlend, and includes bind/skin_format.glsl.
#include "gpu/similarity.glsl"
#include "skin/skin_io.h"

const uint kInfluenceWords = 3;

// The weighted sum of matrices or, depending on kSkinBlend, of unit dual quaternions and scales.
// Source: L. Kavan, S. Collins, J. Zara and C. O'Sullivan, Geometric Skinning with Approximate Dual Quaternion
// Blending, ACM TOG 27 (4), 2008.
struct SkinSum {
    Affine matrix;
    vec4 rotation, dual;
    float scale;
};

// Shaders do not skip influences of weight 0: usually some other lane of the subgroup has weight there, and loads
// inside branches would be serialized. Compiled as C++, one vertex is processed at a time, and the branch saves work.
void add_skin(INOUT(SkinSum) sum, float weight, uint index) {
#ifdef __cplusplus
    if (weight == 0) return;
#endif
    if (kSkinBlend == kSkinLinear) {
        const Affine m = load_skin(index);
        sum.matrix = Affine(sum.matrix.row0 + weight * m.row0, sum.matrix.row1 + weight * m.row1,
                            sum.matrix.row2 + weight * m.row2);
        return;
    }
    const Similarity s = load_skin_similarity(index);
    // q and -q are the same rotation: adds the one in the hemisphere of the sum so far, which is the shorter way.
    const float signed_weight = dot(sum.rotation, s.rotation) < 0 ? -weight : weight;
    sum.rotation += signed_weight * s.rotation;
    sum.dual += signed_weight * 0.5 * quaternion_multiply(vec4(s.translation_scale.xyz, 0), s.rotation);
    sum.scale += weight * s.translation_scale.w;
}

// model_from_bind.
Affine transform_of(SkinSum sum) {
    if (kSkinBlend == kSkinLinear) return sum.matrix;
    const float inverse_length = inversesqrt(max(dot(sum.rotation, sum.rotation), 1e-30));
    const vec4 rotation = sum.rotation * inverse_length;
    const vec3 translation = 2 * quaternion_multiply(sum.dual * inverse_length, vec4(-rotation.xyz, rotation.w)).xyz;
    return affine_from_trs(rotation, translation, vec3(sum.scale));
}

// model_from_bind of one vertex.
Affine blended_skin_matrix(uint first_influences, uint influence_sets, uint vertex, uint first_palette_entry) {
    SkinSum sum = SkinSum(Affine(vec4(0), vec4(0), vec4(0)), vec4(0), vec4(0), 0);
    for (uint set = 0; set < influence_sets; ++set) {
        const uint word = (first_influences + vertex * influence_sets + set) * kInfluenceWords;
        const vec4 weights = uintBitsToFloat(uvec4(influences[word], influences[word + 1]));
        const uvec2 entries = influences[word + 2];
        add_skin(sum, weights.x, first_palette_entry + (entries.x & 0xFFFF));
        add_skin(sum, weights.y, first_palette_entry + (entries.x >> 16));
        add_skin(sum, weights.z, first_palette_entry + (entries.y & 0xFFFF));
        add_skin(sum, weights.w, first_palette_entry + (entries.y >> 16));
    }
    return transform_of(sum);
}
