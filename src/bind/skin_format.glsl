// Loads and stores skin matrices, [instance][palette entry], in the crowd's format (throng::SkinFormat). The includer
// declares the constant kSkinFormat, and defines SKIN_STORES if it writes them.
#include "gpu/buffers_io.h"
#include "bind/bind_io.h"
#include "gpu/stored.glsl"

#ifdef SKIN_STORES
#define SKIN_BUFFER WRITEONLY_BUFFER
#else
#define SKIN_BUFFER READONLY_BUFFER
#endif

SKIN_BUFFER(kSkinBuffer, StoredAffine, skin_affines);
SKIN_BUFFER(kSkinBuffer, StoredPair, skin_halves);  // each holds a row of four
SKIN_BUFFER(kSkinBuffer, StoredSimilarity, skin_similarities);

#ifdef SKIN_STORES

StoredPair halves(vec4 row) { return pack(uvec2(packHalf2x16(row.xy), packHalf2x16(row.zw))); }

void store_skin(uint index, Affine model_from_bind) {
    if (kSkinFormat == kSkinHalfAffine) {
        skin_halves[3 * index] = halves(model_from_bind.row0);
        skin_halves[3 * index + 1] = halves(model_from_bind.row1);
        skin_halves[3 * index + 2] = halves(model_from_bind.row2);
    } else if (kSkinFormat == kSkinSimilarity) {
        skin_similarities[index] = pack(similarity_from_affine(model_from_bind));
    } else {
        skin_affines[index] = pack(model_from_bind);
    }
}

#else

vec4 floats(StoredPair row) {
    const uvec2 pair = unpack(row);
    return vec4(unpackHalf2x16(pair.x), unpackHalf2x16(pair.y));
}

Affine load_skin(uint index) {
    if (kSkinFormat == kSkinHalfAffine)
        return Affine(floats(skin_halves[3 * index]), floats(skin_halves[3 * index + 1]),
                      floats(skin_halves[3 * index + 2]));
    if (kSkinFormat == kSkinSimilarity) return affine_from_similarity(unpack(skin_similarities[index]));
    return unpack(skin_affines[index]);
}

// A skin matrix as a similarity.
Similarity load_skin_similarity(uint index) {
    if (kSkinFormat == kSkinSimilarity) return unpack(skin_similarities[index]);
    return similarity_from_affine(load_skin(index));
}

#endif
