// What the steer stage reads and writes. Shared by C++ and GLSL. docs/steering.md defines what it computes.
#ifndef THRONG_STEER_IO_H
#define THRONG_STEER_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSteerWorkgroupSize = 64;
THRONG_IO_CONSTANT kMostMet = 64;  // agents of a bucket that are looked at

// An agent as others see it, a row of a table.
struct AgentPlace {
    float x, z;  // world space
    float radius;
    uint next;  // agent of the same bucket; kNone: the last
};

// What is kept of an agent from one update to the next.
struct AgentState {
    float speed;     // that it wanted, world units a second
    float patience;  // 1, down to 0 where it is held up
    uint stands;     // 1: it has arrived
};

struct PlacesPush {
    uint instance_count;
    uint first_agent;  // of all agents of the crowd
    float radius;
    float inverse_cell;  // 1 / the width of a cell
    uint bucket_mask;    // buckets - 1
    uint birth;          // control/births.glsl
};

struct SteerPush {
    uint instance_count;
    uint first_agent;
    float inverse_cell;
    uint bucket_mask;
    float speed;               // at most
    float turn_cos, turn_sin;  // of the angle that it turns in this update at most, up to half a turn
    float time_step_s;         // above 0
    uint is_carried;           // by the root motion of its clips
    uint parameter_count;
    uint speed_parameter;  // or kNone
    uint birth;
};

THRONG_IO_END
#endif
