// What keys do: one table, which the keys are looked up in and the panel of keys is made of.
#pragma once

#include "tools/view/state.h"
#include "tools/view/window.h"

#include <span>

namespace throng::view {

// A row of the panel: what a hand does, and what comes of it.
struct Gesture {
    const char* how;
    const char* does;
};

struct Command {
    Gesture gesture;
    unsigned character;  // typed, on whatever keyboard; 0: `key`
    int key;             // of GLFW; 0: none
    void (*run)(State&);
    bool with_ctrl = false;  // the key
};
std::span<const Command> commands();

// Runs what has been typed since the last frame, and moves the camera by keys and mouse, unless a panel has taken them.
// A click at the scene comes back as a point of the picture: 0..1 from the left and the top.
struct Click {
    float x, y;
};
std::optional<Click> take_commands(State& state, std::span<const KeyPress> pressed);

// What else a hand does, with mouse and files.
std::span<const Gesture> gestures();

}  // namespace throng::view
