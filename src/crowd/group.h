// One character of a crowd, uploaded: what all of its instances share.
#pragma once

#include "bind/pose_of_skin.h"
#include "bind/sockets_io.h"
#include "control/controller_io.h"
#include "control/layer_commands.h"
#include "crowd/group_rows.h"
#include "crowd/path.h"
#include "crowd/shared_rigs.h"
#include "cull/cull_io.h"
#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "morph/morph.h"
#include "procedural/procedural_tables.h"
#include "skin/skin.h"
#include "steer/terrain_io.h"

#include <throng/crowd.h>

#include <algorithm>
#include <array>
#include <optional>

namespace throng {

// A set of joints that are animated in one pass.
struct FusedJoints {
    uint32_t joint_count = 0;
    FusedPlan plan;
    Buffers tables;                           // of upload_fused_tables()
    std::shared_ptr<const NativeRig> native;  // where the group is updated natively
    native::AlignedBytes native_masks;        // of the controller, by NativeRig::masks_in_order()
};

// What a group with a controller has in addition.
struct GroupController {
    GroupController(Uploads& uploads, const Controller& controller, const Character& character,
                    bool applies_root_motion, Buffers& buffers);

    uint32_t layer_count = 0, parameter_count = 0, mask_count = 0, active_clip_limit = 0;
    bool applies_root_motion = false;
    bool is_inertial = false;            // has inertial transitions or plays
    uint32_t model_layer_count = 0;      // layers that blend rotations in model space
    std::vector<LayerKind> layer_kinds;  // [layer_count]
    std::vector<io::LayerState> initial_layers;
    std::vector<float> initial_parameters;
    std::vector<float> masks;  // [mask][joint]
    uint64_t checksum = 0;     // of its tables
};

// Joints that things are attached to.
struct GroupSockets {
    std::vector<uint32_t> joints;
};

// Rules that move joints.
struct GroupProcedural {
    std::vector<ProceduralTables::Dispatch> dispatches;
    uint32_t spring_count = 0, target_count = 0;  // of an instance
    uint64_t checksum = 0;                        // of its tables and the targets' names
};

// A group's part of CrowdGroup::skin_pool.
struct GroupSkinPool {
    uint32_t capacity = 0;
    uint32_t shared_row_count = 0;
    float pose_spread = 0;               // SharedPoses::spread
    std::vector<std::byte> shared_skin;  // empty once it is in the buffers of batches

    // Rows that instances of a batch may have of their own.
    uint32_t row_count(uint32_t instance_count) const { return std::min(capacity, instance_count); }
};

struct GroupLife {
    // What decode_images() has decoded. Renderers find it through SharedValues, which keeps nothing alive, and release
    // it when they have made their textures
    mutable std::shared_ptr<const void> decoded{};
};

struct Group {
    Group() = default;  // is_gone()
    Group(Uploads& uploads, SharedRigs& rigs, const CrowdGroup& group, const PathChoice& choice,
          const CrowdSettings& settings);

    // Lets others tell this group from one made later at the same index, and notice when it is gone.
    std::shared_ptr<const GroupLife> life = std::make_shared<const GroupLife>();
    std::string name;
    bool varies = false;            // instances come and go: CrowdGroup::capacity
    uint32_t initial_count = 0;     // of instances, if it varies
    uint32_t command_capacity = 0;  // ShaderCommands::capacity
    bool shaders_populate = false;  // ShaderCommands::populate
    uint32_t joint_count = 0;
    uint32_t palette_count = 0;
    uint32_t vertex_count = 0;
    std::vector<uint32_t> parents;  // [joint_count], joints or kNone
    uint32_t level_count = 0;
    std::vector<float> clip_durations_s;
    uint64_t names_checksum = 0;  // of its clips and joints
    std::vector<MeshSection> sections;
    std::vector<AssetMaterial> materials;
    SharedImages images;
    Vec3<float> shown_min, shown_max;  // what pictures are fitted to
    Vec3<float> posed_min, posed_max;  // of all poses
    std::vector<Lod> lods;
    std::vector<IndexRange> lod_ranges;  // [1 + lods][sections], of indices

