// What a crowd is made of: its groups, how they are updated, and what updates give.
#pragma once

#include <throng/character.h>
#include <throng/controller.h>
#include <throng/device.h>
#include <throng/look.h>
#include <throng/procedural.h>
#include <throng/scan.h>
#include <throng/skin_format.h>
#include <throng/steering.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

// What the outputs of sockets hold: model_from_joint, or world_from_joint (with the instance's placement applied).
enum class SocketSpace { kModel, kWorld };

// Keeps skin matrices only for the instances that are drawn, so that their memory depends on `capacity` and not on how
// many instances there are. A drawn instance has its own row of the pool, unless it is so far away that the
// difference cannot be seen (CrowdView::shared_pose_pixels). Then it is not animated, and shows the nearest of the
// shared poses, which are sampled from each clip when the crowd is made. With a controller, that happens only while a
// clip plays alone.
//
// If there are more instances to animate than rows, the rest show a shared pose too: of the clip with the largest
// weight or, with a controller, of the first clip of its lowest layer. Instances with coarser sets of joints give up
// their rows first; within one set, those with the highest numbers.
//
// A large group has several OutputBlocks, each with a pool of its own, of at most 256 MiB.
struct SkinPool {
    uint32_t capacity = 0;  // rows for instances of an OutputBlock; above 0
    // Shared poses per second of each clip; above 0, at most 1000, and poses of all clips times joints at most 2^28
    float shared_poses_per_s = 30;
};

// Commands that the application's shaders write for instances (throng/commands.h). An update executes them after it has
// applied what the CPU's calls have set.
struct ShaderCommands {
    // The most for each update and OutputBlock; above 0, at most 1048576. 64 bytes each, and 16 or more an instance
    uint32_t capacity = 0;
    // Instances are spawned and despawned only by such commands, not by the CPU's calls: shaders choose the instance
    // numbers, below CrowdGroup::capacity, which must be above 0. The group has no instances when the crowd is made
    // (instance_count is 0). Its instances have no handles: calls that name one are errors, also watch(),
    // request_poses(), and attach() with one as the carrier; is_alive() is false. Only Crowd::read_…() take
    // InstanceHandle{number}; which numbers are in use is in OutputBlock::list. Events name its instances with
    // generation 0. Not together with pose_capacity.
    bool populate = false;
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
    // Joints of Character::rig, all different, at most 64, whose transforms each update writes to OutputBlock::socket,
    // in this order. A SocketIndex is an index into this list, not a joint
    std::vector<uint32_t> sockets{};
    SocketSpace socket_space = SocketSpace::kWorld;
    // Its instances can be attached to sockets of other instances (Crowd::attach()). Such a group does not move by
    // itself (steering, terrain, root motion)
    bool is_carried = false;
    // Computes nothing but the sockets and the joints that they depend on: for servers, which ask where hit boxes are
    // and draw nothing. Only works where the group is updated natively in one pass; there are no skin or model
    // matrices.
    bool sockets_only = false;
    // Rules that move joints after the blend; groups with rules are updated stage by stage
    const ProceduralRules* procedural = nullptr;
    // Makes its instances agents. If root motion moves placements, it moves the agents too; otherwise the update moves
    // them at the speed at which they want to walk
    std::optional<Steering> steering{};
    // Its instances, agents or not, stand on this ground: each update sets y of their placements. Not together with
    // is_carried. Groups on equal terrains share memory
    const Terrain* terrain = nullptr;
    // How many instances can have a pose from set_pose() at the same time; 48 bytes a joint each. 0: no cost at all
    uint32_t pose_capacity = 0;
    // How far its poses can reach beyond the boxes of all clips, as a fraction of the character's size, at most 1000;
    // culling enlarges the boxes by it. Unset: a tenth, since blends go a little beyond the clips, or half with a
    // controller, rules, pose_capacity or a CrowdSettings::skin_blend other than kLinear. A ragdoll that falls off a
    // roof while its placement stays there needs more.
    std::optional<float> pose_margin{};
    // Keeps skin matrices only for instances that are drawn. The crowd then culls, also if CrowdSettings::culling is
    // not set. The group must have a mesh and be updated in one pass, on a machine with a native engine
    // (docs/native.md), which computes the shared poses. Not together with sockets, inertial transitions or
    // pose_capacity, nor with the crowd's keep_model_matrices, keep_previous_matrices, Culling::skips_updates or
    // skins_once: all of these need data of instances that are not drawn.
    std::optional<SkinPool> skin_pool{};
    // Above 0: instances come and go, by Crowd::spawn() and despawn(), at most this many at a time; at least
    // instance_count. Such a crowd culls even if CrowdSettings::culling is not set: its lists contain only live
    // instances, and only these are updated and drawn. Unused capacity takes memory, and almost no time; only in groups
    // that are updated stage by stage, a number that is free below others in use may still be scanned
    // (docs/performance.md). Not together with CrowdSettings::keep_previous_matrices if all instances of the group are
    // animated in each update (see record()).
    uint32_t capacity = 0;
    // Its instances also obey commands that the application's shaders write. Not together with is_carried
    std::optional<ShaderCommands> shader_commands{};
    // The most morphs that an instance shows: those with the largest weights by magnitude; of equal weights, the
    // earlier morphs. 0: all that have weight. 8 bytes each for every instance
    uint32_t morph_limit = 0;
    // Ways in which its instances can look, chosen by set_look(), which is an error for groups without outfits
    std::vector<Outfit> outfits{};

