// What the procedural stage reads and writes. Shared by C++ and GLSL.
//
// The tables of a group, in one buffer of words (gpu/table.glsl): the joints' parents, then chains in the order of
// their ranks and the structs that these refer to. References are the index of a struct's first word.
#ifndef THRONG_PROCEDURAL_IO_H
#define THRONG_PROCEDURAL_IO_H
#include "gpu/shader_types.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kProceduralWorkgroupSize = 64;
THRONG_IO_CONSTANT kColliderLimit = 16;  // of a spring rule
// Largest magnitude of a number in a rule or a target: squares, and their products with other numbers, must fit a float
THRONG_IO_FLOAT kFarthest = 1e15f;

// Joints moved by one rule; each one is the parent of the next.
struct ProceduralChain {
    uint rule;         // word of its settings
    uint first_joint;  // word of its first ProceduralJoint
    uint joint_count;
    uint first_generation;  // generations from the rule's joint to first_joint
    uint first_spring;      // index in an instance's SpringStates
};
THRONG_IO_CONSTANT kChainWind = 0;
THRONG_IO_CONSTANT kChainSpring = 1;
THRONG_IO_CONSTANT kChainLookAt = 2;  // one joint
THRONG_IO_CONSTANT kChainReach = 3;   // grandparent, parent, joint
THRONG_IO_CONSTANT kChainKindCount = 4;

struct ProceduralJoint {
    uint joint;
    float bone_x, bone_y, bone_z;  // in joint space; 0 if it has no bone
};

struct WindSettings {
    float bend_rad, sway_rad, sway_hz;
};

struct SpringSettings {
    float stiffness;  // 1/s^2
    float damping;    // 1/s
    float gravity_x, gravity_y, gravity_z;
    float drag;
    float radius;
    uint first_collider, collider_count;  // word
};

struct ColliderShape {
    uint joint;
    float ax, ay, az;
    float bx, by, bz;
    float radius;
};

struct LookAtSettings {
    float forward_x, forward_y, forward_z;  // unit length
    float limit_rad;
    float weight;
    uint target;
};

struct ReachSettings {
    float pole_x, pole_y, pole_z;  // unit length
    float weight;
    uint target;
};

// State of a bone's end between updates, along the world's axes.
struct SpringState {
    vec4 place;     // relative to the instance's origin
    vec4 velocity;  // per second
    vec4 origin;    // the instance's origin in the last update; w: 1, or 0 before the first update
};

struct ProceduralPush {
    uint instance_count;
    uint first_instance;  // index in the crowd
    uint joint_count;
    uint spring_count;  // SpringStates of an instance
    uint target_count;
    uint first_chain;  // word of the first chain of this dispatch
    uint workgroups;   // for each chain
    float time_step_s;
    float sway_time_s;  // 0..64, for frequencies that are multiples of 1/64
    float wind_speed;
    float wind_x, wind_y, wind_z;  // unit length
    float gust;
    float gust_rate;                              // 1 / wavelength
    float gust_phase0, gust_phase1, gust_phase2;  // cycles, 0..1
    uint birth;                                   // control/births.glsl
};

THRONG_IO_END
#endif
