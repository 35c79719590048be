// What keys do: one table, used to look up keys and to fill the panel of keys.
#pragma once

#include "tools/view/state.h"
#include "tools/view/window.h"

#include <span>

namespace throng::view {

// A row of the panel: what the user does, and what it causes.
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

// Runs the commands pressed since the last frame, once for each press, and moves the camera by keys and mouse, unless a
// panel has taken them. A click on the scene is returned as a point of the picture: 0..1 from the left and the top.
struct Click {
    float x, y;
};
std::optional<Click> take_commands(State& state, std::span<const KeyPress> pressed);

// Other gestures, with mouse and files.
std::span<const Gesture> gestures();

}  // namespace throng::view
