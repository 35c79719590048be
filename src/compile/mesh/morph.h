// Morph targets -> deltas of the vertices that they move; their weights in clips -> rows.
#pragma once

#include "base/progress.h"

#include <throng/character.h>

namespace throng {

// Fills morphs and morph_deltas, and the fields of sections and vertices that refer to them. character.sections and
// vertices must be set. Throws kLimit beyond 4,096 morphs, or 256 MiB of deltas.
void compile_morphs(const Asset& asset, Character& character, const Progress& progress);

// Fills morph_tracks, morph_times_s and morph_values, and the fields of clips that refer to them. character.clips must
// be set, in the order of the asset's clips. Throws kLimit if values or the track table exceed 256 MiB, or the cubic
// tracks of a clip take more than 4,000,000 weights.
void compile_morph_tracks(const Asset& asset, Character& character, const Progress& progress);

}  // namespace throng