    // The first of `sockets` that is a joint of this name, or kNone. socket_named() is the same, but a missing name is
    // an error that says which there are: kInvalidArgument.
    SocketIndex find_socket(std::string_view joint_name) const;
    Result<SocketIndex> socket_named(std::string_view joint_name) const;
};

// How an update gets from clips to skin matrices. On a native device all of these are native.
enum class UpdatePath {
    kAuto,   // natively on software devices where that applies, unless CrowdSettings::scan asks for a method; otherwise
             // as kDevice
    kFused,  // sample, blend, scan and bind in one kernel, with intermediate results in registers and shared memory;
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
// joints, or a Character that has been modified and no longer is as character.h says).
Result<GroupPath> advise_path(const Device& device, const Character& character, uint32_t instance_count);

// Updates can be for a view (CrowdView): then they animate only the instances that it sees, and give those that are
// small on the screen a coarser level of detail. In groups with sockets or inertial transitions, and in those that are
// not updated in one pass (GroupPath::reason says so), all instances are animated, with all joints, in each update.
struct Culling {
    // Animates instances that are small on the screen only in some updates (CrowdView::full_rate_pixels). In between,
    // their skin matrices move evenly towards the next pose; kept model matrices are already those of that next pose.
    // Doubles the memory of skin matrices. Worth it where computation is slow: an update in between moves three times
    // as much memory as one that animates, and an H200 takes less time to compute the pose again.
    bool skips_updates = false;
    // Coarser levels of detail have fewer joints (Character::joint_lods). Skin matrices and kept model matrices are
    // written only for these, so an instance must be drawn with the influences of its level, which refer to no other
    // joints. Has no effect on groups whose instances are all animated in each update, or that have
    // CrowdGroup::pose_capacity.
    bool reduces_joints = false;
};

struct CrowdSettings {
    std::vector<CrowdGroup> groups{};
    UpdatePath path = UpdatePath::kAuto;
    SkinFormat skin_format = SkinFormat::kAffine;
    // "auto", a name of scan_methods(), or a name with its invocations a character: "subgroup:8"
    std::string scan = "auto";
    bool keep_model_matrices = false;  // else they live only within a frame, and read_model_matrices() is an error
    // Provides OutputBlock::previous_skin, for motion vectors; takes the memory of skin matrices once more. Not
    // together with CrowdGroup::capacity in groups whose instances are all animated in each update (see record()). For
    // these, set frames_in_flight to one more than is needed otherwise, and read `skin` of the slot before.
    bool keep_previous_matrices = false;
    // How many updates have outputs at the same time, 1 to 4, each in a frame slot of its own, so that one can be
    // computed while those before it are drawn: on the same queue, or on one for asynchronous compute
    // (AdoptedDevice::more_queue_families). Each slot takes the memory of skin matrices, skinned vertices, placements,
    // sockets, lists and whatever else OutputBlock offers. With several slots, the commands of a record() must not run
    // before everything that reads the outputs of the update that many before has finished; ensure this by a fence or a
    // semaphore.
    uint32_t frames_in_flight = 1;
    // A crowd culls if this is set or a group has CrowdGroup::capacity or skin_pool, which set it to Culling{}. Then
    // updates can be for a view, and list what is drawn (OutputBlock::list, draw). Else every update animates all
    // instances
    std::optional<Culling> culling{};
    SkinBlend skin_blend = SkinBlend::kLinear;
    // Every vertex that is drawn is skinned once, in compute, into OutputBlock::skinned, to be read by several passes
    // (shadow maps, depths, the picture) and by other users of vertices; Renderer then reads it too. 16 bytes a vertex
    // and instance.
    bool skins_once = false;
    bool timestamps = true;  // measure the stages; costs one query a stage and one more
    // The most events of one update that feedback() can report; further ones are only counted. 16 bytes each, five
    // times over
    uint32_t event_capacity = 16384;
    uint32_t watch_capacity = 64;  // the most instances that watch() takes
    // The most poses that request_poses() can request of one update; takes four times the memory of their skin matrices
    uint32_t pose_request_capacity = 0;
};

}  // namespace throng
