// Commands that an application's shaders give to instances. Shared by C++ and GLSL. Defined by
// include/throng/commands.h.
#ifndef THRONG_COMMAND_IO_H
#define THRONG_COMMAND_IO_H
#include "control/controller_io.h"
#include "look/look_io.h"
THRONG_IO_BEGIN

THRONG_IO_CONSTANT kCommandWorkgroupSize = 64;

// throng::CommandHead; the commands follow it.
struct CommandHead {
    uint count;  // including those that did not fit
    uint lost, ignored;
    uint unused0;
    uvec4 unused[3];
};

// throng::InstanceCommand.
struct InstanceCommand {
    uint instance;  // index in the batch
    uint kind;
    uint target;
    uint unused;
    uvec4 data[3];
};

// throng::CommandKind.
THRONG_IO_CONSTANT kNothing = 0;
THRONG_IO_CONSTANT kSpawn = 1;
THRONG_IO_CONSTANT kDespawn = 2;
THRONG_IO_CONSTANT kPlace = 3;
THRONG_IO_CONSTANT kPlayback = 4;
THRONG_IO_CONSTANT kPlay = 5;
THRONG_IO_CONSTANT kBlendLayer = 6;
THRONG_IO_CONSTANT kSetParameter = 7;
THRONG_IO_CONSTANT kSetLook = 8;

// Several commands may set the same property of an instance; only the last of them is carried out. So each property has
// a claim: 1 + the highest index of a command that sets it, or 0. An instance's claims: existence (spawn and despawn),
// placement, look; then its playback or, with a controller, each layer's clip, each layer's blending, and each
// parameter.
THRONG_IO_CONSTANT kClaimPopulation = 0;
THRONG_IO_CONSTANT kClaimPlacement = 1;
THRONG_IO_CONSTANT kClaimLook = 2;
THRONG_IO_CONSTANT kFirstOtherClaim = 3;

struct InstanceCommandPush {
    uint capacity;  // of the command buffer, in commands
    uint instance_count;
    uint clip_count;
    uint layer_count, parameter_count, mask_count;  // of the controller
    uint outfit_count;
    uint target_count;  // of procedural rules
    uint birth;         // control/births.glsl
    uint flags;
};
THRONG_IO_CONSTANT kShadersPopulate = 1;  // shaders may use kSpawn and kDespawn
THRONG_IO_CONSTANT kHasController = 2;
THRONG_IO_CONSTANT kMayBeInertial = 4;  // has inertial transitions or plays
THRONG_IO_CONSTANT kHasRoots = 8;
THRONG_IO_CONSTANT kHasDestinations = 16;
THRONG_IO_CONSTANT kMovesPlacements = 32;  // root motion moves placements

// The part of `changes` that belongs to the buffer `changed`. For each item it holds the item's index in that buffer,
// then the item's words.
struct ScatterPush {
    uint first_word;
    uint count;
    uint item_words;
};

THRONG_IO_END
#endif
