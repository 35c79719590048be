// Which shared pose an instance gets, and whether it is near enough to its own. The includer includes cull/cull.glsl.
#include "control/controller_io.h"

TABLE_OF_WORDS(kTimelineBuffer, timelines);
TABLE_OF_WORDS(kTimesBuffer, times);
READONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
TABLE_OF_ROWS(kActiveClipsBuffer, active_clips);
READONLY_BUFFER(kSharedClipsBuffer, SharedClip, shared_clips);  // [clip_count + 1]
WRITEONLY_BUFFER(kSkinRowsBuffer, uint, skin_rows);

#include "control/control.glsl"

// The clip that most of an instance's pose comes from; with a controller, the first of its lowest layer.
struct MainClip {
    ClipCursor cursor;
    float others_weight;  // 0: there is no other clip; 1: unknown, with a controller
};

MainClip main_clip(CullPush push, uint instance) {
    MainClip main;
    if (push.active_clip_limit > 0) {  // the lowest layer's first (docs/controller.md, step 9)
        const uint at = 2 * instance * push.active_clip_limit;
        const uvec4 cursor = ROW_AT(active_clips, at);
        const uint flags = ROW_AT(active_clips, at + 1).w;
        main.cursor = ClipCursor(cursor.x, cursor.y, cursor.z, uintBitsToFloat(cursor.w));
        const bool is_all = (flags & (kActiveClipEnds | kActiveClipAdditive | kActiveClipMasked)) == kActiveClipEnds;
        main.others_weight = is_all ? 0 : 1;
        return main;
    }
    const InstanceCursor cursor = cursors[instance];
    main.cursor = cursor.second;
    if (cursor.weight >= 0.5) main.cursor = cursor.first;
    main.others_weight = min(cursor.weight, 1 - cursor.weight);
    return main;
}

// The rest pose has one row and thus no stride.
float time_of_row(ClipTimeline timeline, uint row) {
    return time_at(timeline.first_time + (row - timeline.first_row) / max(timeline.row_stride, 1u));
}

// Gives an instance that is drawn the row of the shared pose that is nearest to its own. If the view does not see the
// difference, the instance is not animated.
uint shared_verdict(CullView view, CullPush push, Affine world_from_model, uint instance, uint verdict) {
    if (push.own_row_count == 0 || (verdict & kVerdictDrawn) == 0) return verdict;
    const MainClip main = main_clip(push, instance);
    const uint clip = main.cursor.first_track / push.joint_count;
    const SharedClip shared_clip = shared_clips[clip];
    const ClipTimeline timeline = load_timeline(clip);
    const float time_s = mix(time_of_row(timeline, main.cursor.earlier), time_of_row(timeline, main.cursor.later),
                             main.cursor.fraction);
    const uint nearest = uint(time_s * shared_clip.intervals_per_s + 0.5);
    skin_rows[instance] = shared_clip.first_row + min(nearest, shared_clip.interval_count);
    const float off = shared_clip.error + main.others_weight * push.pose_spread;
    const bool is_near = main.others_weight < 1 &&
                         off * largest_scale(world_from_model) * view.shared_pixels <=
                             distance_to_box(view, world_from_model, push.centre.xyz, push.half_extent.xyz);
    return is_near ? verdict & ~kVerdictAnimated : verdict;
}
