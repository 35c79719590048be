// Clips and their times -> weights of morphs -> active morphs; defined by morph_reference.h. The includer
// declares `ActiveMorph active_morphs[]` ([instance][push.active_morph_limit]), the tables `timelines`, `times`,
// `tracks` (rows: four morphs each, [clip][quad]) and `values` (the default weights first), and for layers
// `active_clips` and `active_clip_times` ([instance][push.active_clip_limit]). Morphs are handled in quads of four;
// layers look up a clip's rows once for each quad.
#include "control/control.glsl"
#include "control/controller_io.h"
#include "morph/morph_io.h"

uint quad_count() { return (push.morph_count + 3) / 4; }

float value_at(uint index) { return uintBitsToFloat(WORD_AT(values, index)); }

vec4 default_weights(uint quad) {
    return vec4(value_at(4 * quad), value_at(4 * quad + 1), value_at(4 * quad + 2), value_at(4 * quad + 3));
}

const ClipCursor kFirstRow = ClipCursor(0, 0, 0, 0);

ClipCursor morph_rows(uint clip, float time_s) { return find_rows(load_timeline(clip), time_s); }

float sample_weight(uint track, ClipCursor rows, float untouched) {
    if (track == kNone) return untouched;
    const uint position = track & kMorphPositionMask;
    if ((track & kMorphAnimatedBit) == 0) return value_at(position);
    const float earlier = value_at(position + rows.earlier);
    return (track & kMorphStepBit) != 0 ? earlier : mix(earlier, value_at(position + rows.later), rows.fraction);
}

vec4 sample_weights(uvec4 quad_tracks, ClipCursor rows, vec4 untouched) {
    return vec4(sample_weight(quad_tracks.x, rows, untouched.x), sample_weight(quad_tracks.y, rows, untouched.y),
                sample_weight(quad_tracks.z, rows, untouched.z), sample_weight(quad_tracks.w, rows, untouched.w));
}

uvec4 quad_tracks_of(uint clip, uint quad) { return ROW_AT(tracks, clip * quad_count() + quad); }

// ---- Two clips

// The rows of both clips. If the second clip has no weight, its rows are meaningless.
struct RowsOfTwo {
    ClipCursor first, second;
};

RowsOfTwo rows_of_two(InstancePlayback playback) {
    return RowsOfTwo(morph_rows(playback.first.clip, playback.first.time_s),
                     morph_rows(playback.second.clip, playback.second.time_s));
}

vec4 weights_of_two(InstancePlayback playback, RowsOfTwo rows, uint quad) {
    const vec4 defaults = default_weights(quad);
    vec4 weights = sample_weights(quad_tracks_of(playback.first.clip, quad), rows.first, defaults);
    if (playback.weight < 1)
        weights = mix(sample_weights(quad_tracks_of(playback.second.clip, quad), rows.second, defaults), weights,
                      playback.weight);
    return weights;
}

// ---- Layers

vec4 weights_of_active_clips(uint instance, uint quad) {
    const vec4 defaults = default_weights(quad);
    vec4 result = defaults, sum = vec4(0);
    bvec4 is_touched = bvec4(false);  // by an active clip of the layer
    uint index = instance * push.active_clip_limit;
    const uint end = index + push.active_clip_limit;
    for (;;) {
        const uvec4 a = ROW_AT(active_clips, 2 * index), b = ROW_AT(active_clips, 2 * index + 1);
        const uint clip = a.x / push.joint_count, flags = b.w;
        const float weight = uintBitsToFloat(b.x), layer_weight = uintBitsToFloat(b.y);
        const bool is_additive = (flags & kActiveClipAdditive) != 0;
        const uvec4 quad_tracks = quad_tracks_of(clip, quad);
        const vec4 value = sample_weights(quad_tracks, morph_rows(clip, active_clip_times[index]), defaults);
        vec4 from = defaults;
        if (is_additive) from = sample_weights(quad_tracks, kFirstRow, defaults);
        sum += weight * (value - from);
        is_touched = bvec4(uvec4(is_touched) | uvec4(notEqual(quad_tracks, uvec4(kNone))));
        if ((flags & kActiveClipEndsLayer) != 0) {
            result = is_additive ? result + layer_weight * sum
                                 : mix(result, mix(result, defaults + sum, layer_weight), is_touched);
            sum = vec4(0);
            is_touched = bvec4(false);
        }
        ++index;
        if (index == end || (flags & kActiveClipEnds) != 0) break;
    }
    return result;
}

// ---- Active morphs

// Adds a morph to the `count` active morphs of an instance and returns the new count. Call it in the order of morph
// indices. Active morphs stay in that order if all fit; otherwise they are sorted by magnitude, the largest first.
uint with_active(uint first, uint count, ActiveMorph added) {
    const float size = abs(added.weight);
    if (!(size > uintBitsToFloat(kMinMorphWeightBits))) return count;
    const bool is_full = count == push.active_morph_limit;
    if (is_full && !(size > abs(active_morphs[first + count - 1].weight))) return count;
    uint place = is_full ? count - 1 : count;
    while (push.active_morph_limit < push.morph_count && place > 0 &&
           size > abs(active_morphs[first + place - 1].weight)) {
        active_morphs[first + place] = active_morphs[first + place - 1];
        --place;
    }
    active_morphs[first + place] = added;
    return is_full ? count : count + 1;
}
