// The window and what it shows, frame by frame.
#pragma once

#include "tools/scene/crowd_scene.h"
#include "tools/view/display.h"
#include "tools/view/gui.h"
#include "tools/view/loader.h"
#include "tools/view/script.h"
#include "tools/view/state.h"

#include <chrono>
#include <filesystem>

namespace throng::view {

struct ViewOptions {
    tools::SceneOptions scene;
    tools::CameraOptions camera;
    std::string device;
    RendererSettings size;
    std::optional<uint64_t> frames;  // ends after this many
    // File for screenshots, also for that of the last of `frames`. If empty, names are made up, and the last frame gets
    // none
    std::string screenshot;
    std::string script, dump;  // files, for tests
};

class Viewer {
public:
    // Throws a CommandError if a file cannot be read, or there is no display or no device that can use it.
    explicit Viewer(const ViewOptions& options);
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    // Runs until the window is closed. Throws a CommandError if the device fails.
    void run();

private:
    bool is_done() const;
    // Whether the selected character is watched: if it has a controller, only the device knows what that does
    bool watches() const { return state_.selected && scene_.controller_of(scene_.group_of(*state_.selected)); }
    // If so, every frame counts as a sixtieth of a second, however long it takes
    bool is_scripted() const { return script_ || options_.frames; }
    void show_frame();
    void resize();
    void move_camera(float aspect_ratio);  // of the whole picture
    void draw_panels();
    void record();
    bool shows_later() const;
    float next_time_step();
    void measure();
    void save_shot();
    void take_dropped();
    void take_loaded();
    void use_json(const std::string& file);
    void take_settings();
    void write_dump() const;

    ViewOptions options_;
    std::vector<std::string> inputs_;  // files, dropped ones included: nothing is written over them
    Window window_;
    Context context_;
    Device device_;
    Display display_;
    Canvas canvas_;
    Gui gui_;
    Renderer renderer_;
    Scene scene_;
    Loader loader_;
    std::string reading_;                    // what `state_.progress` says while files are read
    std::vector<std::string> dropped_json_;  // files, to be used once the characters are there
    std::optional<Script> script_;
    State state_;
    Measured measured_;
    std::optional<tools::CameraPath> path_;  // of state_.camera
    std::string path_name_;
    double path_time_s_ = 0;
    std::chrono::steady_clock::time_point last_frame_ = std::chrono::steady_clock::now();
    std::filesystem::path shot_;  // to be written of this frame; empty: none
    uint64_t frame_ = 0;
};

}  // namespace throng::view
