// What panels, keys and the mouse change, and what the viewer acts on.
#pragma once

#include "tools/view/history.h"
#include "tools/view/orbit.h"
#include "tools/view/scene.h"

#include <throng/draw.h>

#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace throng::view {

inline constexpr const char* kByHand = "by hand";

struct State {
    SceneSettings wanted;                // applied at the end of the frame; reset to the current ones if that fails
    std::optional<int> sliding_count;    // while the slider is held
    std::optional<uint64_t> typed_seed;  // while it is typed
    DrawOptions drawing;
    Orbit orbit;
    bool flies = false;            // drags turn the head, not the crowd
    std::string camera = kByHand;  // or a tools::CameraPath, which leads `orbit` until the user takes over

    bool paused = false;
    bool steps = false;  // advance by one frame while paused
    float time_factor = 1;

    bool shows_panels = true, shows_keys = false;
    PicturePart free_part;  // the part without panels; the target of `orbit` is shown in its middle
    Camera picture_camera;  // of the whole picture, chosen so that free_part shows what `orbit` sees
    std::optional<uint32_t> selected;

    bool resets_view = true;
    bool takes_screenshot = false;
    bool closes = false;

    // Takes the camera from the path that leads it, if there is one.
    void see_whole_crowd() {
        camera = kByHand;
        resets_view = true;
    }

    // Shows a message in the window for a while; errors go to stderr too.
    void say(std::string text) {
        message = std::move(text);
        message_is_error = false;
        message_age_s = 0;
    }
    void complain(std::string text) {
        say(std::move(text));
        message_is_error = true;
        std::cerr << "throng: " << message << "\n";
    }
    std::string message;
    bool message_is_error = false;
    float message_age_s = 0;
    std::string progress;  // of files that are read; empty: none are
};

// What is known about the last frames.
struct Measured {
    std::string device;
    bool is_software = false;  // its device is the processor
    bool is_drawn_natively = false;
    History history;
    float frame_ms = 0;           // from one picture to the next
    std::vector<uint32_t> drawn;  // of each level of detail
    Feedback feedback;            // of the character that was selected, if it has a controller

    const WatchedInstance* watched() const { return feedback.watched.empty() ? nullptr : &feedback.watched.front(); }
};

}  // namespace throng::view
