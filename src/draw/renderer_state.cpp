#include "draw/renderer_state.h"

#include "base/failure.h"
#include "draw/camera.h"

namespace throng {

RendererState::RendererState(std::shared_ptr<Gpu> gpu_in, const DrawOptions& options_in)
    : gpu(std::move(gpu_in)), options(checked(options_in)) {}

void RendererState::update(Crowd& crowd, float time_step_s, const Camera& camera) const {
    CrowdState& state = crowd.state();
    if (!state.cull) return state.update(time_step_s, nullptr);
    const CrowdView view = view_of(crowd, camera);
    state.update(time_step_s, &view);
}

void RendererState::accept(const Crowd& crowd) const {
    CrowdState& state = crowd.state();
    if (state.gpu != gpu) throw Failure(ErrorCode::kInvalidArgument, "render", "the crowd lives on another device");
    for (const Group& group : state.groups)
        if (group.sockets_only)
            throw Failure(ErrorCode::kInvalidArgument, "render", group.name + " has sockets only, and nothing to draw");
    if (options.skeletons && !state.batches.front()[io::kModelBuffer])
        throw Failure(ErrorCode::kInvalidArgument, "skeletons",
                      "the crowd keeps no model matrices; set CrowdSettings::keep_model_matrices");
    state.placements->follow();
}

CrowdView RendererState::view_of(const Crowd& crowd, const Camera& camera) const {
    return crowd_view_of(camera, extent().width, extent().height, main_bounds(crowd), options);
}

}  // namespace throng
