// A crowd: instances of compiled characters, each animated on its own, on the GPU, every frame.
#pragma once

#include <throng/character.h>
#include <throng/controller.h>
#include <throng/device.h>
#include <throng/procedural.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

// The methods of the Hierarchy-Scan stage, by name; docs/scan.md describes them.
struct ScanMethodInfo {
    std::string name{};
    std::string summary{};
    std::string source{};
    // false: it needs another memory layout than the other stages have, and runs in `throng bench scan` only
    bool in_crowds = true;
};
std::vector<ScanMethodInfo> scan_methods();

// What "auto" chooses for a rig where updates are staged, and why, in one line. The method may come with its
// invocations a character: "subgroup:8". The choice is made by a cost model of the device: measured, where `throng
// tune` has left its file in the user's cache folder
// ($XDG_CACHE_HOME/throng or ~/.cache/throng), else built in.
struct ScanAdvice {
    std::string method{};
    std::string reason{};
};
Result<ScanAdvice> advise_scan(const Device& device, const Rig& rig, uint32_t instance_count);

// One clip as a character plays it.
struct ClipPlayback {
    uint32_t clip = kNone;  // index of Character::clips; kNone is the rest pose
    double time_s = 0;
    float speed = 1;   // seconds of clip per second; may be negative
    bool loop = true;  // else the time stays within [0, duration]
};

// What one instance plays: `first` with `weight`, `second` with 1 - weight. With weight 1 the second clip costs
// nothing.
struct Playback {
    ClipPlayback first{}, second{};
    float weight = 1;
};

// A clip on a layer without states, above what the layer plays already: fades in within `fade_s` seconds. kInertial:
// only this clip plays from now on, and the difference to what was shown dies away (docs/controller.md, step 10); of
// layers with ControllerLayer::inertial_plays.
struct LayerPlayback {
    ClipPlayback clip{};
    float fade_s = 0;
    FadeKind fade = FadeKind::kCross;
};

// How a layer without states lies on those below it. The weight is reached in `fade_s` seconds, the rest changes at
// once.
struct LayerBlend {
    float weight = 1;
    float fade_s = 0;
    LayerMode mode = LayerMode::kOverride;
    uint32_t mask = kNone;  // index of Controller::masks; kNone: all joints
};

// What the outputs of sockets hold: model_from_joint, or world_from_joint by the instance's placement.
enum class SocketSpace { kModel, kWorld };

// How characters find their way over the ground, the plane of world x and z, y up: agents, that walk to their
// destinations and out of each other's way (docs/steering.md). An agent looks and walks along +z of its model space,
// and has its place at that space's origin.
struct Steering {
    // World units; two agents do not come nearer to each other than the sum of their radii, or three quarters of it
    // after having been held up
    float radius = 0.3f;
    float speed = 1.4f;  // world units a second, at most
    float turn = 3;      // radians a second, at most
    // Parameter of the controller that is told in each update how fast the agent wants to walk, in units of its model
    // space a second; 0: it stands
    uint32_t speed_parameter = kNone;
};

// Heights of the ground over a grid of points, bilinear between them; beyond its edges as at the nearest point.
struct Terrain {
    float x = 0, z = 0;              // of the first point, world space
    float spacing = 1;               // of neighbouring points along x and z; above 0
    uint32_t columns = 0, rows = 0;  // points along x, along z
    std::vector<float> heights{};    // [rows][columns], world y
};

// Instances of one character. Instances of a crowd are numbered group after group. Without a controller each plays what
// set_playback() says, two clips at most; with one, its layers (docs/controller.md). All are read by Crowd::create()
// and not kept.
struct CrowdGroup {
    const Character* character = nullptr;
    uint32_t instance_count = 0;
    const Controller* controller = nullptr;
    // Root motion, if the character has it, moves the placements; else it is only reported
    bool moves_placements = true;
    // Joints, at most 64, whose transforms are written in each update, for attachments
    std::vector<uint32_t> sockets{};
    SocketSpace socket_space = SocketSpace::kWorld;
    // Moves joints after the blend; such groups are updated stage by stage
    const ProceduralRules* procedural = nullptr;
    // Makes its instances agents. Root motion carries them, where it moves placements; else they are moved as fast as
    // they want
    std::optional<Steering> steering{};
    // Its instances stand on CrowdSettings::terrain, which they need: the update sets y of their placements. The CPU
    // does not see it: world_bounds() and Renderer's ground go by what set_placement() said
    bool on_terrain = false;
    // Instances that may have a pose of set_pose() at the same time; 48 bytes a joint each, 0: no cost at all
    uint32_t pose_capacity = 0;
};

