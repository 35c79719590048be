// Drawing by the device's own shaders.
#pragma once

#include "draw/group_cache.h"
#include "draw/draw_crowd.h"
#include "draw/frame_uploads.h"
#include "draw/occluders.h"
#include "draw/renderer_state.h"
#include "draw/scene.h"
#include "draw/targets.h"
#include "gpu/timestamps.h"

#include <map>

namespace throng {

class VulkanRenderer : public RendererState {
public:
    VulkanRenderer(std::shared_ptr<Gpu> gpu, const RendererSettings& settings);

    RenderResult render(Crowds crowds, const Camera& camera) override;
    RenderResult render_frame(Crowds crowds, float time_step_s, const Camera& camera) override;
    void record(VkCommandBuffer commands, Crowds crowds, float time_step_s, const Camera& camera) override;
    void record_drawing(VkCommandBuffer commands, Crowds crowds, const Camera& camera) override;
    void prepare(Crowds crowds) override;
    void resize(VkExtent2D extent) override;
    VkExtent2D extent() const override { return targets_.extent(); }
    VkImage picture() const override { return targets_.picture(); }
    double draw_ms() const override;
    bool is_native() const override { return false; }

private:
    // How the textures of new groups get to the device: submitted at once, which needs little staging memory, or with
    // the next frame's commands
    enum class Upload { kAtOnce, kInFrame };
    // What a frame needs; making it may fail, or submit, so it comes before anything is recorded.
    struct Frame {
        std::vector<CrowdDrawing> drawings;  // of each crowd
        CrowdBounds bounds;
        io::DrawScene scene;
        bool has_begun = false;  // its timestamps have begun
    };
    CrowdDrawing drawing_of(const CrowdState& crowd, Upload upload);
    std::vector<const GroupBindings*> bindings_of(const CrowdState& crowd, Upload upload);
    Frame frame_of(Crowds crowds, const Camera& camera, Upload upload);
    // Returns whether an update of these crowds tests occlusion. Allocates what the test needs, so that it cannot run
    // out of memory once crowds have been updated.
    bool makes_room_for_occlusion(Crowds crowds);
    // Records the update of these crowds, which may be fewer than the frame shows, and the frame. If that fails, their
    // updates are discarded.
    void record_all(VkCommandBuffer commands, Crowds crowds, float time_step_s, const CrowdView& view, Frame& frame);
    void record_occlusion(VkCommandBuffer commands, Crowds crowds, Frame& frame);
    void begin_draw(VkCommandBuffer commands, Frame& frame);
    void record_frame(VkCommandBuffer commands, Frame& frame);
    void draw_picture(VkCommandBuffer commands, const std::vector<CrowdDrawing>& drawings) const;
    RenderResult result_of(const Frame& frame) const;

    VkSampleCountFlagBits samples_;
    bool blue_first_;
    Targets targets_;
    DepthPass shadow_map_;
    Timestamps stamps_;
    ShaderLayout layout_;
    PipelineSettings pipelines_;
    MaterialSampling sampling_;
    SharedValues textures_;
    FrameUploads uploads_;
    SceneBinding scene_;
    OwnedPipeline ground_;
    std::map<CharacterKind, CharacterPipelines> characters_;
    std::map<bool, LinePipelines> lines_;  // by whether instances are listed
    GroupCache<const GroupBindings> groups_;
    std::optional<Occluders> occluders_;  // made when first needed
};

}  // namespace throng
