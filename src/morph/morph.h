// The morph stage: what instances play -> their active morphs, which the skin stage and the draw apply.
#pragma once

#include "control/control_io.h"
#include "control/controller_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "morph/morph_io.h"

#include <throng/character.h>

namespace throng {

// A character's morphs on the device. It has at least one.
struct MorphTables {
    MorphTables(Uploads& uploads, const Character& character);

    uint32_t morph_count = 0;
    Buffer axes;    // io::ClipAxis[clip_count + 1], as words; this and the next three are tables (gpu/table.glsl)
    Buffer times;   // float[], seconds
    Buffer tracks;  // uint[clip_count + 1][morph_count, rounded up to fours]
    Buffer values;  // float[]: default weights, rounded up to fours, then those of clips
    Buffer deltas;  // MorphDelta[]

    uint64_t size_bytes() const {
        return axes.size_bytes() + times.size_bytes() + tracks.size_bytes() + values.size_bytes() + deltas.size_bytes();
    }
};

// In the order of the bindings; dispatched with io::MorphPush, an invocation per instance.
struct MorphBuffers {
    BufferRange playbacks;    // of two clips: io::InstancePlayback[instance_count], as control left it; else any buffer
    BufferRange voices;       // of layers: io::Voice[instance_count][voice_limit]; else any table of rows
    BufferRange voice_times;  // of layers: float[instance_count][voice_limit], seconds; else any buffer
    BufferRange axes, times, tracks, values;  // of MorphTables
    BufferRange active;                       // io::ActiveMorph[instance_count][kActiveMorphs], written
};

Kernel morph_kernel(const std::shared_ptr<Gpu>& gpu, bool layered);

}  // namespace throng