// How an update goes from clips to skin matrices. kStaged: sample, blend, scan and bind one after another, each through
// memory; any character. kFused: all four in one kernel, intermediates in registers and shared memory, 4 to 7 times as
// fast on a software device; not for characters too large for that. kAuto: fused where it applies, staged else.
enum class UpdatePath { kAuto, kFused, kStaged };

// How a group is updated.
struct GroupPath {
    bool is_fused = false;  // in one pass; else stage by stage
    std::string reason{};   // why, in one line
    ScanAdvice scan{};      // the scan method in use, also where "auto" chose it, and why
};

// How OutputBlock::skin_buffer stores a skin matrix.
enum class SkinFormat {
    kAffine,  // 48 bytes: three rows of four floats
    // 24 bytes: three rows of four half floats; each within 2^-10 of its value or 2^-24, whichever is larger; beyond
    // 65,504 either that or infinite
    kHalfAffine,
    // 32 bytes: rotation (unit quaternion x, y, z, w), then translation and uniform scale; within 1e-5 of the
    // character's size. For characters whose scales and inverse binds are uniform
    kSimilarity,
};
// Bytes of one matrix.
uint32_t skin_format_bytes(SkinFormat format);

// How throng skins vertices: in Crowd::read_positions(), OutputBlock::skinned_buffer and Renderer. docs/skinning.md
// compares them.
enum class SkinBlend {
    kLinear,  // the weighted sum of the skin matrices: any character; joints that bend or twist far lose volume
    // Rotations and translations as dual quaternions, which keep it (L. Kavan et al., Geometric Skinning with
    // Approximate Dual Quaternion Blending, 2008), scales linearly. For characters whose scales and inverse binds are
    // uniform
    kDualQuaternion,
};

// What a camera sees: where CrowdSettings::culls, an update for a view animates only what that shows, and lists it for
// the draw.
struct CrowdView {
    // Rows; a world point is seen where -w <= x, y <= w and 0 <= z <= w
    std::array<std::array<float, 4>, 4> clip_from_world{};
    Vec3<float> eye{};  // world space
    // That a length of 1 takes at a distance of 1: the picture's height / (2 tan(half the vertical field of view))
    float pixels = 1000;
    // A coarser level of detail is drawn where its surfaces lie within so many pixels of the finest one's in the rest
    // pose and in clips (Lod::error), as long as they are in the middle of the picture, which stretches towards
    // its edges
    float lod_pixels = 1;
    // What is drawn throws its shadow as far as this, world space: so what is outside but throws one inside is drawn
    // too
    Vec3<float> shadow{};
    float ground = -1e30f;  // world y; nothing below it is seen, so a shadow that falls goes no farther
    // Where CrowdSettings::skips_updates: a character whose box is at least so many pixels across is animated in every
    // update, one of half as many in every second, of a quarter in every fourth, a smaller one in every eighth; 0: all
    // in every one.
    float full_rate_pixels = 0;  // at most 1e30
    // Where CrowdSettings::skips_updates: GPU time that the update of the whole crowd may take, in milliseconds; as
    // long as it takes longer, full_rate_pixels (at least 1) is raised from update to update, and lowered again, not
    // below itself, when there is time to spare. 0: as long as it takes. Needs timestamps.
    float budget_ms = 0;
    // What is hidden is left out too: record() animates and lists only what was visible in the last update, and
    // record_disoccluded() the rest of what is visible.
    bool occlusion = false;
};

// Depths of what the crowd's last record() has listed, and of anything else that hides characters, as they are drawn by
// CrowdView::clip_from_world: an image of one sample and one 32-bit float a texel (VK_FORMAT_D32_SFLOAT or
// VK_FORMAT_R32_SFLOAT), in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, with that usage. Of several samples it has the
// farthest.
struct DepthImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_DEPTH_BIT;
    uint32_t width = 0, height = 0;
    bool reversed = true;  // nearer is greater
};

