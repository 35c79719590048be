// What the steer stage reads and writes. Shared by C++ and GLSL. docs/steering.md defines what it computes.
#ifndef THRONG_STEER_IO_H
#define THRONG_STEER_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kSteerWorkgroupSize = 64;
THRONG_IO_CONSTANT kMaxMet = 64;          // agents of a bucket that are examined at most
THRONG_IO_CONSTANT kAgentGridLimit = 8;   // grids, one for each size class; the last has all smaller agents too
THRONG_IO_CONSTANT kAgentCellLimit = 32;  // cells of a finer grid that an agent searches in each direction at most

// The data of an agent that others read, a row of a table.
struct AgentPlace {
    float x, z;  // world space
    float radius;
    uint next;  // next agent in the same bucket; kNone: end of the list
};

// State of an agent between updates.
struct AgentState {
    float speed;     // chosen in the last update, world units a second
    float patience;  // 1, falling to 0 while it is held up
    uint stands;     // 1: it has arrived
};

struct PlacesPush {
    uint instance_count;
    uint first_agent;  // index among all agents of the crowd
    float radius;
    uint grid;           // the grid of these agents
    float inverse_cell;  // 1 / the width of its cells
    uint bucket_mask;    // buckets - 1
    uint birth;          // control/births.glsl
};

struct SteerPush {
    uint instance_count;
    uint first_agent;
    uint bucket_mask;
    float speed;               // maximum
    float turn_cos, turn_sin;  // of the largest turn in this update, up to half a turn
    float time_step_s;         // if not above 0, only newborn agents are initialized
    uint is_carried;           // by the root motion of its clips
    uint parameter_count;
    uint speed_parameter;  // or kNone
    uint birth;
    uint grid_count;
    float largest[kAgentGridLimit];  // largest radius in each grid; a grid's agents are larger than those of the next
    float inverse_cells[kAgentGridLimit];
};

THRONG_IO_END
#endif
