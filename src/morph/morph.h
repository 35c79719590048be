// The morph stage: the clips that instances play -> their active morphs, which the skin stage and the draw apply.
#pragma once

#include "control/control_io.h"
#include "control/controller_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "morph/morph_io.h"

#include <throng/character.h>

namespace throng {

// For characters with at least one morph. Rows of tracks and values are padded to multiples of four.
struct MorphTables {
    std::vector<uint32_t> timelines;              // words of io::ClipTimeline
    std::vector<std::array<uint32_t, 4>> tracks;  // [clip][quad]
    std::vector<float> values;                    // begin with the default weights
};
MorphTables make_morph_tables(const Character& character);

// Fills kMorphTimelineBuffer, kMorphTimesBuffer, kMorphTracksBuffer, kMorphValuesBuffer and kMorphDeltasBuffer.
void upload_morph_tables(Uploads& uploads, const Character& character, Buffers& buffers);

// Dispatched with io::MorphPush, an invocation per instance. `layered`: instances play active clips, not two clips.
// `varies`: they come and go, and those that are not there are left out.
Kernel morph_kernel(const std::shared_ptr<Gpu>& gpu, bool layered, bool varies = false);

}  // namespace throng
