// The morph stage: what instances play -> their active morphs, which the skin stage and the draw apply.
#pragma once

#include "control/control_io.h"
#include "control/controller_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "morph/morph_io.h"

#include <throng/character.h>

namespace throng {

// Fills kMorphTimelineBuffer, kMorphTimesBuffer, kMorphTracksBuffer, kMorphValuesBuffer and kMorphDeltasBuffer of a
// character that has at least one morph: rows of tracks and values are rounded up to fours.
void upload_morph_tables(Uploads& uploads, const Character& character, Buffers& buffers);

// Dispatched with io::MorphPush, an invocation per instance; `layered`: of active clips, else of two clips.
Kernel morph_kernel(const std::shared_ptr<Gpu>& gpu, bool layered);

}  // namespace throng