// An instance that is drawn, and its level of detail: 0 is the finest.
struct DrawnInstance {
    uint32_t instance = 0, lod = 0;
};

struct CrowdSettings {
    std::vector<CrowdGroup> groups{};
    UpdatePath path = UpdatePath::kAuto;
    SkinFormat skin_format = SkinFormat::kAffine;
    // "auto", a name of scan_methods(), or a name with its invocations a character: "subgroup:8"
    std::string scan = "auto";
    bool keep_model_matrices = false;  // else they live only within a frame, and read_model_matrices() is an error
    // Skin matrices of the update before the last, for motion vectors; doubles their memory
    bool keep_previous_matrices = false;
    std::optional<Terrain> terrain{};  // that instances of groups with CrowdGroup::on_terrain stand on
    bool culls = false;                // updates may be for a view
    // Such updates may animate what is small on the screen less often than others, with culls; its skin matrices go on
    // evenly from one pose to the next (kept model matrices do not: they are those of the next). Doubles the memory of
    // skin matrices.
    bool skips_updates = false;
    // Coarser levels of detail have fewer joints (Character::joint_lods), with culls: their skin matrices are
    // written only for these, and only the influences of their level refer to no others. Kept model matrices likewise.
    // Not of groups with CrowdGroup::pose_capacity.
    bool reduces_joints = false;
    SkinBlend skin_blend = SkinBlend::kLinear;
    // Every vertex that is drawn is skinned once, in compute, into OutputBlock::skinned_buffer, for several passes
    // (shadow maps, depths, the picture) or others who read vertices; Renderer does so then. 16 bytes a vertex and
    // instance.
    bool skins_once = false;
    bool timestamps = true;           // measure the stages; costs one query a stage and one more
    uint32_t event_capacity = 16384;  // events of one update that feedback() can hold; the others are counted
    uint32_t watch_capacity = 64;     // instances that watch() takes
};

// A vertex in OutputBlock::skinned_buffer.
struct SkinnedVertex {
    Vec3<float> position{};
    uint32_t normal_octahedral = 0;  // of length 1, as Vertex's
};

// Results of consecutive instances of one group. Each buffer holds one entry after the other from offset 0, in the
// shape that stands beside it; VK_NULL_HANDLE where the crowd does not have it. Buffers fit the device's storage-buffer
// range. Valid once the recorded commands have run, until the next record() runs: written by compute shaders, and made
// visible by record() to later compute, vertex, indirect and transfer reads on the same queue.
//
// Where CrowdSettings::culls, instances that are not listed keep the matrices of the last update that drew them (with
// previous ones, which take turns, those of the last two); in an update that draws them anew, the previous matrices are
// those of that update.
struct OutputBlock {
    uint32_t group = 0;
    uint32_t first_instance = 0;  // of the crowd
    uint32_t instance_count = 0;
    uint32_t palette_count = 0;
    uint32_t joint_count = 0;

    // Skin matrices, [instance_count][palette_count] in CrowdSettings::skin_format, model space: skinned position =
    // matrix * bind position.
    VkBuffer skin_buffer = VK_NULL_HANDLE;
    // Those of the update before, with CrowdSettings::keep_previous_matrices; changes places with skin_buffer in every
    // record().
    VkBuffer previous_skin_buffer = VK_NULL_HANDLE;
    // model_from_joint, Affine[instance_count][joint_count], with CrowdSettings::keep_model_matrices.
    VkBuffer model_buffer = VK_NULL_HANDLE;
    // world_from_model, Affine[instance_count].
    VkBuffer placement_buffer = VK_NULL_HANDLE;

    uint32_t socket_count = 0;
    // Transforms of CrowdGroup::sockets, Affine[instance_count][socket_count] in CrowdGroup::socket_space.
    VkBuffer socket_buffer = VK_NULL_HANDLE;

    uint32_t parameter_count = 0;
    // Parameters of the controller, float[instance_count][parameter_count]. Between two updates the application's own
    // shaders or copies may write it.
    VkBuffer parameter_buffer = VK_NULL_HANDLE;
    // Root motion of a group with a controller, float4[instance_count][5], of which the first is the last update's move
    // over the ground: x, z, then cosine and sine of the turn about +y, in the character's space before it.
    VkBuffer root_buffer = VK_NULL_HANDLE;

