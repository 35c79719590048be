// morph: computes the weights of each instance's morphs from the clips that it plays, and keeps those that are not 0;
// if there are more than the limit, the largest by magnitude. One invocation per instance. Cost: a binary search among
// the rows of weights for each clip (with layers, for each clip and quad of morphs), and 4 to 8 words for each quad.
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"
#include "control/control_io.h"
#include "morph/morph_io.h"

WORKGROUP(kMorphWorkgroupSize);
READONLY_BUFFER(kPlaybacksBuffer, InstancePlayback, playbacks);
TABLE_OF_ROWS(kActiveClipsBuffer, active_clips);
READONLY_BUFFER(kActiveClipTimesBuffer, float, active_clip_times);
TABLE_OF_WORDS(kMorphTimelineBuffer, timelines);
TABLE_OF_WORDS(kMorphTimesBuffer, times);
TABLE_OF_ROWS(kMorphTracksBuffer, tracks);
TABLE_OF_WORDS(kMorphValuesBuffer, values);
BUFFER(kActiveMorphsBuffer, ActiveMorph, active_morphs);
CONSTANT(1, bool, kLayered, false);
CONSTANT(2, bool, kVaries, false);
PUSH(MorphPush);

#include "control/births.glsl"
#include "morph/morph.glsl"

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || (kVaries && is_free(instance))) return;
    const uint first = instance * push.active_morph_limit;
    uint count = 0;
    RowsOfTwo rows;
    if (!kLayered) rows = rows_of_two(playbacks[instance]);
    for (uint quad = 0; quad < quad_count(); ++quad) {
        vec4 weights;
        if (kLayered)
            weights = weights_of_active_clips(instance, quad);
        else
            weights = weights_of_two(playbacks[instance], rows, quad);
        for (uint i = 0; i < min(push.morph_count - 4 * quad, 4); ++i)
            count = with_active(first, count, ActiveMorph(4 * quad + i, weights[i]));
    }
    for (uint i = count; i < push.active_morph_limit; ++i) active_morphs[first + i] = ActiveMorph(0, 0);
}
