// A crowd: instances of compiled characters, each animated on its own, on the GPU, every frame.
#pragma once

#include <throng/attachment.h>
#include <throng/commands.h>
#include <throng/crowd_settings.h>
#include <throng/device.h>
#include <throng/feedback.h>
#include <throng/group_mesh.h>
#include <throng/look.h>
#include <throng/outputs.h>
#include <throng/playback.h>
#include <throng/population.h>
#include <throng/procedural.h>
#include <throng/stage_times.h>
#include <throng/view.h>

#include <concepts>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace throng {

struct CrowdState;  // internal

// Not thread-safe: one thread at a time per crowd. Different crowds are independent except for their device's queue.
class Crowd {
public:
    // Makes a crowd. Submits nothing and waits for nothing, so that a thread can make a crowd while others record and
    // submit. The initial contents of its buffers stay in host memory until the first update, or record_uploads(),
    // brings them to the device. Tables of a character are shared with other
    // crowds of the device whose uploads are known to have run: after their first update(), or from the first record()
    // that finds their first update finished. Crowds made before that have tables of their own; to share from the
    // start, make one crowd of several groups.
    //
    // Errors: kInvalidArgument (no character; no instances; unknown scan; a setting out of its range, or "not together
    // with" another; a controller, sockets, rules, steering, terrain or outfits that do not fit the character; a
    // Character that has been modified and no longer is as character.h says), kUnsupported (the scan method, the path,
    // the skin format, the skin blend or the rules do not apply to a character or device; a skin pool, or capacity with
    // keep_previous_matrices, with settings that exclude it), kLimit (names what exceeds which limit, of throng or the
    // device), kOutOfMemory.
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
    std::vector<GroupIndex> groups() const;
    // The group that an instance belongs to, or belonged to before it was despawned (for example, that of an event).
    // Errors: kInvalidArgument (no group has such a number).
    Result<GroupIndex> group_of(const InstanceHandle& instance) const;
    // Errors: kInvalidArgument (no such group).
    Result<GroupPath> path(GroupIndex group) const;

    // Moves the groups of another crowd of the same device, which has not been updated yet, into this one: for a
    // character that a game streams in, or for more instances of one. A loading thread can make that crowd while this
    // one goes on (create(), record_uploads()), and set how its instances begin. After the call they belong to this
    // crowd: they steer around its agents and can be attached to its sockets. `other` is then empty, like Crowd().
    // Nothing waits or is submitted.
    //
    // Returns the numbers that the groups have here, in their order: the lowest that are free. Instances get the lowest
    // numbers at which enough are free in a row, and new handles (instances(group), handle()). The other crowd's
    // watched instances and wind are dropped. Data that stages keep for all groups together is rebuilt, in
    // about a millisecond, and what updates under way still use is freed later, a part in each update from about the
    // tenth on. outputs() change because of the new groups, and spans that it has returned become invalid.
    //
    // Both crowds need the same CrowdSettings, except for groups, path, scan, timestamps and capacities of
    // feedback (but pose_request_capacity is above 0 in both or neither). If a group has CrowdGroup::capacity or
    // skin_pool, which make its crowd cull, the other crowd needs CrowdSettings::culling.
    //
    // After an error nothing has changed, except that the groups of the other crowd may not be updated natively any
    // more. Errors: kInvalidArgument (other settings, device; it has been updated; the second half of an update for a
    // view with occlusion is still to come), kUnsupported (on a software device, if one crowd is updated natively and
    // the other cannot be), kLimit (of memory: what is still to be freed counts), kOutOfMemory.
    Result<std::vector<GroupIndex>> add_groups(Crowd&& other);
    // Removes a group with all of its instances; instances attached to them stay where they are. The other groups and
    // their instances keep their numbers. outputs() lose the group's blocks, and spans that it has returned become
    // invalid; the views of other groups stay the same. The group's memory is freed later, a part in each update
    // from about the tenth on (record() with a time step of 0 counts). Errors: kInvalidArgument (no such group; the
    // only one with instances; the last record() failed; the second half of an update for a view with occlusion is
    // still to come).
    Result<void> remove_group(GroupIndex group);