    uint32_t target_count = 0;
    // Targets of procedural rules, float4[instance_count][target_count]: a place in world space, and its weight in w.
    // May be written like the parameters.
    VkBuffer target_buffer = VK_NULL_HANDLE;
    // Destinations of agents, float4[instance_count]: a place in world space, and in w whether the agent has one (1 or
    // 0). May be written like the parameters.
    VkBuffer destination_buffer = VK_NULL_HANDLE;

    // Morphs that each instance shows, {uint32_t morph; float weight;}[instance_count][kActiveMorphLimit], the largest
    // weight by magnitude first, weight 0 where there are fewer. Before skinning: bind position += weight * MorphDelta.
    VkBuffer morph_buffer = VK_NULL_HANDLE;

    // Instances that are drawn, uint32_t[5 + instance_count], with CrowdSettings::culls: their number, where those of
    // each of four levels of detail begin behind the fifth word, then their numbers in the block, level by level,
    // ascending.
    VkBuffer list_buffer = VK_NULL_HANDLE;
    // Draw calls, VkDrawIndexedIndirectCommand[section_count][4 levels of detail], with CrowdSettings::culls; the n-th
    // instance of a call is the n-th of its level in the list.
    VkBuffer draw_buffer = VK_NULL_HANDLE;

    uint32_t vertex_count = 0;
    // Morphed and skinned vertices, SkinnedVertex[instance_count][vertex_count], model space, in the order of
    // Character::vertices, with CrowdSettings::skins_once; where the crowd culls, only those that the listed instances
    // have in their level of detail.
    VkBuffer skinned_buffer = VK_NULL_HANDLE;
};

// The stages of an update in their order, as they are timed. "fused" is sample, blend, scan and bind of the groups that
// are updated in one pass. "update_rate" takes the matrices of what is not animated in this update towards their next
// pose. "terrain" is that of CrowdSettings::terrain, and "skin" that of CrowdSettings::skins_once. "blend" has the
// weights of morphs too.
inline constexpr std::array<const char*, 12> kStageNames{"control", "steer", "terrain",     "cull",
                                                         "sample",  "blend", "procedural",  "scan",
                                                         "bind",    "fused", "update_rate", "skin"};

// The index of a stage's name in kStageNames, or kStageNames.size() where no stage is called so.
constexpr size_t index_of_stage(std::string_view name) {
    size_t i = 0;
    while (i < kStageNames.size() && name != kStageNames[i]) ++i;
    return i;
}

// GPU time of each stage in the last finished update, summed over its dispatches, milliseconds.
struct StageTimes {
    std::array<double, kStageNames.size()> ms{};  // 0 where the crowd does not have the stage

    // The time of the stage called `name`; 0 where none is called so.
    constexpr double of(std::string_view name) const {
        const size_t i = index_of_stage(name);
        return i < ms.size() ? ms[i] : 0;
    }
    constexpr double total() const {
        double sum = 0;
        for (const double one : ms) sum += one;
        return sum;
    }
};

// An event of a controller's clip that an instance passed.
struct CharacterEvent {
    uint32_t instance = 0;
    uint32_t event = 0;  // index into Controller::events
    uint32_t layer = 0;
    float time_s = 0;  // after the beginning of the update's time step
};

// What a layer plays: a state, or of a layer without states a clip.
struct PlayedMotion {
    uint32_t motion = kNone;  // index of ControllerLayer::states, or of Character::clips; kNone: the rest pose
    float phase = 0;          // of its cycle, 0..1
    uint32_t loops = 0;       // whole cycles since it was entered
    // How far it has replaced the one behind it, 0..1, linear in time (docs/controller.md, step 5)
    float fade = 1;

    bool operator==(const PlayedMotion&) const = default;
};

// A watched instance as it is after an update.
struct WatchedInstance {
    uint32_t instance = 0;
    Affine world_from_model{};  // with all root motion so far, where it moves placements
    // Root motion of this update, in the character's space before it; the identity where there is none
    Affine move{};
    std::vector<Affine> sockets{};    // [socket_count] of its group, in its CrowdGroup::socket_space
    std::vector<float> parameters{};  // [parameter_count] of its controller
    // [layer_count] of its controller; of each, newest first, what it cross-fades: the first leads
    std::vector<std::vector<PlayedMotion>> layers{};
};

