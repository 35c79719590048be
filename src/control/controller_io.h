// What the controller kernel reads and writes. Shared by C++ and GLSL. docs/controller.md defines what it computes.
//
// The tables of a group lie one after another in one buffer of words (gpu/table.glsl). Each member of a struct takes
// one word. ControllerLayout says where each table begins.
#ifndef THRONG_CONTROLLER_IO_H
#define THRONG_CONTROLLER_IO_H
#include "control/control_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kControllerWorkgroupSize = 64;
THRONG_IO_CONSTANT kStackSize = 3;            // plays that a layer cross-fades at once
THRONG_IO_CONSTANT kLastPhase = 0xFFFFFFFFu;  // the end of a clip or state that does not loop

// One clip, beside its ClipTimeline.
struct ControlClip {
    float rate;  // 1 / duration, per second; 0 where it has none
    uint first_event, event_count;
    uint first_root, root_count;  // rows of root motion, evenly spaced in phase from 0 to 1; count 0: none
};

struct ControlLayer {
    uint first_state, state_count;  // count 0: a direct layer, which plays clips
    uint mode;                      // kModeOverride, kModeAdditive; a direct layer begins with it
    uint mask;                      // index or kNone; a direct layer begins with it
    float weight;                   // a direct layer begins with it
    uint weight_parameter;          // or kNone
    uint model_rotations;           // 1: overrides in model space
    uint has_empty_states;          // 1: some states play nothing
};
THRONG_IO_CONSTANT kModeOverride = 0;
THRONG_IO_CONSTANT kModeAdditive = 1;

struct ControlState {
    uint first_point, point_count;        // ControlPoint
    uint first_triangle, triangle_count;  // ControlTriangle; of two parameters only
    uint first_edge, edge_count;          // ControlEdge of the hull; of two parameters only
    uint x_parameter, y_parameter;        // or kNone
    uint speed_parameter;                 // or kNone
    float speed;
    uint loop;
    uint sync;                                // or kNone
    uint first_transition, transition_count;  // out of this state, in order, including those from any state
};

struct ControlPoint {
    uint clip;  // clip_count: the only point of a state that plays nothing
    float x, y;
    float inverse_span;  // one parameter: 1 / (x of the next - x); 0 for the last
};

// Weights at (x, y): u = ax * x + ay * y + a0 for point a, v = bx * x + by * y + b0 for point b, and 1 - u - v for
// point c. Points are indices within the state.
struct ControlTriangle {
    uint a, b, c;
    float ax, ay, a0;
    float bx, by, b0;
};

// An edge of the hull of the points, or of the line they all lie on. The nearest place is a + t (b - a), t = clamp(((x,
// y) - a) . (dx, dy), 0, 1).
struct ControlEdge {
    uint a, b;
    float dx, dy;  // (b - a) / |b - a|^2
};

// A transition out of the state that lists it.
struct ControlTransition {
    uint to;  // state within the layer
    uint first_condition, condition_count;
    uint exit_loops, exit_phase;
    float fade_rate;  // 1 / seconds; 0: at once
    uint flags;
};
THRONG_IO_CONSTANT kTransitionInterrupts = 1;
THRONG_IO_CONSTANT kTransitionInertial = 2;

struct ControlCondition {
    uint parameter;
    uint test;
    float value;
};
THRONG_IO_CONSTANT kTestAbove = 0;      // parameter > value
THRONG_IO_CONSTANT kTestBelow = 1;      // parameter < value
THRONG_IO_CONSTANT kTestTrue = 2;       // parameter != 0
THRONG_IO_CONSTANT kTestFalse = 3;      // parameter == 0
THRONG_IO_CONSTANT kTestTriggered = 4;  // parameter != 0, and the trigger is reset when the update ends

struct ControlEvent {
    uint phase;
    uint event;  // index into Controller::events
};

// Where each table begins, in words. Lies at the start of the buffer.
struct ControllerLayout {
    uint clips, layers, states, points, triangles, edges, transitions, conditions, events;
    uint layer_count, parameter_count, clip_count;
};

// One clip, blend space or state that a layer plays. A clip's or state's time is its phase, in 2^-32 of a cycle.
struct LayerPlay {
    uint motion;  // state of the layer; in a direct layer a clip, where clip_count is the rest pose
    uint phase;
    uint loops;       // whole cycles since it was entered; counted backwards if the state's speed is negative
    float fade;       // how far it has replaced what lies below it, 0..1, linear in time
    float fade_rate;  // 1 / seconds
    float speed;      // direct layers
    uint loop;        // direct layers
};

