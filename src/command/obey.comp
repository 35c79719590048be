// obey: carries out the commands of an application's shaders for instances that exist. One invocation per command that
//   fits the buffer. Cost: 64 bytes read and one atomic a command; the state that it sets, 4 to 116 bytes, is written.
#include "command/command_io.h"
#include "gpu/affine.glsl"
#include "gpu/buffers_io.h"
#include "gpu/table.glsl"

WORKGROUP(kCommandWorkgroupSize);
BUFFER_WITH_HEAD(kInstanceCommandsBuffer, CommandHead, head, InstanceCommand, commands);
BUFFER(kClaimsBuffer, uint, claims);
BUFFER(kPlacementsBuffer, Affine, placements);
BUFFER(kRootsBuffer, RootState, roots);
BUFFER(kRootRemaindersBuffer, vec2, root_remainders);
BUFFER(kInstanceLooksBuffer, InstanceLook, looks);
BUFFER(kPlaybacksBuffer, InstancePlayback, playbacks);
BUFFER(kLayersBuffer, LayerState, layers);
BUFFER(kParametersBuffer, float, parameters);
TABLE_OF_WORDS(kControllerBuffer, tables);
TABLE_OF_WORDS(kTimelineBuffer, timelines);
TABLE_OF_WORDS(kTimesBuffer, times);
PUSH(InstanceCommandPush);

#include "command/claims.glsl"
#include "command/place.glsl"
#include "control/births.glsl"
#include "control/rounded.glsl"
#include "control/stack.glsl"
#include "control/commands.glsl"
#include "control/control.glsl"

// The phase, in units of 2^-32 of the clip's duration, as in LayerPlay.
uint phase_of(float time_s, float duration_s, bool loops) {
    if (duration_s <= 0) return 0;
    const float cycles = time_s / duration_s;
    if (!loops && cycles >= 1) return kLastPhase;
    const float part = loops ? cycles - floor(cycles) : max(cycles, 0);
    return part < 1 ? uint(part * 4294967296.0) : 0;
}

ClipPlay clip_play_of(uvec4 played) {
    const bool rests = played.x == kNone, loops = played.y != 0;
    ClipPlay play = ClipPlay(push.clip_count, 0, 0, 0);
    if (!rests) {
        const float duration_s = load_timeline(played.x).duration_s;
        play = ClipPlay(played.x, loops ? 1 : 0, local_time(uintBitsToFloat(played.z), duration_s, loops),
                        uintBitsToFloat(played.w));
    }
    return play;
}

// 1 / seconds; 0: no fade.
float rate_of(uint fade_s) {
    const float fade = uintBitsToFloat(fade_s);
    return fade > 0 ? min(1 / min(fade, kLongestFade_s), 1e6) : 0;
}

ControlCommand play_command(InstanceCommand command) {
    const uvec4 played = command.data[0];
    const ClipPlay asked = clip_play_of(played);
    ControlCommand play;
    play.instance = command.instance;
    play.kind = command.data[1].y != 0 ? kCommandPlayInertial : kCommandPlay;
    play.target = command.target;
    play.motion = asked.clip;
    play.phase = phase_of(asked.time_s, load_timeline(asked.clip).duration_s, asked.loop != 0);
    play.loop = played.y != 0 ? 1 : 0;
    play.value = uintBitsToFloat(played.w);
    play.fade_rate = rate_of(command.data[1].x);
    return play;
}

ControlCommand layer_command(InstanceCommand command) {
    ControlCommand blend;
    blend.instance = command.instance;
    blend.kind = kCommandLayer;
    blend.target = command.target;
    blend.motion = command.data[0].z;
    blend.phase = command.data[0].y;
    blend.loop = 0;
    blend.value = uintBitsToFloat(command.data[0].x);
    blend.fade_rate = rate_of(command.data[0].w);
    return blend;
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= command_count()) return;
    const InstanceCommand command = commands[i];
    if (command.kind < kPlace || !takes_claim(i, command) || !is_there(command.instance, push.birth)) return;
    const uint layer = command.instance * push.layer_count + command.target;
    if (command.kind == kPlace) place(command);
    if (command.kind == kSetLook)
        looks[command.instance] = InstanceLook(uintBitsToFloat(command.data[0].x), uintBitsToFloat(command.data[0].y),
                                               uintBitsToFloat(command.data[0].z), command.data[0].w);
    if (command.kind == kPlayback)
        playbacks[command.instance] = InstancePlayback(clip_play_of(command.data[0]), clip_play_of(command.data[1]),
                                                       uintBitsToFloat(command.data[2].x));
    if (command.kind == kPlay) play(layer, play_command(command));
    if (command.kind == kBlendLayer) set_layer(layer, layer_command(command));
    if (command.kind == kSetParameter)
        parameters[command.instance * push.parameter_count + command.target] = uintBitsToFloat(command.data[0].x);
}