// What came back from one update.
struct Feedback {
    uint64_t update = 0;                     // counted from 1
    std::vector<CharacterEvent> events{};    // by instance, then layer, then time
    uint64_t lost_event_count = 0;           // that found no room
    std::vector<WatchedInstance> watched{};  // of watch(), in its order
};

struct CrowdState;  // internal

// Not thread-safe: one thread at a time per crowd. Different crowds are independent but for their device's queue.
class Crowd {
public:
    // Errors: kInvalidArgument (unknown scan, no instances), kUnsupported (the scan method,
    // the fused path, the skin format or the skin blend does not apply to a character), what controllers, sockets and
    // procedural rules have wrong, kLimit (names what exceeds which limit of the device), kOutOfMemory.
    static Result<Crowd> create(const Device& device, const CrowdSettings& settings);
    Crowd(Crowd&&) noexcept;
    Crowd& operator=(Crowd&&) noexcept;
    ~Crowd();

    uint32_t instance_count() const;
    // Errors: kInvalidArgument (no such group).
    Result<GroupPath> path(uint32_t group) const;

    // Change what instances play, or where they stand (world_from_model); taken up by the next record(). New instances
    // play the rest pose and stand at the origin. Only changed instances are uploaded: 36 bytes each for a playback, 48
    // for a placement (80 with root motion). Errors: kInvalidArgument (instance or clip out of range, value not finite,
    // weight outside 0..1, set_playback() where there is a controller).
    Result<void> set_playback(uint32_t first_instance, std::span<const Playback> playback);
    Result<void> set_placement(uint32_t first_instance, std::span<const Affine> world_from_model);

    // For an instance whose group has a controller; taken up by the next record(), in the order of the calls. 32 bytes
    // are uploaded for each, and applied on the GPU. set_parameters() sets one parameter after the other, from
    // `parameter` on.
    // Errors: kInvalidArgument (no controller, layer with states, or without inertial plays, clip, mask or parameter
    // out of range, value not finite, negative fade, weight outside 0..1).
    Result<void> play(uint32_t instance, uint32_t layer, const LayerPlayback& playback);
    Result<void> set_layer(uint32_t instance, uint32_t layer, const LayerBlend& blend);
    Result<void> set_parameters(uint32_t instance, uint32_t parameter, std::span<const float> values);

    // Input of the procedural rules, from the next record() on. Until it is set a target has weight 0, and does
    // nothing. Errors: kInvalidArgument (no such instance or target, value not finite, weight outside 0..1; wind:
    // velocity beyond 1e6, gust outside 0..1, wavelength below 1e-6).
    Result<void> set_target(uint32_t instance, uint32_t target, const Vec3<float>& world_place, float weight);
    Result<void> set_wind(const Wind& wind);
    // Where agents (CrowdGroup::steering) walk from the next record() on, each to one of the places, whose height does
    // not matter; an agent stands where it is as long as it has no destination, and others keep away from it. It
    // arrives within its radius; then it stands, and goes back when it has been pushed away by twice that.
    // 16 bytes are uploaded for each. Errors: kInvalidArgument (instance out of range, its group has no steering, place
    // not finite).
    Result<void> set_destination(uint32_t first_instance, std::span<const Vec3<float>> world_places);
    Result<void> clear_destination(uint32_t first_instance, uint32_t count);
    // A pose from outside (a ragdoll, a cut scene), parent_from_joint[joint_count], in place of the animated one, which
    // goes on below it (procedural rules move it too); taken up by the next record(). If the instance had none, it
    // fades in within `fade_s` seconds, 0: at once; it counts as having one until it is cleared, so a call in each
    // frame replaces the pose and lets the fade go on. clear_pose() fades out; the room for the pose is free again when
    // that is done. A pose set meanwhile fades in from where it is. Translations and scales are blended linearly,
    // rotations on the shortest path, by a weight eased as those of docs/controller.md, step 5. Rotations are
    // normalised. Only the poses set are uploaded, 48 bytes a joint, and 8 for each instance that fades. Errors:
    // kInvalidArgument (instance out of range, another number of joints, a number that is not finite, a rotation of
    // length 0, a negative fade; where Rig::uniform_scale is set, a scale that differs along the axes by more than 1e-5
    // of itself), kLimit (as many poses as CrowdGroup::pose_capacity are there).
    Result<void> set_pose(uint32_t instance, std::span<const Trs<float>> parent_from_joint, float fade_s = 0);
    Result<void> clear_pose(uint32_t instance, float fade_s = 0);