    Buffers buffers;  // what kernels read of the character, and of what the group's settings ask for
    Buffer indices;   // of all levels of detail
    std::optional<GroupController> controller;
    std::optional<GroupSockets> sockets;
    SocketSpace socket_space = SocketSpace::kWorld;
    bool sockets_only = false;
    std::optional<Steering> steering;
    std::optional<io::TerrainPush> terrain;  // the heights are in `buffers`
    bool is_carried = false;
    std::optional<GroupProcedural> procedural;
    bool packed = false;
    bool native = false;  // PathChoice::native
    ScanChoice scan_choice;
    std::string scan_reason, path_reason;
    std::optional<ScanStage> scan;  // where staged
    // Where fused: all joints; then, with Culling::reduces_joints, those of each coarser level of detail
    std::vector<FusedJoints> fused;
    std::shared_ptr<const GroupRows> rows;                   // where fused kernels read rows
    std::array<uint32_t, io::kLodCount> set_entry_counts{};  // [fused], palette entries of each set of joints
    bool uniform_scale = false;                              // Rig::uniform_scale
    uint32_t pose_capacity = 0;
    std::unique_ptr<const PoseOfSkin> pose_of_skin;  // where poses may be requested
    std::optional<GroupSkinPool> skin_pool;
    uint32_t influence_count = 0;  // of one set of joints; those of each set lie one after another
    uint32_t morph_count = 0;
    uint32_t active_morph_limit = 0;  // that an instance shows at most
    uint32_t outfit_count = 0;
    std::vector<std::vector<uint32_t>> section_materials;  // [section], as in io::SectionLook: all materials
                                                           // in which outfits show the section

    bool is_gone() const { return joint_count == 0; }
    const Buffer& operator[](uint32_t number) const { return buffers[number]; }
    // Gives up the native update that was chosen. Throws kUnsupported if the group must be updated natively.
    void leave_native(const std::string& reason);
    // The native rig of all joints; null where the group is not updated natively in one pass.
    const NativeRig* native_rig() const { return fused.empty() ? nullptr : fused[0].native.get(); }
    // Whether instances that are not drawn can keep their last pose: nothing but a picture shows it, and no pose
    // depends on the previous one.
    bool animates_drawn_only() const { return !fused.empty() && !sockets && !(controller && controller->is_inertial); }
    // Whether skin matrices outlive an update.
    bool skips_updates(const CrowdSettings& settings) const {
        return settings.culling && animates_drawn_only() &&
               (settings.keep_previous_matrices || settings.culling->skips_updates);
    }
    // The set of joints that a level of detail uses, and thus the set of influences that refer to no other joints.
    uint32_t influence_set_of(uint32_t lod) const {
        return fused.size() > 1 ? std::min(lod, static_cast<uint32_t>(fused.size()) - 1) : 0;
    }
    // Where a level of detail of a section lies in `indices` and in the influences of all sets of joints.
    SectionLod section_lod(size_t section, uint32_t lod) const {
        const IndexRange& range = lod_ranges[lod * sections.size() + section];
        return {range.first_index, range.index_count,
                sections[section].first_influences + influence_set_of(lod) * influence_count};
    }
    GroupMesh mesh() const;
    bool has_root_motion() const { return controller && buffers[io::kRootRowsBuffer].size_bytes() > sizeof(io::vec4); }
    // Whether updates themselves change placements.
    bool moves_placements() const {
        return steering || terrain || is_carried || command_capacity > 0 ||
               (has_root_motion() && controller->applies_root_motion);
    }
    // Updates leave the sockets of carried groups in model space, since only the attach stage knows the placements.
    // That stage transforms them to world space.
    uint32_t socket_flags() const {
        return socket_space == SocketSpace::kWorld && !is_carried ? io::kSocketsToWorld : 0;
    }
    uint32_t socket_count() const { return sockets ? static_cast<uint32_t>(sockets->joints.size()) : 0; }
    bool takes_similarities() const { return scan_choice.method->format == ScanFormat::kSimilarity; }
    uint64_t size_bytes() const;  // without native rigs, which groups share

private:
    void make_procedural(Uploads& uploads, const ProceduralRules& rules, const Character& character);
    void make_native(SharedRigs& rigs, const Character& character, const CrowdSettings& settings, uint32_t lod);
    void add_fused(Uploads& uploads, SharedRigs& rigs, const Character& character, FusedRig rig, FusedPlan plan,
                   bool may_have_rows);
    void make_lods(Uploads& uploads, const Character& character);
    void reduce_joints(Uploads& uploads, SharedRigs& rigs, const Character& character, const CrowdSettings& settings);
    void make_palette_by_set(Uploads& uploads, const Character& character);
    void make_skin_tables(Uploads& uploads, const Character& character);
    float usual_pose_margin(SkinBlend blend) const;
    void bound_poses(const Character& character, float margin);
    void make_looks(Uploads& uploads, const CrowdGroup& group);
    void make_terrain(Uploads& uploads, const Terrain& made_of);
    void make_sockets(Uploads& uploads, const std::vector<uint32_t>& joints);
    Group(Uploads& uploads, SharedRigs& rigs, const Character& character, const PathChoice& choice, bool varies);
};

// The first of the rest pose's tracks, which come after those of the clips.
inline uint32_t rest_track_of(const Group& group) {
    return static_cast<uint32_t>(group.clip_durations_s.size()) * group.joint_count;
}

}  // namespace throng
