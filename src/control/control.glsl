// Playback state -> time -> rows of keys. The includer declares `timelines` and `times`, both tables of words.
#include "control/control_io.h"

ClipTimeline load_timeline(uint clip) { return CLIP_TIMELINE_AT(timelines, kClipTimelineWords * clip); }

float time_at(uint index) { return FLOAT_AT(times, index); }

// Looping: t - floor(t / D) * D, so that t = D wraps to 0. Division is not exact on GPUs, hence the two corrections. A
// time that has overflowed to infinity or NaN also becomes 0, since it would never recover by itself.
float local_time(float time_s, float duration_s, bool loop) {
    if (duration_s <= 0) return 0;
    if (!loop) return clamp(time_s, 0, duration_s);
    float wrapped = time_s - floor(time_s / duration_s) * duration_s;
    if (wrapped < 0) wrapped += duration_s;
    return wrapped >= 0 && wrapped < duration_s ? wrapped : 0;
}

// The rows around time_s: the last one at or before it and the next; before the first and after the last, that row
// alone.
ClipCursor find_rows(ClipTimeline timeline, float time_s) {
    uint low = 0, high = timeline.row_count;  // times[low] <= time_s < times[high], except at the ends
    // `do` with a `break`, as in mix_line() (blend_space.glsl)
    do {
        if (high - low <= 1) break;
        const uint middle = (low + high) / 2;
        if (time_at(timeline.first_time + middle) <= time_s)
            low = middle;
        else
            high = middle;
    } while (high - low > 1);
    const uint earlier = timeline.first_row + low * timeline.row_stride;
    ClipCursor cursor = ClipCursor(0, earlier, earlier, 0);
    if (low + 1 < timeline.row_count) {
        const float from_s = time_at(timeline.first_time + low), to_s = time_at(timeline.first_time + low + 1);
        cursor.later = earlier + timeline.row_stride;
        cursor.fraction = clamp((time_s - from_s) / (to_s - from_s), 0, 1);
    }
    return cursor;
}