    // From the next record() on, placement, move, sockets, and what their controllers do, of these instances come back
    // with the feedback. Replaces the ones before. Errors: kInvalidArgument (instance out of range, or no group has a
    // controller, sockets or steering), kLimit (more than CrowdSettings::watch_capacity).
    Result<void> watch(std::span<const uint32_t> instances);

    // What the updates that have finished since the last call reported, oldest first; does not wait. An update's
    // feedback is kept until the fourth record() after it: with fewer than four updates in flight, one call between two
    // record()s misses nothing. Empty where no group has a controller, sockets or steering.
    Result<std::vector<Feedback>> feedback();

    // Records one update into the caller's command buffer (recording, outside a render pass, of the adopted queue's
    // family): advances every instance by `time_step_s` times its speed, then control, and sample, blend, scan, bind or
    // all four in one. A playback set since the last record() starts at its time plus this step. The recorded commands
    // must have finished before the crowd is destroyed, and may be submitted once.
    //
    // With a view, where CrowdSettings::culls: all instances go on in time, and of groups that are fused, without
    // sockets or inertial transitions, only those that it sees are animated (others' groups entirely). Without one, all
    // are, and all are listed. A box around all clips' poses decides, a tenth of the character's size wider than these,
    // or half of it where a controller, rules or poses from outside go beyond them. Errors: kInvalidArgument (the time
    // step or the view is not finite; a view and no culls).
    Result<void> record(VkCommandBuffer commands, float time_step_s, const CrowdView* view = nullptr);
    // The second half of an update for a view with CrowdView::occlusion, recorded after its record() and what draws the
    // depths: tests the boxes of everything in view against these, and animates those that are visible and were not in
    // the last update. After it, all that are visible, and those that were, are listed. What a box hides behind is what
    // has been drawn in front of it, so nothing visible is left out. Call it in each such update. Errors:
    // kInvalidArgument (the last record() was not for such a view, no image), kLimit (the device cannot hold the depths
    // in one storage buffer).
    Result<void> record_disoccluded(VkCommandBuffer commands, const DepthImage& depths);
    // Says that the commands of the last record(), and of its record_disoccluded(), will never be submitted: of a
    // minimised window, or a swapchain that is out of date. The crowd is as if they had not been recorded: time has not
    // gone on, and what was set before is taken up by the next record(), together with what has been set since.
    // outputs() change back too. (A pose whose fade ended in that update is not back where CrowdGroup::pose_capacity
    // was exhausted and its room has been given to another.) Of a dropped update that nobody tells of, the changes are
    // lost, and after four in a row record() fails where there is feedback(). Errors: kInvalidArgument (nothing has
    // been recorded since the last discard).
    Result<void> discard_last_record();
    // record(), submit to the device's queue, and wait.
    Result<void> update(float time_step_s, const CrowdView* view = nullptr);

    std::span<const OutputBlock> outputs() const;
    // Times of the newest of the last four updates that has finished. Errors: kInvalidArgument where timestamps are off
    // or nothing has run yet.
    Result<StageTimes> stage_times() const;

    // Copies of one instance's results; they submit and wait. Shapes: [palette_count], [joint_count], [vertex_count].
    Result<std::vector<Affine>> read_skin_matrices(uint32_t instance);
    Result<std::vector<Affine>> read_model_matrices(uint32_t instance);
    // Morphed and skinned on the GPU, model space, in the order of Character::vertices; where
    // CrowdSettings::reduces_joints, of instances that the last update has listed.
    Result<std::vector<Vec3<float>>> read_positions(uint32_t instance);

    // What the last update has listed, in the order of the lists. Errors: kInvalidArgument where not
    // CrowdSettings::culls.
    Result<std::vector<DrawnInstance>> read_drawn();

    // Device memory that the crowd holds.
    uint64_t size_bytes() const;

    // Internal.
    explicit Crowd(std::unique_ptr<CrowdState> state);
    CrowdState& state() const;  // throws where the crowd has been moved from

private:
    std::unique_ptr<CrowdState> state_;
};

}  // namespace throng
