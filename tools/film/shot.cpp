#include "tools/film/shot.h"

#include "tools/cli/drawn.h"

#include <utility>

namespace throng::tools {

namespace {

// Skeletons show all joints, so they need all model matrices.
CrowdSettings crowd_settings(const RenderOptions& options) {
    return {
        .keep_model_matrices = options.skeletons,
        .culling = !options.everything ? std::optional(Culling{.reduces_joints = !options.skeletons}) : std::nullopt,
        .skin_blend = options.skin_blend,
        .skins_once = options.skins_once};
}

RendererSettings renderer_settings(const RenderOptions& options) {
    RendererSettings settings = parse_size(options.size);
    settings.path = options.renderer;
    return settings;
}

}  // namespace

Shot::Shot(const Device& device, const RenderOptions& options)
    : settings_(renderer_settings(options)),
      path_(make_camera_path(options.camera)),
      scene_(device, options.scene, crowd_settings(options)),
      renderer_(unwrap(Renderer::create(device, settings_))),
      culls_(!options.everything),
      follows_(path_.follows() && scene_.may_move()) {
    unwrap(renderer_.set_options(
        {.lod_pixels = options.lod_pixels, .skeletons = options.skeletons, .bounds = options.bounds}));
    scene_.follow(path_.followed_character());
    scene_.start();
}

void Shot::skip(double step_s) {
    scene_.step_unseen(static_cast<float>(step_s));
    if (follows_) scene_.step_unseen(0);
}

RenderResult Shot::draw(double step_s, double time_s) {
    if (follows_) scene_.step_unseen(static_cast<float>(std::exchange(step_s, 0)));
    const Camera camera = path_.at(
        time_s, scene_.subject(static_cast<float>(settings_.width) / static_cast<float>(settings_.height)));
    RenderResult result;
    scene_.step(static_cast<float>(step_s),
                [&](float part_s) { result = unwrap(renderer_.render_frame(scene_.crowd(), part_s, camera)); });
    return result;
}

std::vector<uint32_t> Shot::count_drawn() {
    if (!culls_) return {crowd().instance_count()};
    return count_by_lod(unwrap(scene_.crowd().read_drawn()));
}

FrameTimes Shot::times() const {
    const Result<StageTimes> stages = crowd().stage_times();
    return {stages ? *stages : StageTimes{}, renderer_.draw_ms()};
}

}  // namespace throng::tools
