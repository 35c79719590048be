// For an application's compute shader: writes commands for the instances of an OutputBlock (throng/commands.h), which
// the next update obeys. If several commands set the same thing of one instance, the last in the buffer counts; which
// invocation writes last is undefined. Before this file is included, THRONG_COMMAND_SET and THRONG_COMMAND_BINDING say
// where OutputBlock::command is bound.
#ifndef THRONG_COMMANDS_GLSL
#define THRONG_COMMANDS_GLSL

const uint kThrongRestPose = 0xFFFFFFFFu, kThrongAllJoints = 0xFFFFFFFFu;  // in place of a clip, of a mask

struct ThrongCommand {
    uint instance, kind, target, unused;
    uvec4 data[3];
};

layout(set = THRONG_COMMAND_SET, binding = THRONG_COMMAND_BINDING, std430) buffer ThrongCommands {
    uint count, lost, ignored, unused[13];
    ThrongCommand commands[];
}
throng_commands;

void throng_ask(uint instance, uint kind, uint target, uvec4 data0, uvec4 data1, uvec4 data2) {
    const uint i = atomicAdd(throng_commands.count, 1);
    if (i < throng_commands.commands.length())
        throng_commands.commands[i] = ThrongCommand(instance, kind, target, 0, uvec4[3](data0, data1, data2));
}

// Clip, whether it loops, time and speed.
uvec4 throng_clip(uint clip, bool loops, float time_s, float speed) {
    return uvec4(clip, loops ? 1 : 0, floatBitsToUint(time_s), floatBitsToUint(speed));
}

// These two only work where ShaderCommands::populate is set. `world_from_model` is given row by row.
void throng_spawn(uint instance, vec4 world_from_model[3]) {
    throng_ask(instance, 1, 0, floatBitsToUint(world_from_model[0]), floatBitsToUint(world_from_model[1]),
               floatBitsToUint(world_from_model[2]));
}
void throng_despawn(uint instance) { throng_ask(instance, 2, 0, uvec4(0), uvec4(0), uvec4(0)); }

void throng_set_placement(uint instance, vec4 world_from_model[3]) {
    throng_ask(instance, 3, 0, floatBitsToUint(world_from_model[0]), floatBitsToUint(world_from_model[1]),
               floatBitsToUint(world_from_model[2]));
}

// For groups without a controller. Get `first` and `second` from throng_clip(); `weight` is that of the first.
void throng_set_playback(uint instance, uvec4 first, uvec4 second, float weight) {
    throng_ask(instance, 4, 0, first, second, uvec4(floatBitsToUint(weight), 0, 0, 0));
}

// For groups with a controller.
void throng_play(uint instance, uint layer, uvec4 clip, float fade_s, bool is_inertial) {
    throng_ask(instance, 5, layer, clip, uvec4(floatBitsToUint(fade_s), is_inertial ? 1 : 0, 0, 0), uvec4(0));
}
void throng_set_layer(uint instance, uint layer, float weight, bool is_additive, uint mask, float fade_s) {
    throng_ask(instance, 6, layer, uvec4(floatBitsToUint(weight), is_additive ? 1 : 0, mask, floatBitsToUint(fade_s)),
               uvec4(0), uvec4(0));
}
void throng_set_parameter(uint instance, uint parameter, float value) {
    throng_ask(instance, 7, parameter, uvec4(floatBitsToUint(value), 0, 0, 0), uvec4(0), uvec4(0));
}

void throng_set_look(uint instance, vec3 tint, uint outfit) {
    throng_ask(instance, 8, 0, uvec4(floatBitsToUint(tint), outfit), uvec4(0), uvec4(0));
}

#endif
