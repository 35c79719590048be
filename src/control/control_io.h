// What the control stage reads and writes. Shared by C++ and GLSL.
#ifndef THRONG_CONTROL_IO_H
#define THRONG_CONTROL_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kControlWorkgroupSize = 64;

// One clip as an instance plays it; the only state that lives from frame to frame.
struct ClipPlay {
    uint clip;     // clip index; clip_count is the rest pose
    uint loop;     // 0: clamp
    float time_s;  // within [0, duration] after the first update
    float speed;
};

struct InstancePlayback {
    ClipPlay first, second;
    float weight;  // of first, 0..1; the second clip has the rest
};

// The time axis of a clip.
struct ClipTimeline {
    uint first_time;  // index into times
    uint row_count;   // >= 1
    uint row_stride;  // from one row of keys to the next
    uint first_row;   // where the rows begin: not 0 only for packed keys
    float duration_s;
};

// Where the sample stage finds the keys of one clip for this frame: value = mix(row at `earlier`, row at `later`,
// fraction).
struct ClipCursor {
    uint first_track;     // index into tracks: clip * joint_count
    uint earlier, later;  // first_row + row * row_stride
    float fraction;       // 0..1
};

struct InstanceCursor {
    ClipCursor first, second;
    float weight;
};

struct ControlPush {
    uint instance_count;
    uint joint_count;
    float time_step_s;
    uint birth;  // births.glsl
};

THRONG_IO_END
#endif
