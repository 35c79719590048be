// control: advances each instance's clips by the time step and finds the rows of keys that the sample stage
// interpolates. One invocation per instance; cost: a binary search per clip.
#include "gpu/buffers_io.h"
#include "control/control_io.h"
#include "control/births.glsl"

WORKGROUP(kControlWorkgroupSize);
BUFFER(kPlaybacksBuffer, InstancePlayback, playbacks);
TABLE_OF_WORDS(kTimelineBuffer, timelines);
TABLE_OF_WORDS(kTimesBuffer, times);
WRITEONLY_BUFFER(kCursorsBuffer, InstanceCursor, cursors);
PUSH(ControlPush);

#include "control/control.glsl"

ClipCursor advance(INOUT(ClipPlay) play) {
    const ClipTimeline timeline = load_timeline(play.clip);
    play.time_s = local_time(play.time_s + push.time_step_s * play.speed, timeline.duration_s, play.loop != 0);
    ClipCursor cursor = find_rows(timeline, play.time_s);
    cursor.first_track = play.clip * push.joint_count;
    return cursor;
}

void main() {
    const uint instance = gl_GlobalInvocationID.x;
    if (instance >= push.instance_count || !is_there(instance, push.birth)) return;
    InstancePlayback playback = playbacks[instance];
    InstanceCursor cursor;
    cursor.first = advance(playback.first);
    cursor.second = advance(playback.second);
    cursor.weight = playback.weight;
    playbacks[instance].first.time_s = playback.first.time_s;
    playbacks[instance].second.time_s = playback.second.time_s;
    cursors[instance] = cursor;
}
