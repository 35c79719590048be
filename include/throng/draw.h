// Drawing crowds to a picture: skinned, instanced, lit by one directional light, on a ground.
#pragma once

#include <throng/crowd.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace throng {

// 8-bit RGBA, sRGB, rows from the top.
struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba{};  // [height][width][4]
};

// Writes a PNG to a temporary name beside `path`, then renames it. Errors: kFile, kInvalidArgument (no pixels, or
// another number of bytes than they take), kLimit (2 GiB).
Result<void> write_png(const std::filesystem::path& path, const Picture& picture);

struct Camera {
    Vec3<float> eye{0, 2, 5};  // world space
    // In the middle of the picture. The near plane lies at a 50,000th of the target's distance from the eye
    Vec3<float> target{0, 1, 0};
    float vertical_field_of_view_rad = 0.7f;
};

struct Bounds {
    Vec3<float> min{}, max{};
};

// Calls that take a const Crowd use it too: one thread at a time per crowd.

// World bounds of the instances' rest poses at their placements. Placements are those that the application has set; for
// groups whose updates move instances, those after a recent update, if a Renderer has prepared or drawn the crowd. If
// none has, instances of groups that shaders populate (ShaderCommands::populate) do not count.
Bounds world_bounds(const Crowd& crowd);
// The same without outliers: the few instances, at most a hundredth (one if there are fewer than a hundred), that stand
// so far away that in a picture fitted to include them all others would be too small to see.
Bounds main_bounds(const Crowd& crowd);
Bounds main_bounds(std::span<const Crowd* const> crowds);  // of all of them
// A camera that looks down on the bounds from the front right and holds them in view. For a crowd of many thousands the
// corners extend beyond the picture, so that the nearest characters are large enough to be recognised.
Camera fit_camera(const Bounds& bounds, float aspect_ratio);

// How pictures look; may change from frame to frame.
struct DrawOptions {
    bool shadows = true;
    // render_frame() and record() leave out characters hidden behind others, in crowds that cull. Takes one more pass,
    // the depths of those that were visible in the last frame: worth it where some are large and hide many. No effect
    // where this machine's processor draws.
    bool occlusion = false;
    // How many pixels a coarser level of detail may be off by, in crowds that cull (render_frame(), record(),
    // view_of()); above 0
    float lod_pixels = 1;
    float full_rate_pixels = 0, budget_ms = 0;  // CrowdView's, for crowds that skip updates
    float shared_pose_pixels = 1;               // CrowdView's, for groups with a skin pool
    bool fog = true;                            // the ground and what is far away fade into the horizon
    float exposure = 1;                         // all light is multiplied by it; above 0
    Vec3<float> to_sun{-0.45f, 0.85f, 0.5f};    // world space, of any length; y at least a twentieth of it
    // A line from each joint to its parent, over everything, coloured by level; of crowds that keep model matrices
    bool skeletons = false;
    bool bounds = false;  // the boxes that culling tests
};

// What the camera sees in a picture of this size, shadows of the crowd included: for an update that is drawn with the
// same camera and options, or with CrowdView::clip_from_world itself. CrowdView::occlusion is not set, since the second
// half of such an update is up to the caller.
//
// Shadows are included of characters up to twice as high as the bounds (Renderer also looks at all poses); enlarge the
// bounds for a crowd whose clips jump or fly. Depth is reversed and infinite: 1 at the near plane, 0 infinitely far
// away; y of the clip space points down, as in Vulkan. Errors: kInvalidArgument (camera, options).
Result<CrowdView> view_of(const Camera& camera, uint32_t width, uint32_t height, const Bounds& bounds,
                          const DrawOptions& options = {});

// What draws: kNative, this machine's processor, on native and software devices; kDevice, the device's shaders, on all
// but native ones. kAuto: natively where possible. Both draw the same picture, except for rounding.
enum class DrawPath { kAuto, kNative, kDevice };

struct RendererSettings {
    uint32_t width = 1920, height = 1080;  // at most the device's limit; natively 16,384
    uint32_t samples = 4;                  // lowered to what the device has; natively 1 or 4
    DrawOptions options = {};
    DrawPath path = DrawPath::kAuto;
    bool blue_first = false;  // then picture() is of VK_FORMAT_B8G8R8A8_SRGB, as most displays are
};

struct RenderResult {
    Picture picture{};
    // Milliseconds of skinning and drawing: of the GPU, 0 where the queue has no timestamps; natively, by the clock
    double draw_ms = 0;
    std::vector<std::string>
        warnings{};  // textures that could not be decoded and are drawn white (recorded pictures have none)
};

// Decodes the images of a crowd's materials on the calling thread, which uses the crowd meanwhile, so that the thread
// that draws need not: for crowds that a loading thread makes, while no other thread draws them. The decoded images
// stay with the crowd's groups, also when Crowd::add_groups() takes these into another crowd, until a Renderer has made
// textures of them; meanwhile they take host memory. Images that cannot be decoded are left to the renderer, which
// warns of them. Errors: kOutOfMemory.
Result<void> decode_images(const Crowd& crowd);

struct RendererState;  // internal

// Natively it needs no Vulkan, and uses it only in record(), record_drawing() and picture(); otherwise it needs a
// device with a graphics queue and dynamicRendering. Not thread-safe.
class Renderer {
public:
    // Errors: kNoDevice (no graphics queue; DrawPath::kDevice on a native device), kUnsupported (DrawPath::kNative on a
    // GPU), kLimit (size), kInvalidArgument (size, options).
    static Result<Renderer> create(const Device& device, const RendererSettings& settings = {});
    // No renderer yet, as with Crowd().
    Renderer() noexcept;
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;
    ~Renderer();

