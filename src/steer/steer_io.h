// What the steer stage reads and writes. Shared by C++ and GLSL. docs/steering.md defines what it computes.
#ifndef THRONG_STEER_IO_H
#define THRONG_STEER_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSteerWorkgroupSize = 64;
THRONG_IO_CONSTANT kMostMet = 64;         // agents of a bucket that are looked at
THRONG_IO_CONSTANT kAgentGridLimit = 8;   // grids, one for each size; the last also for all that are smaller
THRONG_IO_CONSTANT kAgentCellLimit = 32;  // cells of smaller agents that an agent searches in each direction

// An agent as others see it, a row of a table.
struct AgentPlace {
    float x, z;  // world space
    float radius;
    uint next;  // agent of the same bucket; kNone: the last
};

// What is kept of an agent from one update to the next.
struct AgentState {
    float speed;     // that it wanted, world units a second
    float patience;  // 1, falling to 0 while it is held up
    uint stands;     // 1: it has arrived
};

struct PlacesPush {
    uint instance_count;
    uint first_agent;  // of all agents of the crowd
    float radius;
    uint grid;           // the one that its agents are in
    float inverse_cell;  // 1 / the width of a cell of it
    uint bucket_mask;    // buckets - 1
    uint birth;          // control/births.glsl
};

struct SteerPush {
    uint instance_count;
    uint first_agent;
    uint bucket_mask;
    float speed;               // at most
    float turn_cos, turn_sin;  // of the angle that it turns in this update at most, up to half a turn
    float time_step_s;         // at 0 or below, agents that are born begin and nothing else happens
    uint is_carried;           // by the root motion of its clips
    uint parameter_count;
    uint speed_parameter;  // or kNone
    uint birth;
    uint grid_count;
    float largest[kAgentGridLimit];  // radius in each grid; the next grid's agents are smaller than all of this one's
    float inverse_cells[kAgentGridLimit];
};

THRONG_IO_END
#endif
