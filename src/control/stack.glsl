// The stack of what a layer plays. C++ too (gpu/glsl.h).

// A new play leads; where its fade is 1 nothing of the others is seen.
void push_play(INOUT(LayerState) state, LayerPlay play) {
    if (state.play_count == 0) play.fade = 1;
    state.plays[2] = state.plays[1];
    state.plays[1] = state.plays[0];
    state.plays[0] = play;
    state.play_count = play.fade >= 1 ? 1 : min(state.play_count + 1, kStackSize);
}