// What a layer of an instance keeps from update to update.
struct LayerState {
    LayerPlay plays[kStackSize];             // newest first: 0 leads; those from play_count on are stale
    uint play_count;                         // 0: nothing yet
    float weight, weight_goal, weight_rate;  // direct layers: weight moves towards the goal by weight_rate a second
    uint mode, mask;                         // direct layers
    uint taken;                              // transition taken by the last update, or kNone
    float inertial_rate;  // direct layers: 1 / seconds, of an inertial play since the last update; 0: none
};

// One clip as part of an instance's pose: 32 bytes, two rows of a table. Active clips of a layer follow each other;
// their weights sum to 1.
struct ActiveClip {
    uint first_track;     // index into tracks
    uint earlier, later;  // as in ClipCursor
    float fraction;
    float weight;        // within its layer, > 0
    float layer_weight;  // 0..1, the same in all active clips of a layer
    uint reference_row;  // first row of the clip, from which additive differences are taken
    uint flags;          // kActiveClip…, and the mask's index above kActiveClipMaskShift
};
THRONG_IO_CONSTANT kActiveClipBeginsLayer = 1;
THRONG_IO_CONSTANT kActiveClipEndsLayer = 2;
THRONG_IO_CONSTANT kActiveClipEnds = 4;  // the instance's last
THRONG_IO_CONSTANT kActiveClipAdditive = 8;
THRONG_IO_CONSTANT kActiveClipMasked = 16;
THRONG_IO_CONSTANT kActiveClipModelRotations = 32;  // of an override: rotations are blended in model space
THRONG_IO_CONSTANT kActiveClipMaskShift = 8;

// An instance's inertial transition, for the blend stage.
struct InstanceInertia {
    float elapsed_s;  // since the last pose that was shown before it; less than duration_s while it lasts
    float duration_s;
    float shown_step_s;  // between the last two poses shown; 0: there are fewer than two
    uint shown_count;    // poses shown, this update's included, at most 3
    uint begins;         // 1: it begins in this update
    float time_step_s;   // of this update
};

// What root motion does to an instance. Places on the ground are (x, z, cos, sin): a turn about +y, then a shift.
struct RootState {
    vec4 move;     // of the last update, in the character's model space before it
    vec4 place;    // all moves since base was set
    vec4 base[3];  // world_from_model as the application set it; rows
};

// In front of the records.
struct EventHead {
    uint count;  // all that happened, including those that found no room
    uint unused0, unused1, unused2;
};

// An event that happened in an update.
struct EventRecord {
    uint instance;  // of the crowd
    uint event;     // index into Controller::events
    uint layer;
    float time_s;  // after the beginning of the update's time step, 0..time step
};

// Loop counts of plays stop here. The sum of two such numbers fits an int
THRONG_IO_CONSTANT kMaxLoops = 1000000000;

// Longer fades are shortened to this. Their rate would be denormal, and a device may flush it to 0, which means at
// once.
THRONG_IO_FLOAT kLongestFade_s = 8e37f;

// What the CPU asks of an instance. An instance's commands lie together, in the order in which they were given.
struct ControlCommand {
    uint instance;  // of the batch
    uint kind;
    uint target;      // layer, or parameter
    uint motion;      // kCommandPlay: clip; kCommandState: state; kCommandLayer: mask or kNone
    uint phase;       // kCommandPlay, kCommandState; kCommandLayer: mode
    uint loop;        // kCommandPlay; kCommandState: loops since it was entered
    float value;      // kCommandPlay: speed; kCommandLayer: weight goal; kCommandParameter: value
    float fade_rate;  // 1 / seconds; 0: at once
};
THRONG_IO_CONSTANT kCommandPlay = 0;
THRONG_IO_CONSTANT kCommandLayer = 1;
THRONG_IO_CONSTANT kCommandParameter = 2;
THRONG_IO_CONSTANT kCommandPlayInertial = 3;  // kCommandPlay, at full weight at once
THRONG_IO_CONSTANT kCommandBegin = 4;         // resets the instance
THRONG_IO_CONSTANT kCommandState = 5;

struct ControllerPush {
    uint instance_count;
    uint first_instance;  // of the crowd
    uint joint_count;
    uint active_clip_limit;  // active clips kept for each instance
    uint event_capacity;     // records that fit
    float time_step_s;
    uint flags;
    uint birth;  // births.glsl
};
THRONG_IO_CONSTANT kPushHasRootMotion = 1;
THRONG_IO_CONSTANT kPushIsInertial = 4;       // the group has inertial transitions
THRONG_IO_CONSTANT kPushMovesPlacements = 2;  // root motion is applied, not only reported
THRONG_IO_CONSTANT kPushTellsTimes = 8;       // stores times of active clips, for the morph stage

struct CommandPush {
    uint command_count;
    uint layer_count;
    uint parameter_count;
    uint is_inertial;  // the group has inertial transitions
};

THRONG_IO_END
#endif