    // Makes what drawing this crowd needs, its pipelines and textures, so that its first picture has nothing to decode
    // or compile. The textures are uploaded by the commands of the next two or three pictures, and kept in host memory
    // until some pictures later. From this call on, updates copy the placements that they move back to the CPU, 48
    // bytes each, for world_bounds(), main_bounds() and what is fitted to them. If updates have moved instances before
    // (root motion, steering, terrain, shaders), it submits and waits once, to read where they are. Errors:
    // kInvalidArgument (a crowd of another device, or with a group of sockets_only; DrawOptions::skeletons without
    // keep_model_matrices), kOutOfMemory.
    Result<void> prepare(const Crowd& crowd);

    // The calls below draw one crowd, or several different ones, in one picture, with one sun and one ground. Several
    // crowds look the same as one crowd with all of their groups would. Errors of all: kInvalidArgument (no crowd, one
    // that is null or is given twice, of another device, or with a group of sockets_only; DrawOptions::skeletons
    // without CrowdSettings::keep_model_matrices; the camera).

    // Draws crowds as their last update left them (of crowds that cull, what it has listed; before the first update,
    // nothing); submits and waits. Ground, fog and shadows are fitted to main_bounds(). Alpha-blended materials cover
    // as many of a pixel's samples as their alpha says (alpha to coverage), since a crowd is not sorted. Errors: also
    // kInvalidArgument (the commands of a crowd's last record() have been neither submitted nor discarded).
    Result<RenderResult> render(const Crowd& crowd, const Camera& camera);
    Result<RenderResult> render(std::span<const Crowd* const> crowds, const Camera& camera);

    // As render(), but first advances crowds by `time_step_s`, as Crowd::update() does, for what the camera sees if the
    // crowd culls. The update and the picture are one submission (native work runs beside it).
    Result<RenderResult> render_frame(Crowd& crowd, float time_step_s, const Camera& camera);
    Result<RenderResult> render_frame(std::span<Crowd* const> crowds, float time_step_s, const Camera& camera);

    // Records the same into the caller's command buffer (recording, outside a render pass, of the device's queue
    // family). The picture is then in picture(), in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL and visible to transfer reads,
    // until the next frame. The device draws whatever the path, since the crowd is updated there.
    //
    // The recorded commands must be submitted once, in the order of the calls, to the device's queue, and must have
    // finished before the renderer or the crowd is destroyed, or the renderer resized. Frames may be recorded before
    // the last has finished. If the commands will never be submitted, call Crowd::discard_last_record() for each crowd
    // that record() was given. What was bound for graphics and compute, the index buffer, and the states that the
    // pipelines set dynamically (viewport, scissor, cull mode) are undefined afterwards.
    //
    // Nothing is submitted. For groups that this renderer has not drawn yet, the commands upload textures too, and so
    // do those of the next few frames, until it is known that some have run. If updates had moved instances of a crowd
    // that no renderer had drawn or prepared, the first pictures are fitted to the places that the application has
    // set, later ones to where updates have moved the instances. prepare() avoids that. After an error no crowd has
    // been updated, except for one whose own record() failed half-way. Errors: kUnsupported (a native device).
    Result<void> record(VkCommandBuffer commands, Crowd& crowd, float time_step_s, const Camera& camera);
    Result<void> record(VkCommandBuffer commands, std::span<Crowd* const> crowds, float time_step_s,
                        const Camera& camera);
    // The two halves of record(), for crowds that are updated natively on a software device (UpdatePath::kNative):
    // record() itself would update them on the device. update() is Crowd::update() for what the camera sees, without
    // occlusion, at once. record_drawing() is the drawing alone, of the crowd as its last update left it when the
    // commands run. With native drawing the picture is drawn at once, and the commands copy it; but if that last update
    // is recorded and may not have run, the device draws.
    Result<void> update(Crowd& crowd, float time_step_s, const Camera& camera);
    Result<void> update(std::span<Crowd* const> crowds, float time_step_s, const Camera& camera);
    Result<void> record_drawing(VkCommandBuffer commands, const Crowd& crowd, const Camera& camera);
    Result<void> record_drawing(VkCommandBuffer commands, std::span<const Crowd* const> crowds, const Camera& camera);
    // VK_FORMAT_R8G8B8A8_SRGB (RendererSettings::blue_first: VK_FORMAT_B8G8R8A8_SRGB), of the renderer's size; another
    // image after resize(). Null on a native device.
    VkImage picture() const;
    // Errors: kInvalidArgument (empty), kLimit (names the device's limit); after an error it keeps its size.
    Result<void> resize(uint32_t width, uint32_t height);

    // From the next frame on. Errors: kInvalidArgument (exposure, sun, lod_pixels, full_rate_pixels, budget_ms,
    // shared_pose_pixels).
    Result<void> set_options(const DrawOptions& options);
    const DrawOptions& options() const;

    // RenderResult::draw_ms of the last frame that has finished; 0 if none has.
    double draw_ms() const;
    // Whether this machine's processor draws.
    bool is_native() const;

    // Internal.
    explicit Renderer(std::unique_ptr<RendererState> state);
    RendererState& state() const;  // throws where there is none

private:
    std::unique_ptr<RendererState> state_;
};

}  // namespace throng
