// Carries out a command. C++ too (gpu/glsl.h). The includer declares the buffers `layers` and `parameters`, the
// functions of control/rounded.glsl and push_play().

// Does not touch what set_layer() writes: another invocation may be writing it at the same time (command/obey.comp).
void play(uint layer, ControlCommand command) {
    const bool at_once = command.fade_rate == 0 || command.kind == kCommandPlayInertial;
    const bool is_state = command.kind == kCommandState;
    const LayerPlay newest = {command.motion,    command.phase, is_state ? command.loop : 0, float(at_once),
                              command.fade_rate, command.value, is_state ? 0 : command.loop};
    LayerState state;
    state.play_count = layers[layer].play_count;
    for (uint k = 0; k < kStackSize; ++k) state.plays[k] = layers[layer].plays[k];
    push_play(state, newest);
    layers[layer].play_count = state.play_count;
    for (uint k = 0; k < kStackSize; ++k) layers[layer].plays[k] = state.plays[k];
    if (command.kind == kCommandPlayInertial) layers[layer].inertial_rate = command.fade_rate;
}

void set_layer(uint layer, ControlCommand command) {
    layers[layer].weight_goal = command.value;
    layers[layer].weight_rate = product(abs(difference(command.value, layers[layer].weight)), command.fade_rate);
    if (command.fade_rate == 0) layers[layer].weight = command.value;
    layers[layer].mode = command.phase;
    layers[layer].mask = command.motion;
}

// `layer` and `parameter` are the indices of the target in `layers` and `parameters`. A command uses only one of them.
void obey(ControlCommand command, uint layer, uint parameter) {
    if (command.kind == kCommandPlay || command.kind == kCommandPlayInertial || command.kind == kCommandState)
        play(layer, command);
    else if (command.kind == kCommandLayer)
        set_layer(layer, command);
    else
        parameters[parameter] = command.value;
}
