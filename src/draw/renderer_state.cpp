#include "draw/renderer_state.h"

#include "base/failure.h"
#include "draw/camera.h"

namespace throng {

RendererState::RendererState(std::shared_ptr<Gpu> gpu_in, const DrawOptions& options_in)
    : gpu(std::move(gpu_in)), options(checked(options_in)) {}

void RendererState::update(Crowds crowds, float time_step_s, const Camera& camera) const {
    const CrowdView view = view_of(bounds_of(crowds, Outliers::kLeftOut), camera);
    for (CrowdState* crowd : crowds) crowd->update(time_step_s, crowd->cull ? &view : nullptr);
}

void RendererState::accept(Crowds crowds, bool wait) const {
    for (const CrowdState* crowd : crowds) {
        if (crowd->gpu != gpu)
            throw Failure(ErrorCode::kInvalidArgument, "render",
                          "the crowd was created on another device than the renderer");
        for (const Group& group : crowd->groups)
            if (group.sockets_only)
                throw Failure(ErrorCode::kInvalidArgument, "render",
                              group.name + " has CrowdGroup::sockets_only and cannot be drawn");
        if (options.skeletons && !crowd->batches.front()[io::kModelBuffer])
            throw Failure(ErrorCode::kInvalidArgument, "skeletons",
                          "the crowd keeps no model matrices; set CrowdSettings::keep_model_matrices");
    }
    for (CrowdState* crowd : crowds) crowd->follow_placements(wait);
}

CrowdView RendererState::view_of(const CrowdBounds& crowds, const Camera& camera) const {
    return crowd_view_of(camera, extent().width, extent().height, crowds.rest, crowds.posed.max.y, options);
}

}  // namespace throng
