// A scene, its camera and its renderer: what 'throng render' makes a picture or a film of.
#pragma once

#include "tools/scene/camera_path.h"
#include "tools/scene/crowd_scene.h"
#include "tools/film/frame_times.h"

#include <cstdint>
#include <string>
#include <vector>

namespace throng::tools {

struct RenderOptions {
    SceneOptions scene;
    CameraOptions camera;
    std::string size = "1920x1080", out, device;
    double time_s = 0;          // of the first picture
    std::string frames, shard;  // empty: one picture; all frames
    double fps = 30;
    float lod_pixels = 1;
    SkinBlend skin_blend = SkinBlend::kLinear;
    DrawPath renderer = DrawPath::kAuto;
    bool skins_once = false, everything = false, skeletons = false, bounds = false, json = false;
    bool force = false;  // draw a finished film anew
};

class Shot {
public:
    Shot(const Device& device, const RenderOptions& options);

    // Advances all characters by `step_s`; draw() also draws them as the camera sees them at `time_s`.
    RenderResult draw(double step_s, double time_s);
    void skip(double step_s);

    const Crowd& crowd() const { return scene_.crowd(); }
    bool is_drawn_natively() const { return renderer_.is_native(); }
    // What the last draw() drew: characters per level of detail, the finest first; all of them if the crowd does not
    // cull.
    std::vector<uint32_t> count_drawn();
    FrameTimes times() const;  // of the last draw()

private:
    RendererSettings settings_;
    CameraPath path_;
    CrowdScene scene_;
    Renderer renderer_;
    bool culls_;
    // The camera follows a character that updates may move. Each step then takes two updates: one that moves the
    // character, and one of no time that shows what the camera sees afterwards
    bool follows_;
};

}  // namespace throng::tools
