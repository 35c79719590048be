// The stack of what a layer plays. C++ too (gpu/glsl.h).

// Pushes a new leading play; if its fade is 1, the others are no longer seen and are dropped.
void push_play(INOUT(LayerState) state, LayerPlay play) {
    if (state.play_count == 0) play.fade = 1;
    state.plays[2] = state.plays[1];
    state.plays[1] = state.plays[0];
    state.plays[0] = play;
    state.play_count = play.fade >= 1 ? 1 : min(state.play_count + 1, kStackSize);
}