    // Adds instances to a group with CrowdGroup::capacity, one for each placement, or removes some; this takes effect
    // with the next record(). New instances get the lowest numbers that are free, and are as they would be in a new
    // crowd: they play the rest pose, or their controller begins; they have no pose from set_pose(), target,
    // destination or speed, and are not watched. Calls that name an instance that is not there are errors. Each
    // instance that comes or goes uploads 4 bytes; a new one also uploads its placement and 36 bytes for what it plays.
    // After an error nothing has happened.
    //
    // Errors: kInvalidArgument (no such group, or without capacity; placement not finite; the handle of an instance
    // that is gone, or one given twice), kLimit (more than there is room for).
    Result<std::vector<InstanceHandle>> spawn(GroupIndex group, std::span<const Affine> world_from_model);
    Result<void> despawn(std::span<const InstanceHandle> instances);
    // The same for one instance. Templates, so that spawn(group, {first, end}) with pointers still means the calls
    // above; several values are given as a vector or an array.
    template <std::same_as<Affine> One>
    Result<InstanceHandle> spawn(GroupIndex group, const One& world_from_model) {
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
    // The number of live instances of a group. Errors: kInvalidArgument (no such group, or one with
    // ShaderCommands::populate).
    Result<uint32_t> alive_count(GroupIndex group) const;

    // All instance numbers of the crowd, or of one group, in use or not. In groups without CrowdGroup::capacity all are
    // in use; in others, a call that is given all numbers is an error while some are free. Errors: kInvalidArgument (no
    // such group).
    Instances instances() const;
    Result<Instances> instances(GroupIndex group) const;

    // The calls below take effect with the next record(), in the order in which they are made. Each sets one value for
    // all of the instances, or one for each. After an error nothing has been set. Errors of all: kInvalidArgument (an
    // instance is not there, or the number of values does not match).

    // What instances play, and where they stand. New instances play the rest pose and stand at the origin. A playback
    // replaces the one before at once, and its clips begin at their time_s: for fades from clip to clip see play(). The
    // placement of an attached instance is ignored. Only changed instances are uploaded: 36 bytes each for a playback,
    // 48 for a placement (128 with root motion, 136 where it moves placements). Errors: kInvalidArgument (clip out of
    // range, value not finite, weight outside 0..1, set_playback() for a group with a controller).
    Result<void> set_playback(const Instances& instances, const Playback& playback);
    Result<void> set_playback(const Instances& instances, std::span<const Playback> playback);
    Result<void> set_placement(const Instances& instances, const Affine& world_from_model);
    Result<void> set_placement(const Instances& instances, std::span<const Affine> world_from_model);

    // How instances look, in Renderer's pictures and for the application's own shaders; an instance's size comes from
    // its placement. 16 bytes are uploaded for each. Errors: kInvalidArgument (no such outfit, tint out of range).
    Result<void> set_look(const Instances& instances, const InstanceLook& look);
    Result<void> set_look(const Instances& instances, std::span<const InstanceLook> look);

    // Attaches instances to sockets of others, or detaches them; a detached instance stays where it is until it is
    // placed. Each update places attached instances after everything that moves their carriers, so that both match in
    // every picture; culling uses their placement in the update before. When a carrier is despawned, what is attached
    // to it stays where it is. 64 bytes are uploaded for each.
    //
    // Carriers can be attached to others in turn, in chains of up to 64: each level takes a dispatch, and attaching to
    // such a carrier takes time in proportion to the number of all attachments. Errors: kInvalidArgument (a group
    // without CrowdGroup::is_carried, no such carrier or socket, sockets in model space, number not finite, an instance
    // would be attached to itself or in a longer chain). Detaching what is not attached does nothing, whatever its
    // group.
    Result<void> attach(const Instances& instances, const Attachment& attachment);
    Result<void> attach(const Instances& instances, std::span<const Attachment> attachment);
    Result<void> detach(const Instances& instances);

    // For instances whose groups have controllers; direct_layers() makes a controller for games that play clips only by
    // these calls. 32 bytes are uploaded for each, and applied on the GPU. Parameters and layers are numbered as in the
    // Controller. Errors: kInvalidArgument (no controller; layer with states; inertial fade on a layer without
    // ControllerLayer::inertial_plays; clip, mask or parameter out of range; value not finite; negative fade; weight
    // outside 0..1; set_state(): layer without states, no such state, phase outside 0..1).
    Result<void> play(const Instances& instances, LayerIndex layer, const LayerPlayback& playback);
    Result<void> play(const Instances& instances, LayerIndex layer, std::span<const LayerPlayback> playback);
    // Puts a layer with states into one of them, whatever its transitions say: a state that comes from another machine,
    // a saved game or a script, or the first motion of the layer in WatchedInstance::layers. It starts with the
    // `phase` and `loops` of the given PlayedMotion; the beginning of a state that plays backwards is phase 1. Its
    // `fade`, `speed` and `loop` are ignored.
    //
    // The state replaces what is shown within `fade_s` seconds (0: at once, but an inertial transition under way decays
    // as before). Transitions are taken from it in the same update already; while it fades in, only those that may
    // interrupt. Older plays of its sync group that are still fading out continue in step with it, from its phase.
    Result<void> set_state(const Instances& instances, LayerIndex layer, const PlayedMotion& motion, float fade_s = 0);
    Result<void> set_state(const Instances& instances, LayerIndex layer, std::span<const PlayedMotion> motion,
                           float fade_s = 0);
    Result<void> set_layer(const Instances& instances, LayerIndex layer, const LayerBlend& blend);
    Result<void> set_layer(const Instances& instances, LayerIndex layer, std::span<const LayerBlend> blend);
    Result<void> set_parameter(const Instances& instances, ParameterIndex parameter, float value);
    Result<void> set_parameter(const Instances& instances, ParameterIndex parameter, std::span<const float> value);

    // Input of the procedural rules. Until it is set a target has weight 0, and does nothing. Errors: kInvalidArgument
    // (no such target, place not within +-1e15, weight outside 0..1; wind: velocity beyond 1e6, gust outside 0..1,
    // wavelength below 1e-6).
    Result<void> set_target(const Instances& instances, TargetIndex target, const TargetPlace& place);
    Result<void> set_target(const Instances& instances, TargetIndex target, std::span<const TargetPlace> place);
    Result<void> set_wind(const Wind& wind);

    // Where agents (CrowdGroup::steering) walk to; the height does not matter. An agent without a destination stands,
    // and others keep away from it. An agent has arrived when it is within its radius of the destination; then it
    // stands, and walks back when it has been pushed away by twice its radius. 16 bytes are uploaded for each. Errors:
    // kInvalidArgument (a group has no steering, place not finite).
    Result<void> set_destination(const Instances& instances, const Vec3<float>& world_place);
    Result<void> set_destination(const Instances& instances, std::span<const Vec3<float>> world_place);
    Result<void> clear_destination(const Instances& instances);

    // A pose from outside (a ragdoll, a cut scene) in place of the animated one, which goes on underneath; procedural
    // rules move such a pose too. parent_from_joint[joint_count] for all of the instances, or one pose for each, one
    // after another. Only the poses set are uploaded, 48 bytes a joint, and 8 for each instance that fades.
    //
    // If an instance has no pose, the new one fades in within `fade_s` seconds (0: at once). It counts as having one
    // until it is cleared, so a call in each frame replaces the pose and lets the fade continue. clear_pose() fades the
    // pose out, and frees its slot (CrowdGroup::pose_capacity) when that is done; a pose set meanwhile fades in from
    // the weight reached. Translations and scales are blended linearly, rotations on the shortest path, by a weight
    // that is eased as in docs/controller.md, step 5. Rotations are normalised. Views look for an instance near its
    // placement (CrowdGroup::pose_margin), so move that along with a ragdoll that slides away.
    //
    // Errors: kInvalidArgument (another number of joints, a number that is not finite, a rotation of length 0, a
    // negative fade; where Rig::uniform_scale is set, a scale that differs along the axes by more than 1e-5 of itself),
    // kLimit (all CrowdGroup::pose_capacity slots are in use). Clearing where no pose is set does nothing.
    Result<void> set_pose(const Instances& instances, std::span<const Trs<float>> parent_from_joint, float fade_s = 0);
    Result<void> clear_pose(const Instances& instances, float fade_s = 0);

    // From the next record() on, feedback() reports the placement, move, sockets and controller state of each of these
    // instances (WatchedInstance); for the pose that one shows, call request_poses(). Replaces the instances watched
    // before; none ends it. Errors: kInvalidArgument (no group has a controller, sockets or steering, and
    // CrowdSettings::pose_request_capacity is 0), kLimit (more than CrowdSettings::watch_capacity).
    Result<void> watch(const Instances& instances);

    // Requests the poses that these instances show after the next record(). They come once, in the feedback of that
    // update (Feedback::poses): for ragdolls, which begin where the animation ends. To learn the placements too,
    // watch() the instances in the same update. feedback() then takes some 0.07 us of CPU time a joint.
    //
    // The poses are computed from the skin matrices, so they are as exact as SkinFormat; joints that are in no skin
    // have their rest pose. For an instance that the update does not animate because its view does not see it, it is
    // the pose in which it was last seen. The pose includes what procedural rules did to it; if it is given to
    // set_pose(), the rules move it again.
    //
    // Errors: kInvalidArgument (a group without CrowdGroup::pose_capacity, or of CrowdGroup::sockets_only), kLimit
    // (more than CrowdSettings::pose_request_capacity).
    Result<void> request_poses(const Instances& instances);

    // The feedback of all updates that have finished since the last call, oldest first; does not wait. An update's
    // feedback is kept until the fourth record() after it: to miss nothing, call this between any two record()s, with
    // fewer than four updates in flight. Empty if no group has a controller, sockets or steering, and no pose can be
    // requested.
    Result<std::vector<Feedback>> feedback();

    // Records the upload of the initial contents of the crowd's buffers, so that the first update need not: into
    // commands for any queue that can copy, of the adopted queue's family or of AdoptedDevice::more_queue_families.
    // Does nothing once record() has been called, and on a native device. Errors: kInvalidArgument (no command buffer).
    //
    // These commands must have run before the commands of the first record() run; if need be, make those wait by a
    // semaphore. They must have been submitted before the crowd is saved, restored, read or drawn and, if their queue
    // is not the adopted one, must also have run by then. If they will never be submitted, call this again, or discard
    // the first record() that follows.
    Result<void> record_uploads(VkCommandBuffer commands);

    // Records one update into the caller's command buffer (recording, outside a render pass, of the adopted queue's
    // family, or of another one of AdoptedDevice::more_queue_families that computes). The update advances every
    // instance by `time_step_s` times its speed, then runs control, and sample, blend, scan and bind or all four in
    // one. A playback set since the last record() starts at its time plus this step.
    //
    // With a negative step clips, states, root motion and wind go back, while fades and springs wait. With a step of 0
    // or below agents stand, but transitions are taken and triggers reset as ever.
    //
    // The recorded commands may be submitted once, must run in the order in which they were recorded, and must have
    // finished before the crowd is destroyed. update(), read_...() and save_state() submit commands of their own, so
    // submit what has been recorded before you call these. What was bound for compute (pipeline, descriptor sets, push
    // constants) is no longer bound afterwards. On a native device the command buffer is VK_NULL_HANDLE, and the update
    // is done when the call returns, as by update().
    //
    // With a view, for crowds that cull (CrowdSettings::culling), time advances for all instances, but only those that
    // the view sees are animated, in groups that are fused and have no sockets or inertial transitions. In other
    // groups, and without a view, all instances are animated; without a view, all are listed too. Whether an instance
    // is in view is decided by a box around the poses of all clips, enlarged by CrowdGroup::pose_margin.
    //
    // Errors: kInvalidArgument (no command buffer, or one on a native device; the time step or the view is not finite;
    // a view and no culling; where there is feedback(), the update of four record()s ago has not finished),
    // kUnsupported (CrowdView::occlusion on a native device; on a software device CrowdGroup::sockets_only, and, with
    // inertial transitions, after a native update()). After these nothing has changed. After another error
    // (kOutOfMemory, kLimit) half of an update may have been recorded, which cannot be discarded: restore a saved state
    // before the crowd goes on; after kDeviceLost, restore it into a new crowd on a new device.
    Result<void> record(VkCommandBuffer commands, float time_step_s, const CrowdView* view = nullptr);
    // The second half of an update for a view with CrowdView::occlusion, recorded after its record() and the commands
    // that draw the depths. It tests the boxes of everything in view against these depths, and animates the instances
    // that are visible and were not visible in the last update. After it, the lists hold all visible instances and
    // those that were visible in the last update. A box counts as hidden only behind what has been drawn in front of
    // it, so nothing visible is left out. Call this in each update for such a view. Errors: kInvalidArgument (the last
    // record() was not for such a view, no command buffer or image), kLimit (the device cannot hold the depths in one
    // storage buffer), kUnsupported (a native device).
    Result<void> record_disoccluded(VkCommandBuffer commands, const DepthImage& depths);
    // Says that the commands of the last record(), and of its record_disoccluded(), will never be submitted, for
    // example because a window was minimised or a swapchain is out of date. The crowd is then as if they had not been
    // recorded: time has not advanced, outputs() are those of the update before, and the next record() takes up what
    // was set before, together with what has been set since. (One exception: a pose whose fade-out ended in that update
    // does not come back if CrowdGroup::pose_capacity was exhausted and its slot has been given to another pose.)
    //
    // If an update is dropped without this call, its changes are lost, and if it is the first one, so are the initial
    // contents of the buffers. After four such updates in a row record() fails if there is feedback(), until this call
    // or update(). Errors: kInvalidArgument (nothing has been recorded since the last discard or update(), groups have
    // been added or removed since, the commands have run, or the last record() failed).
    Result<void> discard_last_record();
    // record(), submit to the device's queue, and wait; a native device computes here. Commands of record() that have
    // not been submitted are assumed to be dropped. After an error other than those of record(), for example from a
    // JobSystem that throws, half of an update may have happened: then restore a saved state before the crowd goes on.
    Result<void> update(float time_step_s, const CrowdView* view = nullptr);

    // Everything that the next updates build on, as bytes: for a rollback, a replay, a saved game. A crowd that
    // restores them, this one or another with the same settings, continues as this one does from here, bit for bit on
    // the same device (except where more than 64 agents crowd into one cell of the steering grid, whose order is left
    // to chance). Both calls submit and wait. Recorded updates must have been submitted or discarded, and one for a
    // view with occlusion must have had its second half.
    //
    // Saved are all that instances play, layers and parameters, placements, poses, springs, agents, which instances are
    // there and their handles, which are watched, and what calls have set that no record() has taken up yet. Matrices
    // are left out, except where updates build on them (CrowdSettings::keep_previous_matrices, Culling::skips_updates,
    // inertial transitions).
    //
    // A state fits only crowds of the same characters, controllers, rules and capacities, on the same kind of device: a
    // native one, or one whose limits give the same path and scan method (path()), also where these are chosen
    // automatically, and divide groups into the same OutputBlocks. It is read by the same version of throng, on
    // machines of the same byte order. A saved game that must survive changes of any of these, or another graphics
    // card, should also keep the game's own data (feedback() of watch()).
    //
    // After restore_state(), outputs() still show what they did before (in a new crowd, nothing) until the next update,
    // so call update(0) before you draw. That is an ordinary update: it takes up pending calls and spawns, and
    // transitions are taken. To continue exactly as saved, restore the state once more after drawing.
    //
    // Forget all handles that were received after the state was saved: generations are restored too, so such a handle
    // may name another instance later. Feedback that has not been fetched is lost, and updates are counted on from the
    // number at which they were saved.
    //
    // After an error nothing has changed. Errors: kInvalidFile (damaged, of another version), kInvalidArgument (a crowd
    // with other settings, and what differs; the last record() has not run; the second half of an update for a view
    // with occlusion is still to come).
    Result<std::vector<std::byte>> save_state();
    // The same into `out`, whose memory is used again if it is large enough. After an error `out` is as it was, or
    // empty.
    Result<void> save_state(std::vector<std::byte>& out);
    Result<void> restore_state(std::span<const std::byte> state);

    // The outputs of the last record(), or those of one frame slot. Each record() writes to the next slot, and after
    // the last slot to the first: frame_slot() says which one the last record() wrote to; before the first
    // one it is 0. The next record() writes to slot (frame_slot() + 1) % frame_slot_count(), the first one too. There
    // are CrowdSettings::frames_in_flight slots, and one more with keep_previous_matrices. Their buffers stay the same,
    // so an application can make its descriptors once for each slot. Empty if there is no such slot.
    std::span<const OutputBlock> outputs() const;
    std::span<const OutputBlock> outputs(uint32_t frame_slot) const;
    uint32_t frame_slot_count() const;
    uint32_t frame_slot() const;
    // What a group is drawn from, besides its outputs. Errors: kInvalidArgument (no such group).
    Result<GroupMesh> mesh(GroupIndex group) const;
    // Times of the newest of the last four updates that has finished. Errors: kInvalidArgument where timestamps are
    // off, the queue has none, or nothing has run yet.
    Result<StageTimes> stage_times() const;

    // These copy one instance's results of the last update; they submit and wait. For an instance that was spawned
    // since, they return what its number held before. Shapes: [palette_count], [joint_count], [vertex_count]. Errors:
    // kInvalidArgument (the instance is not there, a group of CrowdGroup::sockets_only; model matrices without
    // CrowdSettings::keep_model_matrices; with a skin pool, an instance that the last update has not drawn; no update
    // has been made; the last record() has not run).
    Result<std::vector<Affine>> read_skin_matrices(const InstanceHandle& instance);
    Result<std::vector<Affine>> read_model_matrices(const InstanceHandle& instance);
    // Morphed and skinned on the GPU, model space, in the order of Character::vertices; with Culling::reduces_joints,
    // only for instances that the last update has listed.
    Result<std::vector<Vec3<float>>> read_positions(const InstanceHandle& instance);

    // What the last update has listed, in the order of the lists; submits and waits. Errors: kInvalidArgument (a
    // crowd that does not cull; the last record() has not run).
    Result<std::vector<DrawnInstance>> read_drawn();

    // Device memory that the crowd holds. What it shares with other crowds of its characters is counted in each of
    // them.
    uint64_t size_bytes() const;

    // Internal.
    explicit Crowd(std::unique_ptr<CrowdState> state);
    CrowdState& state() const;  // throws where there is none

private:
    std::unique_ptr<CrowdState> state_;
};

}  // namespace throng
