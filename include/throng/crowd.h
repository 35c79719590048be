// A crowd: instances of compiled characters, each animated on its own, on the GPU, every frame.
#pragma once

#include <throng/attachment.h>
#include <throng/character.h>
#include <throng/commands.h>
#include <throng/controller.h>
#include <throng/device.h>
#include <throng/feedback.h>
#include <throng/group_mesh.h>
#include <throng/look.h>
#include <throng/outputs.h>
#include <throng/playback.h>
#include <throng/population.h>
#include <throng/procedural.h>
#include <throng/scan.h>
#include <throng/skin_format.h>
#include <throng/stage_times.h>
#include <throng/steering.h>
#include <throng/view.h>

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace throng {

// What the outputs of sockets hold: model_from_joint, or world_from_joint (with the instance's placement applied).
enum class SocketSpace { kModel, kWorld };

// Keeps skin matrices only for instances that are drawn, not for all, so that their memory depends on what is seen. A
// drawn instance has its own row of the pool, unless it is so far away that nobody sees the difference
// (CrowdView::shared_pose_pixels): then it is not animated, and shows the nearest of the poses that its group has of
// each clip, which are made with the crowd. With a controller, that happens only while a clip plays alone. If there are
// more instances to animate than rows, the rest show such a pose too, of the clip that has most weight (with a
// controller, the first clip of its lowest layer): instances with coarser sets of joints first and, within one set,
// those with the highest numbers. Large groups are several OutputBlocks; each has such a pool, of at most 256 MiB.
struct SkinPool {
    uint32_t capacity = 0;          // rows for instances of an OutputBlock; above 0
    float shared_poses_per_s = 30;  // of each clip; above 0, at most 1000
};

// Instances of one character. Instances of a crowd are numbered group after group. Without a controller each plays what
// set_playback() says, two clips at most; with one, the controller's layers (docs/controller.md). Crowd::create() reads
// what the pointers refer to and keeps no reference.
struct CrowdGroup {
    const Character* character = nullptr;
    uint32_t instance_count = 0;  // how many there are when the crowd is made
    const Controller* controller = nullptr;
    // True: root motion, if the character has it, moves the placements; false: it is only reported
    bool moves_placements = true;
    // Joints, at most 64, whose transforms are written in each update, for attachments
    std::vector<uint32_t> sockets{};
    SocketSpace socket_space = SocketSpace::kWorld;
    // Its instances can hang on sockets of others (Crowd::attach()). Such a group does not move by itself (steering,
    // terrain, root motion)
    bool is_carried = false;
    // Computes nothing but the sockets and the joints that they depend on: for servers, which ask where hit boxes are
    // and draw nothing. Only works where the group is updated natively in one pass; there are no skin or model
    // matrices.
    bool sockets_only = false;
    // Moves joints after the blend; such groups are updated stage by stage
    const ProceduralRules* procedural = nullptr;
    // Makes its instances agents. Root motion carries them if it moves placements; otherwise the update moves them as
    // fast as they want to walk
    std::optional<Steering> steering{};
    // Its instances stand on CrowdSettings::terrain, which must be set: the update sets y of their placements
    bool on_terrain = false;
    // How many instances can have a pose from set_pose() at the same time; 48 bytes a joint each. 0: no cost at all
    uint32_t pose_capacity = 0;
    // How far its poses can reach beyond the boxes of all clips, as a part of the character's size, at most 1000;
    // culling enlarges the boxes by it. Unset: a tenth, since blends go a little beyond, or half with a controller,
    // rules, pose_capacity or a CrowdSettings::skin_blend other than kLinear. A ragdoll that falls off a roof, while
    // its placement stays there, needs more.
    std::optional<float> pose_margin{};
    // Needs CrowdSettings::culling, a group that is updated in one pass and has a mesh, and a native engine
    // (docs/native.md), which makes the shared poses. Not together with sockets, inertial transitions or pose_capacity,
    // nor with the crowd's keep_model_matrices, keep_previous_matrices, Culling::skips_updates or skins_once: all of
    // these keep something of instances that are not drawn.
    std::optional<SkinPool> skin_pool{};
    // Above 0: instances come and go, by Crowd::spawn() and despawn(), and there is room for this many at a time; at
    // least instance_count. Such a crowd culls even if CrowdSettings::culling is not set: only instances that are there
    // get into its lists, and nothing else is updated or drawn. Free room takes memory, and next to no time. Not
    // together with CrowdSettings::keep_previous_matrices if the group is animated entirely (see record()).
    uint32_t capacity = 0;
    // Above 0: the application's shaders can write commands for instances (throng/commands.h), at most this many for
    // each update and OutputBlock; at most 1048576. An update obeys them after it has applied what the CPU's calls have
    // set. 64 bytes a command, and 12 bytes or more an instance. Not together with is_carried.
    uint32_t command_capacity = 0;
    // Only such commands spawn and despawn, not the CPU's calls: shaders number the instances as they like, below
    // `capacity`. Needs capacity and command_capacity above 0. No instance is there when the crowd is made, and calls
    // that name one are errors, except those that read; events name instances with generation 0. Not together with
    // pose_capacity.
    bool shaders_populate = false;
    // How many morphs an instance shows at most: those with the largest weights by magnitude, of equal ones the
    // earlier. 0: all that have weight. 8 bytes each for every instance
    uint32_t morph_limit = 0;
    // Ways in which its instances can look, chosen by set_look(), which is an error for groups without outfits
    std::vector<Outfit> outfits{};
};

// How an update gets from clips to skin matrices. On a native device all of these are native.
enum class UpdatePath {
    kAuto,   // natively on software devices where that applies, unless CrowdSettings::scan asks for a method; otherwise
             // as kDevice
    kFused,  // sample, blend, scan and bind in one kernel, with what lies between them in registers and shared memory;
             // 4 to 5 times as fast as kStaged on a software device. Not for characters too large for that
    kStaged,  // sample, blend, scan and bind one after another, through memory; for any character
    kNative,  // by this machine's processor, in one pass where that applies: Crowd::update() and
              // Renderer::render_frame(), after waiting for the device's queue. Updates that are recorded into a
              // command buffer, or are for a view with occlusion, still run on the device. kUnsupported on a GPU, and
              // on a software device where CrowdSettings::scan asks for a method
    kDevice,  // on the device: fused where that applies, otherwise staged
};

// How a group is updated.
struct GroupPath {
    bool is_fused = false;   // in one pass; else stage by stage
    bool is_native = false;  // by this machine's processor, in the cases that UpdatePath::kNative names
    std::string reason{};    // why, in one line
    ScanAdvice scan{};       // the scan method in use, also where "auto" chose it, and why
};

// How UpdatePath::kAuto would update a group of this many instances of the character. Errors: kInvalidArgument (no
// joints).
Result<GroupPath> advise_path(const Device& device, const Character& character, uint32_t instance_count);

// Updates can be for a view (CrowdView): then they animate only the instances that it sees, and give those that are
// small on the screen a coarser level of detail. In groups with sockets or inertial transitions, and in those that are
// not updated in one pass (GroupPath::reason says so), all instances are animated, with all joints, in each update.
struct Culling {
    // Animates what is small on the screen only in some updates (CrowdView::full_rate_pixels). In between, its skin
    // matrices move evenly towards the next pose; kept model matrices are those of that next pose. Doubles the memory
    // of skin matrices. Worth it where computing is slow: a step in between moves three times the memory of an update,
    // and an H200 takes less time to compute the pose anew.
    bool skips_updates = false;
    // Coarser levels of detail have fewer joints (Character::joint_lods): skin matrices and kept model matrices are
    // written only for these, so such an instance must be drawn with the influences of its level, which refer to no
    // others. Does not apply to groups with CrowdGroup::pose_capacity either.
    bool reduces_joints = false;
};

struct CrowdSettings {
    std::vector<CrowdGroup> groups{};
    UpdatePath path = UpdatePath::kAuto;
    SkinFormat skin_format = SkinFormat::kAffine;
    // "auto", a name of scan_methods(), or a name with its invocations a character: "subgroup:8"
    std::string scan = "auto";
    bool keep_model_matrices = false;  // else they live only within a frame, and read_model_matrices() is an error
    // OutputBlock::previous_skin, for motion vectors; takes the memory of skin matrices once more. Not together with
    // CrowdGroup::capacity in groups that are animated entirely (see record()): there, set frames_in_flight to one more
    // than is needed otherwise, and read `skin` of the slot before.
    bool keep_previous_matrices = false;
    // How many updates have their outputs side by side, 1 to 4, so that one can be computed while those before it are
    // drawn: on the same queue, or on one for asynchronous compute (AdoptedDevice::more_queue_families). Each takes the
    // memory of skin matrices, skinned vertices, placements, sockets, lists and whatever else OutputBlock offers. When
    // the commands of a record() run, whatever reads the outputs of the update that many before must have finished, by
    // a fence or a semaphore.
    uint32_t frames_in_flight = 1;
    std::optional<Terrain> terrain{};  // what instances of groups with CrowdGroup::on_terrain stand on
    std::optional<Culling> culling{};  // unset: every update animates all instances
    SkinBlend skin_blend = SkinBlend::kLinear;
    // Every vertex that is drawn is skinned once, in compute, into OutputBlock::skinned, for several passes (shadow
    // maps, depths, the picture) and other readers of vertices; Renderer then reads it too. 16 bytes a vertex and
    // instance.
    bool skins_once = false;
    bool timestamps = true;  // measure the stages; costs one query a stage and one more
    // How many events of one update feedback() can hold; others are only counted. 16 bytes each, five times over
    uint32_t event_capacity = 16384;
    uint32_t watch_capacity = 64;  // instances that watch() takes
    // How many poses request_poses() can ask of one update; takes the memory of their skin matrices four times
    uint32_t pose_request_capacity = 0;
};

struct CrowdState;  // internal

// Not thread-safe: one thread at a time per crowd. Different crowds are independent except for their device's queue.
class Crowd {
public:
    // Submits nothing and waits for nothing, so that a thread can make a crowd while others record and submit. The
    // initial contents of its buffers stay in host memory until the first update, or record_uploads(), brings them to
    // the device; tables of a character that another crowd of the device uses by then are shared with it. Errors:
    // kInvalidArgument (unknown scan, no instances, a character that has been changed and is not as character.h says),
    // kUnsupported (the scan method, the fused path, the skin format, the skin blend or the skin pool does not apply to
    // a character), either of them for a controller, sockets or procedural rules that do not fit, kLimit (names what
    // exceeds which limit of the device), kOutOfMemory.
    static Result<Crowd> create(const Device& device, const CrowdSettings& settings);
    // No crowd yet, for example a member that is filled in later. Call nothing on it until another crowd is assigned to
    // it.
    Crowd() noexcept;
    Crowd(Crowd&&) noexcept;
    Crowd& operator=(Crowd&&) noexcept;
    ~Crowd();

    // All instance numbers are below this. Groups with CrowdGroup::capacity count as if they were full.
    uint32_t instance_count() const;
    // The numbers of its groups, ascending: those of CrowdSettings::groups, and what add_groups() has returned, without
    // those that have been removed.
    std::vector<uint32_t> groups() const;
    // The group that an instance belongs to, or did until it went: an event's, for example. Errors: kInvalidArgument
    // (no group has such a number).
    Result<uint32_t> group_of(const InstanceHandle& instance) const;
    // Errors: kInvalidArgument (no such group).
    Result<GroupPath> path(uint32_t group) const;

    // Takes in the groups of another crowd of the same device that has not been updated yet: for a character that a
    // game streams in, or for more instances of one. A thread makes that crowd while this one goes on (create(),
    // record_uploads()), and sets how its instances begin; then they belong to this crowd, steer around its agents and
    // can hang on its sockets, and `other` is no crowd any more. Returns the numbers that its groups have here, in
    // their order: the lowest that are free. Instances get the lowest numbers at which enough are free in a row, and
    // new handles (instances(group), handle()); the other crowd's watched instances, wind and terrain are left behind.
    // What stages share is made anew, in about a millisecond, and what updates under way still use is freed some ten
    // updates later. Nothing waits or is submitted. outputs() change because of the new groups, and spans that it has
    // returned become invalid. Both crowds need the same CrowdSettings, except for groups, path, scan, terrain,
    // timestamps and capacities of feedback (but pose_request_capacity is above 0 in both or neither); if a group has
    // CrowdGroup::capacity, which makes its crowd cull, the other crowd needs CrowdSettings::culling. After an error
    // nothing has changed, except that the groups of the other crowd may not be updated natively any more. Errors:
    // kInvalidArgument (other settings, device; it has been updated; a group with on_terrain for a crowd without
    // terrain; the second half of an update for a view with occlusion is still to come), kUnsupported (on a software
    // device, if one crowd is updated natively and the other cannot be), kLimit, kOutOfMemory.
    Result<std::vector<uint32_t>> add_groups(Crowd&& other);
    // Takes a group away with all of its instances; what hangs on them stays where it is. The other groups and their
    // instances keep their numbers. Its memory is freed some ten updates later (record() with a time step of 0 counts).
    // Errors: kInvalidArgument (no such group, the only one with instances, or as above).
    Result<void> remove_group(uint32_t group);

    // Adds instances to a group with CrowdGroup::capacity, one for each placement, or removes some; this takes effect
    // with the next record(). New ones get the lowest numbers that are free, and are as they would be in a new crowd:
    // they play the rest pose, or their controller begins; they have no pose from set_pose(), target, destination or
    // speed, and are not watched. Calls that name an instance that is not there are errors. 4 bytes are uploaded for
    // each that comes or goes, its placement, and 36 for what it plays. After an error nothing has happened. Errors:
    // kInvalidArgument (no such group, or without capacity; placement not finite; handle of one that has gone, or given
    // twice), kLimit (more than there is room for).
    Result<std::vector<InstanceHandle>> spawn(uint32_t group, std::span<const Affine> world_from_model);
    Result<void> despawn(std::span<const InstanceHandle> instances);
    // The same for one instance. Templates, so that spawn(group, {a, b}) still means the calls above.
    template <std::same_as<Affine> One>
    Result<InstanceHandle> spawn(uint32_t group, const One& world_from_model) {
        const Result<std::vector<InstanceHandle>> spawned = spawn(group, std::span<const Affine>(&world_from_model, 1));
        if (!spawned) return spawned.error();
        return spawned->front();
    }
    template <std::same_as<InstanceHandle> One>
    Result<void> despawn(const One& instance) {
        return despawn(std::span<const InstanceHandle>(&instance, 1));
    }
    bool is_alive(const InstanceHandle& instance) const;
    // The handle of the instance that has this number now. Errors: kInvalidArgument (there is none).
    Result<InstanceHandle> handle(uint32_t instance) const;
    // How many instances of a group are there. Errors: kInvalidArgument (no such group, or one with
    // CrowdGroup::shaders_populate).
    Result<uint32_t> alive_count(uint32_t group) const;

    // All instance numbers, in use or not; and those of one group. In groups without CrowdGroup::capacity all are
    // there; elsewhere calls that are given all numbers are errors while some are free. Errors: kInvalidArgument (no
    // such group).
    Instances instances() const;
    Result<Instances> instances(uint32_t group) const;

    // The calls below take effect with the next record(), in the order in which they are made. Each sets one value for
    // all of the instances, or one for each. After an error nothing has been set. Errors of all: kInvalidArgument (an
    // instance is not there, or the number of values does not match).

    // What instances play, and where they stand. New instances play the rest pose and stand at the origin. A playback
    // replaces the one before at once, and its clips begin at their time_s: for fades from clip to clip see play(). The
    // placement of an instance that hangs on another one is not used. Only changed instances are uploaded: 36 bytes
    // each for a playback, 48 for a placement (128 with root motion, 136 where it moves placements). Errors:
    // kInvalidArgument (clip out of range, value not finite, weight outside 0..1, set_playback() for a group with a
    // controller).
    Result<void> set_playback(const Instances& instances, const Playback& playback);
    Result<void> set_playback(const Instances& instances, std::span<const Playback> playback);
    Result<void> set_placement(const Instances& instances, const Affine& world_from_model);
    Result<void> set_placement(const Instances& instances, std::span<const Affine> world_from_model);

    // How instances look, in Renderer's pictures and for the application's own shaders; an instance's size comes from
    // its placement. 16 bytes are uploaded for each. Errors: kInvalidArgument (no such outfit, tint out of range).
    Result<void> set_look(const Instances& instances, const InstanceLook& look);
    Result<void> set_look(const Instances& instances, std::span<const InstanceLook> look);

    // Hangs instances on sockets of others, or lets them go; then they stay where they are until they are placed. Each
    // update places what hangs on a carrier after everything that moves the carrier, so that both fit together in every
    // picture; culling uses where it was in the update before. When a carrier is despawned, what hangs on it stays
    // where it is. 64 bytes are uploaded for each. Carriers can hang on others in turn, in chains of up to 64: each
    // level takes a dispatch, and attaching to such a carrier takes time in proportion to all attachments. Errors:
    // kInvalidArgument (a group without CrowdGroup::is_carried, no such carrier or socket, sockets in model space,
    // number not finite, it would hang on itself or in a longer chain).
    Result<void> attach(const Instances& instances, const Attachment& attachment);
    Result<void> attach(const Instances& instances, std::span<const Attachment> attachment);
    Result<void> detach(const Instances& instances);

    // For instances whose groups have controllers; direct_layers() makes a controller for games that play clips only by
    // these calls. 32 bytes are uploaded for each, and applied on the GPU. Parameters and layers are numbered as in the
    // Controller. Errors: kInvalidArgument (no controller, layer with states, or without inertial plays, clip, mask or
    // parameter out of range, value not finite, negative fade, weight outside 0..1; set_state(): layer without states,
    // no such state, phase outside 0..1).
    Result<void> play(const Instances& instances, uint32_t layer, const LayerPlayback& playback);
    Result<void> play(const Instances& instances, uint32_t layer, std::span<const LayerPlayback> playback);
    // Puts a layer with states into one of them, whatever its transitions: what another machine, a saved game or a
    // script knows, or the first motion of the layer in WatchedInstance::layers. The state replaces within `fade_s`
    // what is shown (0: at once, but an inertial transition under way dies away as before; PlayedMotion::fade is not
    // used), and transitions go on from it in the same update (while it fades in, only those that may interrupt). A
    // state that plays backwards begins at phase 1. Plays of its sync group that it replaces go on in step with it,
    // from its phase.
    Result<void> set_state(const Instances& instances, uint32_t layer, const PlayedMotion& motion, float fade_s = 0);
    Result<void> set_state(const Instances& instances, uint32_t layer, std::span<const PlayedMotion> motion,
                           float fade_s = 0);
    Result<void> set_layer(const Instances& instances, uint32_t layer, const LayerBlend& blend);
    Result<void> set_layer(const Instances& instances, uint32_t layer, std::span<const LayerBlend> blend);
    Result<void> set_parameter(const Instances& instances, uint32_t parameter, float value);
    Result<void> set_parameter(const Instances& instances, uint32_t parameter, std::span<const float> value);

    // Input of the procedural rules. Until it is set a target has weight 0, and does nothing. Errors: kInvalidArgument
    // (no such target, place not within +-1e15, weight outside 0..1; wind: velocity beyond 1e6, gust outside 0..1,
    // wavelength below 1e-6).
    Result<void> set_target(const Instances& instances, uint32_t target, const TargetPlace& place);
    Result<void> set_target(const Instances& instances, uint32_t target, std::span<const TargetPlace> place);
    Result<void> set_wind(const Wind& wind);

    // Where agents (CrowdGroup::steering) walk; the height does not matter. An agent stands where it is as long as it
    // has no destination, and others keep away from it. It arrives within its radius; then it stands, and goes back
    // when it has been pushed away by twice that. 16 bytes are uploaded for each. Errors: kInvalidArgument (a group has
    // no steering, place not finite).
    Result<void> set_destination(const Instances& instances, const Vec3<float>& world_place);
    Result<void> set_destination(const Instances& instances, std::span<const Vec3<float>> world_place);
    Result<void> clear_destination(const Instances& instances);

    // A pose from outside (a ragdoll, a cut scene) in place of the animated one, which goes on underneath; procedural
    // rules move such a pose too. parent_from_joint[joint_count] for all of the instances, or one pose for each, one
    // after another. If an instance had none, it fades in within `fade_s` seconds, 0: at once; it counts as having one
    // until it is cleared, so a call in each frame replaces the pose and lets the fade go on. clear_pose() fades out;
    // the room for the pose is free again when that is done. A pose set meanwhile fades in from where it is.
    // Translations and scales are blended linearly, rotations on the shortest path, by a weight that is eased as in
    // docs/controller.md, step 5. Rotations are normalised. Only the poses set are uploaded, 48 bytes a joint, and 8
    // for each instance that fades. Errors: kInvalidArgument (another number of joints, a number that is not finite, a
    // rotation of length 0, a negative fade; where Rig::uniform_scale is set, a scale that differs along the axes by
    // more than 1e-5 of itself), kLimit (CrowdGroup::pose_capacity poses are there already).
    Result<void> set_pose(const Instances& instances, std::span<const Trs<float>> parent_from_joint, float fade_s = 0);
    Result<void> clear_pose(const Instances& instances, float fade_s = 0);

    // From now on the feedback reports placement, move, sockets and what the controller does for each of these
    // instances. Replaces the instances watched before. Errors: kInvalidArgument (no group has a controller, sockets or
    // steering), kLimit (more than CrowdSettings::watch_capacity).
    Result<void> watch(const Instances& instances);

    // The poses that these instances show after the next record(), and only then, come back with its feedback: for
    // ragdolls, which begin where the animation ends. They are taken from the skin matrices, so they are as exact as
    // SkinFormat; joints that are in no skin have their rest pose. For an instance that the update does not animate
    // because its view does not see it, it is the pose in which it was last seen. feedback() then takes the CPU some
    // 0.07 us a joint. Where they stand is told by watch() in the same update. What procedural rules have bent is in
    // the pose, and a pose that set_pose() gives back is bent by them again. Errors: kInvalidArgument (a group without
    // CrowdGroup::pose_capacity, or of CrowdGroup::sockets_only), kLimit (more than
    // CrowdSettings::pose_request_capacity).
    Result<void> request_poses(const Instances& instances);

    // What the updates that have finished since the last call reported, oldest first; does not wait. An update's
    // feedback is kept until the fourth record() after it: call this between any two record()s, with fewer than four
    // updates in flight, to miss nothing. Empty if no group has a controller, sockets or steering, and no pose can be
    // requested.
    Result<std::vector<Feedback>> feedback();

    // Records the upload of what the crowd's buffers begin with, so that the first update need not: into commands for
    // any queue that can copy, of the adopted queue's family or of AdoptedDevice::more_queue_families. Submit them so
    // that they have run, or are waited for by a semaphore, before the commands of the first record() run. If their
    // queue is not the adopted one, they must also have run before the crowd is saved, restored, read or drawn, and in
    // any case have been submitted by then. If they will never be submitted, call it again, or discard the first
    // record() that follows. Does nothing once record() has been called, and on a native device. Errors:
    // kInvalidArgument (no command buffer).
    Result<void> record_uploads(VkCommandBuffer commands);

    // Records one update into the caller's command buffer (recording, outside a render pass, of the adopted queue's
    // family, or of another one of AdoptedDevice::more_queue_families that computes): advances every instance by
    // `time_step_s` times its speed, then runs control, and sample, blend, scan and bind or all four in one. A playback
    // set since the last record() starts at its time plus this step. With a negative step clips, states, root motion
    // and wind go back, while fades and springs wait; with one of 0 or below agents stand, but transitions are taken
    // and triggers used up as ever. The recorded commands must have finished before the crowd is destroyed, and may be
    // submitted once. Commands must run in the order in which they were recorded, and update(), read_...() and
    // save_state() submit some of their own, so submit what has been recorded before you call these. What was bound for
    // compute (pipeline, descriptor sets, push constants) is no longer bound afterwards. On a native device the command
    // buffer is VK_NULL_HANDLE, and the update is done when the call returns, as by update().
    //
    // With a view, which needs CrowdSettings::culling, time advances for all instances, but in groups that are fused
    // and have no sockets or inertial transitions only those that the view sees are animated (other groups are animated
    // entirely). Without a view all are animated, and all are listed. What the view sees is decided by a box around all
    // clips' poses, enlarged by CrowdGroup::pose_margin. Errors: kInvalidArgument (the time step or the view is not
    // finite; a view and no culling), kUnsupported (CrowdView::occlusion on a native device; on a software device
    // CrowdGroup::sockets_only, and, with inertial transitions, after a native update()). After these nothing has
    // changed. After another one (kOutOfMemory, kLimit) half of an update may have been recorded, which cannot be
    // discarded: then restore a saved state before the crowd goes on; after kDeviceLost, into a new crowd on a new
    // device.
    Result<void> record(VkCommandBuffer commands, float time_step_s, const CrowdView* view = nullptr);
    // The second half of an update for a view with CrowdView::occlusion, recorded after its record() and the commands
    // that draw the depths: tests the boxes of everything in view against these, and animates those that are visible
    // and were not in the last update. After it, the lists hold all that are visible and those that were visible in the
    // last update. A box counts as hidden only behind what has been drawn in front of it, so nothing visible is left
    // out. Call it in each such update. Errors: kInvalidArgument (the last record() was not for such a view, no image),
    // kLimit (the device cannot hold the depths in one storage buffer), kUnsupported (a native device).
    Result<void> record_disoccluded(VkCommandBuffer commands, const DepthImage& depths);
    // Says that the commands of the last record(), and of its record_disoccluded(), will never be submitted, for
    // example because a window was minimised or a swapchain is out of date. The crowd is then as if they had not been
    // recorded: time has not advanced, and the next record() takes up what was set before, together with what has been
    // set since. outputs() change back too. Not after groups have been added or removed since. (A pose whose fade ended
    // in that update does not come back if CrowdGroup::pose_capacity was exhausted and its room has been given to
    // another.) If an update is dropped without this call, its changes are lost, and after four in a row record() fails
    // if there is feedback(). If the first update is dropped so, the initial contents of the buffers are lost as well.
    // Errors: kInvalidArgument (nothing has been recorded since the last discard or update(), its commands have run, or
    // the last record() failed).
    Result<void> discard_last_record();
    // record(), submit to the device's queue, and wait; a native device computes here. Commands of record() that have
    // not been submitted are assumed to be dropped. After an error other than those of record() half of an update may
    // have happened (a JobSystem that throws, for example): then restore a saved state before the crowd goes on.
    Result<void> update(float time_step_s, const CrowdView* view = nullptr);

    // Everything that the next updates build on, as bytes: for a rollback, a replay, a game that is saved. They fit
    // only crowds of the same characters, controllers, rules and capacities, on the same kind of device: a native one,
    // or one whose limits give the same path and scan method (path()), also where these are chosen automatically, and
    // divide groups into the same OutputBlocks. So a saved game that is to survive changes of these, or another
    // graphics card, also keeps the game's own data (feedback() of watch()). A crowd that gets them back, this one or
    // another with the same settings, goes on as this one does from here, bit for bit on the same device (except where
    // more than 64 agents crowd into one cell of the steering grid, whose order is left to chance): all that instances
    // play, layers and parameters, placements, poses, springs, agents, who is there and their handles, who is watched,
    // and what has been set and not yet been taken up. Matrices are left out, except where updates build on them
    // (CrowdSettings::keep_previous_matrices, Culling::skips_updates, inertial transitions). The same version of throng
    // reads them, on machines of the same byte order. Both calls submit and wait; updates that have been recorded must
    // have been submitted or discarded, and one for a view with occlusion must have had its second half.
    //
    // After restore_state(), outputs() still show what they did before (in a new crowd, nothing) until the next update,
    // so call update(0) before you draw. That is an ordinary update: it takes up calls and births that are pending, and
    // transitions are taken. To go on exactly as saved, restore the state once more after drawing. Handles that were
    // received after the state was saved must be forgotten: generations are restored too, so such a handle may name
    // another instance later. Feedback that has not been fetched is gone, and updates are counted on from the number at
    // which they were saved. After an error nothing has changed. Errors: kInvalidFile (damaged, of another version),
    // kInvalidArgument (a crowd with other settings, and what differs; the last record() has not run; the second half
    // of an update for a view with occlusion is still to come).
    Result<std::vector<std::byte>> save_state();
    // The same into `out`, whose memory is used again if it is large enough. After an error `out` is as it was, or
    // empty.
    Result<void> save_state(std::vector<std::byte>& out);
    Result<void> restore_state(std::span<const std::byte> state);

    // The outputs of the last record(), or those of one frame slot. Each record() writes to the next slot, and after
    // the last slot to the first: frame_slot() says which one the last record() wrote to. There are
    // CrowdSettings::frames_in_flight slots, and one more with keep_previous_matrices. Their buffers stay the same, so
    // an application can make its descriptors once for each slot. Empty if there is no such slot.
    std::span<const OutputBlock> outputs() const;
    std::span<const OutputBlock> outputs(uint32_t frame_slot) const;
    uint32_t frame_slot_count() const;
    uint32_t frame_slot() const;
    // What a group is drawn from, besides its outputs. Errors: kInvalidArgument (no such group).
    Result<GroupMesh> mesh(uint32_t group) const;
    // Times of the newest of the last four updates that has finished. Errors: kInvalidArgument where timestamps are off
    // or nothing has run yet.
    Result<StageTimes> stage_times() const;

    // These copy one instance's results of the last update; they submit and wait. For an instance that was spawned
    // since, they return what its number showed before. Shapes: [palette_count], [joint_count], [vertex_count]. Errors:
    // kInvalidArgument (the instance is not there, a group of CrowdGroup::sockets_only; with a skin pool, an instance
    // that the last update has not drawn; no update has been made; the last record() has not run).
    Result<std::vector<Affine>> read_skin_matrices(const InstanceHandle& instance);
    Result<std::vector<Affine>> read_model_matrices(const InstanceHandle& instance);
    // Morphed and skinned on the GPU, model space, in the order of Character::vertices; with Culling::reduces_joints,
    // only for instances that the last update has listed.
    Result<std::vector<Vec3<float>>> read_positions(const InstanceHandle& instance);

    // What the last update has listed, in the order of the lists. Errors: kInvalidArgument without
    // CrowdSettings::culling.
    Result<std::vector<DrawnInstance>> read_drawn();

    // Device memory that the crowd holds; what it shares with other crowds of its characters is counted in each of
    // them.
    uint64_t size_bytes() const;

    // Internal.
    explicit Crowd(std::unique_ptr<CrowdState> state);
    CrowdState& state() const;  // throws where there is none

private:
    std::unique_ptr<CrowdState> state_;
};

}  // namespace throng
