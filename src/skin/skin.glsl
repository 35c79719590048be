// Linear blend skinning. The includer declares `uvec2 influences[]` (throng::Influences as three 8-byte words: two of weights,
// one of four 16-bit palette entries) and includes bind/skin_format.glsl.
#include "skin/skin_io.h"

const uint kInfluenceWords = 3;

Affine weighted(Affine sum, float weight, uint matrix) {
    const Affine m = load_skin(matrix);
    return Affine(sum.row0 + weight * m.row0, sum.row1 + weight * m.row1, sum.row2 + weight * m.row2);
}

// model_from_bind of one vertex: the sum of its skin matrices by weight.
Affine blended_skin_matrix(uint first_influences, uint influence_sets, uint vertex, uint first_palette_entry) {
    Affine sum = Affine(vec4(0), vec4(0), vec4(0));
    for (uint set = 0; set < influence_sets; ++set) {
        const uint word = (first_influences + vertex * influence_sets + set) * kInfluenceWords;
        const vec4 weights = uintBitsToFloat(uvec4(influences[word], influences[word + 1]));
        const uvec2 entries = influences[word + 2];
        if (weights.x != 0) sum = weighted(sum, weights.x, first_palette_entry + (entries.x & 0xFFFF));
        if (weights.y != 0) sum = weighted(sum, weights.y, first_palette_entry + (entries.x >> 16));
        if (weights.z != 0) sum = weighted(sum, weights.z, first_palette_entry + (entries.y & 0xFFFF));
        if (weights.w != 0) sum = weighted(sum, weights.w, first_palette_entry + (entries.y >> 16));
    }
    return sum;
}
