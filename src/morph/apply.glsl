// Applies active morphs to a vertex, before it is skinned. The includer declares `ActiveMorph active_morphs[]`
// ([instance][active_morph_limit], weight 0 after the last) and `uvec4 morph_deltas[]` (throng::MorphDelta).
#include "morph/morph_io.h"

struct MorphSum {
    vec3 position, normal;
};

// first_delta: of the vertex; first_morph, morph_count: of its section. Reads no buffers if there are no morphs.
MorphSum sum_of_morphs(uint first_delta, uint first_morph, uint morph_count, uint instance, uint active_morph_limit) {
    MorphSum sum = MorphSum(vec3(0), vec3(0));
    // No `if`: a software device executes both sides of a branch, but skips a loop of 0 iterations
    const uint count = first_delta > 0 && morph_count > 0 ? active_morph_limit : 0;
    for (uint i = 0; i < count; ++i) {
        const ActiveMorph shown = active_morphs[instance * active_morph_limit + i];
        if (shown.weight == 0) break;
        const uint target = shown.morph - first_morph;  // wraps to far above morph_count if it is of another section
        if (target < morph_count) {
            const uvec4 delta = morph_deltas[first_delta - 1 + target];
            sum.position += shown.weight * uintBitsToFloat(delta.xyz);
            const int normal = int(delta.w);
            sum.normal += shown.weight * uintBitsToFloat(kMorphNormalStepBits) *
                          vec3(bitfieldExtract(normal, 0, 10), bitfieldExtract(normal, 10, 10),
                               bitfieldExtract(normal, 20, 10));
        }
    }
    return sum;
}
