#include "crowd/group.h"

#include "base/crc64.h"
#include "base/failure.h"
#include "base/message_name.h"
#include "controller/controller_tables.h"
#include "crowd/group_skin_pool.h"
#include "crowd/look_stage.h"
#include "sample/sample_io.h"
#include "scan/stream_plan.h"
#include "skin/skin_io.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace throng {
namespace {

static_assert(io::kTrackAnimatedBit == kTrackAnimated && io::kTrackStepBit == kTrackStep &&
              io::kTrackPositionMask == kTrackPosition);
static_assert(io::kPackedBitsMask == kPackedBitsMask && io::kPackedLeftOutShift == kPackedLeftOutShift &&
              io::kPackedFull == kPackedFull && io::kPackedStep == kPackedStep &&
              io::kPackedFullBits == kPackedFullBits);
static_assert(sizeof(io::VertexRows) == sizeof(Vertex));

constexpr size_t kSocketLimit = 64;  // as include/throng/crowd_settings.h says

// One timeline per clip, and one for the rest pose, which has a single row at time 0. As words.
std::vector<uint32_t> clip_timelines(const Character& character) {
    std::vector<io::ClipTimeline> timelines;
    for (const Clip& clip : character.clips)
        timelines.push_back({clip.first_time, clip.row_count, clip.row_stride, clip.first_row, clip.duration_s});
    timelines.push_back({.first_time = 0, .row_count = 1, .row_stride = 0, .first_row = 0, .duration_s = 0});
    return as_words(timelines);
}

// A packed track is read as two rows even if the second is left out, so the last track needs one more row behind it.
std::vector<std::array<float, 4>> readable_keys(const Character& character) {
    std::vector<std::array<float, 4>> keys = character.keys;
    if (character.packed) keys.emplace_back();
    return keys;
}

// The rows of all clips, then one that nothing reads, so that the buffer is not empty.
std::vector<io::vec4> readable_root_rows(const Character& character) {
    std::vector<io::vec4> rows;
    for (const auto& [x, z, cosine, sine] : character.root_rows) rows.push_back({x, z, cosine, sine});
    rows.push_back({0, 0, 1, 0});
    return rows;
}

// Includes the zero at the end of each name, which separates names. The numbers of clips and joints are compared
// elsewhere.
uint64_t checksum_of_names(const Character& character) {
    uint64_t checksum = 0;
    const auto add = [&](const std::string& name) {
        checksum = crc64(std::as_bytes(std::span(name.c_str(), name.size() + 1)), checksum);
    };
    for (const Clip& clip : character.clips) add(clip.name);
    for (const std::string& name : character.rig.names) add(name);
    return checksum;
}

struct PoseBox {
    Vec3<float> min, max;
};

// The box around the poses of all clips. The character has at least one.
PoseBox box_of_clips(const Character& character) {
    PoseBox box{character.clips[0].bounds_min, character.clips[0].bounds_max};
    for (const Clip& clip : character.clips)
        for (const auto axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
            box.min.*axis = std::min(box.min.*axis, clip.bounds_min.*axis);
            box.max.*axis = std::max(box.max.*axis, clip.bounds_max.*axis);
        }
    return box;
}

// What pictures are fitted to: the rest pose. But motion capture often has the hips at the origin at rest, so that the
// feet lie below the ground of all clips; then the box of the clips.
PoseBox shown_box(const Character& character) {
    constexpr float kNear = 0.1f;  // of its height
    const PoseBox rest{character.bounds_min, character.bounds_max};
    if (character.clips.empty()) return rest;
    const PoseBox clips = box_of_clips(character);
    return clips.min.y > rest.min.y + kNear * (rest.max.y - rest.min.y) ? clips : rest;
}

}  // namespace

GroupController::GroupController(Uploads& uploads, const Controller& controller, const Character& character,
                                 bool applies_root_motion_in, Buffers& buffers)
    : layer_count(static_cast<uint32_t>(controller.layers.size())),
      parameter_count(static_cast<uint32_t>(controller.parameters.size())),
      mask_count(static_cast<uint32_t>(controller.masks.size())),
      applies_root_motion(applies_root_motion_in) {
    const ControllerTables made = make_controller_tables(controller, character);
    active_clip_limit = made.active_clip_limit;
    initial_layers = made.initial_layers;
    initial_parameters = made.initial_parameters;
    masks = made.masks;
    checksum = crc64(std::as_bytes(std::span(made.words)));
    layer_kinds = throng::layer_kinds(controller);
    is_inertial = has_inertia(controller);
    for (const ControllerLayer& layer : controller.layers) model_layer_count += layer.model_space_rotations ? 1 : 0;
    buffers[io::kControllerBuffer] = upload_table(uploads, character.name + ": controller", made.words);
    buffers[io::kMasksBuffer] = upload_table(uploads, character.name + ": joint masks", made.masks);
    if (model_layer_count > 0)
        buffers[io::kParentsBuffer] = upload_table(uploads, character.name + ": parents", character.rig.parents);
}

Group::Group(Uploads& uploads, SharedRigs& rigs, const CrowdGroup& group, const PathChoice& choice,
             const CrowdSettings& settings)
    : Group(uploads, rigs, *group.character, choice, group.capacity > 0) {
    if (group.controller)
        controller.emplace(uploads, *group.controller, *group.character, group.moves_placements, buffers);
    if (group.shader_commands) {
        command_capacity = group.shader_commands->capacity;
        shaders_populate = group.shader_commands->populate;
    }
    socket_space = group.socket_space;
    sockets_only = group.sockets_only;
    if (sockets_only) palette_count = 0;
    steering = group.steering;
    if (group.terrain) make_terrain(uploads, *group.terrain);
    is_carried = group.is_carried;
    if (varies && controller) {
        buffers[io::kInitialLayersBuffer] = upload(uploads, name + ": initial layers", controller->initial_layers);
        buffers[io::kInitialParametersBuffer] = upload(uploads, name + ": initial parameters",
                                                       controller->initial_parameters);
    }
    if (!group.sockets.empty()) make_sockets(uploads, group.sockets);
    if (group.procedural) make_procedural(uploads, *group.procedural, *group.character);
    uniform_scale = group.character->rig.uniform_scale;
    pose_capacity = std::min(group.pose_capacity, group.instance_count);
    if (pose_capacity > 0 && settings.pose_request_capacity > 0)
        pose_of_skin = std::make_unique<const PoseOfSkin>(*group.character);
    bound_poses(*group.character, group.pose_margin.value_or(usual_pose_margin(settings.skin_blend)));
    try {
        make_native(rigs, *group.character, settings, 0);
    } catch (const Failure& failure) {
        if (uploads.gpu()->is_native()) throw;
        leave_native(failure.error.message);  // a software device can do it
    }
    if (settings.culling && settings.culling->reduces_joints && pose_capacity == 0 && animates_drawn_only())
        reduce_joints(uploads, rigs, *group.character, settings);
    if (skips_updates(settings)) make_palette_by_set(uploads, *group.character);
    make_skin_tables(uploads, *group.character);
    active_morph_limit = group.morph_limit > 0 ? std::min(group.morph_limit, morph_count) : morph_count;
    make_looks(uploads, group);
    if (group.skin_pool) skin_pool = make_skin_pool(uploads, rigs, *this, group, settings);
    if (pose_capacity > 0)
        buffers[io::kSetPosesBuffer] = make_table<io::JointPose>(
            uploads.gpu(), name + ": poses of CrowdGroup::pose_capacity", uint64_t{pose_capacity} * joint_count);
}

Group::Group(Uploads& uploads, SharedRigs& rigs, const Character& character, const PathChoice& choice, bool varies_in)
    : name(message_name(character.name)),
      varies(varies_in),
      joint_count(character.rig.joint_count()),
      palette_count(static_cast<uint32_t>(character.palette.size())),
      vertex_count(static_cast<uint32_t>(character.vertices.size())),
      parents(character.rig.parents),
      level_count(character.rig.level_count),
      sections(character.sections),
      materials(character.materials),
      shown_min(shown_box(character).min),
      shown_max(shown_box(character).max),
      packed(character.packed),
      scan_choice(choice.scan),
      scan_reason(choice.scan_reason),
      path_reason(choice.path_reason) {
    native = choice.native;
    images = rigs.images(character);
    if (choice.fused)
        add_fused(uploads, rigs, character, FusedRig(character), *choice.fused, choice.rows);
    else
        scan.emplace(uploads, scan_choice, ScanRig(character.rig.parents, character.rig.uniform_scale),
                     scan_limits(*uploads.gpu()), varies);
    std::vector<uint32_t> joints;
    std::vector<Affine> binds;
    for (const PaletteEntry& entry : character.palette) {
        joints.push_back(entry.joint);
        binds.push_back(entry.joint_from_bind);
    }
    for (const Clip& clip : character.clips) clip_durations_s.push_back(clip.duration_s);
    names_checksum = checksum_of_names(character);
    buffers[io::kTimelineBuffer] = upload_table(uploads, name + ": clip timelines", clip_timelines(character));
    buffers[io::kTimesBuffer] = upload_table(uploads, name + ": key times", character.times_s);
    buffers[io::kRootRowsBuffer] = upload_table(uploads, name + ": root motion", readable_root_rows(character));
    buffers[io::kTracksBuffer] = upload_table(uploads, name + ": tracks", character.tracks);
    buffers[io::kKeysBuffer] = upload_table(uploads, name + ": keys", readable_keys(character));
    buffers[io::kWordsBuffer] = upload_table(uploads, name + ": key words", character.words);
    buffers[io::kPaletteJointsBuffer] = upload_table(uploads, name + ": palette joints", joints);
    buffers[io::kJointFromBindBuffer] = upload_table(uploads, name + ": inverse binds", binds);
    buffers[io::kVerticesBuffer] = upload(uploads, name + ": vertices", character.vertices);
    buffers[io::kInfluencesBuffer] = upload(uploads, name + ": influences", character.influences);
    influence_count = static_cast<uint32_t>(character.influences.size());
    morph_count = static_cast<uint32_t>(character.morphs.size());
    if (morph_count > 0) upload_morph_tables(uploads, character, buffers);
    make_lods(uploads, character);
}

// Uses rows if `may_have_rows` and the character has any. The joints are then in the order of the rows.
void Group::add_fused(Uploads& uploads, SharedRigs& rigs, const Character& character, FusedRig rig, FusedPlan plan,
                      bool may_have_rows) {
    if (may_have_rows) {
        FusedRig in_order = rig.in_stream_order(StreamTeam(scan_limits(*uploads.gpu()), plan.choice.threads).lanes);
        FusedPlan of_order = plan_fused(plan.choice, in_order, scan_limits(*uploads.gpu()));
        if (fused.empty() && of_order.unsupported_reason.empty()) {
            rows = GroupRows::make(uploads, rigs, character, in_order, buffers);
            if (rows) path_reason += ", from rows";
        }
        if (rows) {
            rig = std::move(in_order);
            plan = std::move(of_order);
        }
    }
    if (!plan.unsupported_reason.empty()) return;  // only for a coarser set: the finer ones suffice
    Buffers tables = rows ? rows->upload_tables(uploads, character, rig, plan)
                          : upload_fused_tables(uploads, character, rig, plan);
    fused.push_back({rig.rig.joint_count(), std::move(plan), std::move(tables), {}, {}});
}

// Indices of all levels of detail, one after the other.
void Group::make_lods(Uploads& uploads, const Character& character) {
    for (const MeshSection& section : sections) lod_ranges.push_back({section.first_index, section.index_count});
    const auto first = static_cast<uint32_t>(character.indices.size());
    for (const IndexRange& range : character.lod_ranges)
        lod_ranges.push_back({first + range.first_index, range.index_count});
    lods = character.lods;
    std::vector<uint32_t> all = character.indices;
    all.insert(all.end(), character.lod_indices.begin(), character.lod_indices.end());
    indices = upload(uploads, name + ": indices", all, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
}

// For a set of joints that add_fused() has added.
void Group::make_native(SharedRigs& rigs, const Character& character, const CrowdSettings& settings, uint32_t lod) {
    if (!native || fused.empty()) return;
    // If more than a third of the joints move, writing all of them in the palette's order is faster (docs/native.md).
    constexpr uint32_t kWorthIt = 3;
    FusedJoints& joints = fused[lod];
    if (lod > 0 && kWorthIt * joints.joint_count > joint_count)
        joints.native = fused[0].native;
    else
        joints.native = rigs.native(character, {.lod = lod,
                                                .keeps_model = settings.keep_model_matrices,
                                                .sockets = sockets ? sockets->joints : std::vector<uint32_t>(),
                                                .sockets_only = sockets_only,
                                                .all_move = pose_capacity > 0});
    if (controller) joints.native_masks = joints.native->masks_in_order(controller->masks);
}

void Group::leave_native(const std::string& reason) {
    if (!native) return;
    if (sockets_only) throw Failure(ErrorCode::kUnsupported, name + ": sockets only", reason);
    native = false;
    for (FusedJoints& joints : fused) joints.native.reset();
    path_reason += "; not native: " + reason;
}

// Adds the sets of joints of coarser levels, as far as the method of the finest supports them, and the influences that
// refer to no other joints.
void Group::reduce_joints(Uploads& uploads, SharedRigs& rigs, const Character& character,
                          const CrowdSettings& settings) {
    if (character.joint_lods.empty()) return;
    std::vector<Influences> all = character.influences;
    for (uint32_t lod = 1; lod <= lods.size(); ++lod) {
        const FusedRig rig(character, lod);
        FusedPlan plan = fused[0].plan;
        if (!uploads.gpu()->is_native()) plan = plan_fused(plan.choice, rig, scan_limits(*uploads.gpu()));
        add_fused(uploads, rigs, character, rig, std::move(plan), rows != nullptr);
        if (fused.size() <= lod) break;
        make_native(rigs, character, settings, lod);
        const std::vector<Influences> of_lod = influences_of_lod(character, lod);
        all.insert(all.end(), of_lod.begin(), of_lod.end());
    }
    buffers[io::kInfluencesBuffer] = upload(uploads, name + ": influences", all);
}

void Group::make_palette_by_set(Uploads& uploads, const Character& character) {
    const auto coarsest_set = [&](uint32_t entry) {
        return fused.size() > 1 ? character.joint_lods[character.palette[entry].joint] : 0;
    };
    std::vector<uint32_t> entries(palette_count);
    std::iota(entries.begin(), entries.end(), 0u);
    std::ranges::stable_sort(entries, std::greater(), coarsest_set);
    for (uint32_t set = 0; set < fused.size(); ++set)
        set_entry_counts[set] = static_cast<uint32_t>(std::ranges::count_if(
            entries, [set](uint32_t coarsest) { return coarsest >= set; }, coarsest_set));
    buffers[io::kPaletteBySetBuffer] = upload_table(uploads, name + ": palette by set", entries);
}

void Group::make_skin_tables(Uploads& uploads, const Character& character) {
    std::vector<uint32_t> influence_offsets;
    for (uint32_t lod = 0; lod <= lods.size(); ++lod)
        influence_offsets.push_back(influence_set_of(lod) * influence_count);
    upload_skin_tables(uploads, character, influence_offsets, buffers);
}

void Group::make_looks(Uploads& uploads, const CrowdGroup& group) {
    outfit_count = static_cast<uint32_t>(group.outfits.size());
    const std::vector<io::SectionLook> looks = section_looks_of(group);
    section_materials.resize(sections.size());
    for (size_t i = 0; i < looks.size(); ++i) {
        std::vector<uint32_t>& materials_of = section_materials[i % sections.size()];
        const uint32_t material = looks[i].material;
        if (material != kNone && std::ranges::find(materials_of, material) == materials_of.end())
            materials_of.push_back(material);
    }
    if (outfit_count > 0) buffers[io::kSectionLooksBuffer] = upload(uploads, name + ": outfits", looks);
}

// The boxes of clips are right for linear blends; dual quaternions can leave them.
float Group::usual_pose_margin(SkinBlend blend) const {
    constexpr float kBlends = 0.1f, kAnything = 0.5f;
    return controller || procedural || pose_capacity > 0 || blend != SkinBlend::kLinear ? kAnything : kBlends;
}

void Group::bound_poses(const Character& character, float margin) {
    const float wider = margin * character.size;
    const PoseBox clips = character.clips.empty() ? PoseBox{character.bounds_min, character.bounds_max}
                                                  : box_of_clips(character);
    for (const auto axis : {&Vec3<float>::x, &Vec3<float>::y, &Vec3<float>::z}) {
        posed_min.*axis = std::min(character.bounds_min.*axis, clips.min.*axis) - wider;
        posed_max.*axis = std::max(character.bounds_max.*axis, clips.max.*axis) + wider;
    }
}

void Group::make_procedural(Uploads& uploads, const ProceduralRules& rules, const Character& character) {
    const ProceduralTables made = make_procedural_tables(rules, character);
    if (const uint64_t most = scan_limits(*uploads.gpu()).loop_iterations; made.max_steps > most)
        throw Failure(ErrorCode::kUnsupported, name + ": procedural rules",
                      "a chain of joints needs " + std::to_string(made.max_steps) +
                          " steps, but the device ends loops after " + std::to_string(most));
    uint64_t checksum = crc64(std::as_bytes(std::span(made.words)));
    for (const std::string& target : rules.targets) checksum = crc64(std::as_bytes(std::span(target)), checksum);
    procedural.emplace(GroupProcedural{made.dispatches, made.spring_count, made.target_count, checksum});
    buffers[io::kRulesBuffer] = upload_table(uploads, name + ": procedural rules", made.words);
}

void Group::make_sockets(Uploads& uploads, const std::vector<uint32_t>& joints) {
    const std::string place = name + ": sockets";
    if (joints.size() > kSocketLimit)
        throw Failure(ErrorCode::kLimit, place,
                      std::to_string(joints.size()) + " joints; at most " + std::to_string(kSocketLimit));
    std::vector<uint32_t> slots(joint_count);
    for (uint32_t i = 0; i < joints.size(); ++i) {
        if (joints[i] >= joint_count)
            throw Failure(
                ErrorCode::kInvalidArgument, place,
                numbered("joint", joints[i]) + " is out of range: the character has " + std::to_string(joint_count));
        if (slots[joints[i]] != 0)
            throw Failure(ErrorCode::kInvalidArgument, place, "joint " + std::to_string(joints[i]) + " is given twice");
        slots[joints[i]] = i + 1;
    }
    sockets.emplace(GroupSockets{joints});
    buffers[io::kSocketJointsBuffer] = upload_table(uploads, place, joints);
    buffers[io::kSocketSlotsBuffer] = upload_table(uploads, place + " by joint", slots);
}

GroupMesh Group::mesh() const {
    const auto view = [](const Buffer& buffer, uint64_t stride_bytes) {
        const uint64_t size_bytes = buffer.size_bytes() / stride_bytes * stride_bytes;
        return buffer.handle() && size_bytes > 0 ? BufferView{buffer.handle(), 0, size_bytes, stride_bytes}
                                                 : BufferView();
    };
    GroupMesh made{.vertex = view(buffers[io::kVerticesBuffer], sizeof(Vertex)),
                   .influences = view(buffers[io::kInfluencesBuffer], sizeof(Influences)),
                   .index = view(indices, sizeof(uint32_t)),
                   .morph_delta = view(buffers[io::kMorphDeltasBuffer], sizeof(MorphDelta)),
                   .lod_count = static_cast<uint32_t>(1 + lods.size())};
    for (size_t section = 0; section < sections.size(); ++section)
        for (uint32_t lod = 0; lod < made.lod_count; ++lod) made.section_lods.push_back(section_lod(section, lod));
    return made;
}

void Group::make_terrain(Uploads& uploads, const Terrain& made_of) {
    terrain = io::TerrainPush{.instance_count = 0,
                              .columns = made_of.columns,
                              .rows = made_of.rows,
                              .x = made_of.x,
                              .z = made_of.z,
                              .inverse_spacing = 1 / made_of.spacing};
    buffers[io::kHeightsBuffer] = upload(uploads, "heights of the terrain", made_of.heights);
}

uint64_t Group::size_bytes() const {
    uint64_t sum = buffers.size_bytes() + indices.size_bytes() + (scan ? scan->links().size_bytes() : 0);
    for (const FusedJoints& joints : fused) sum += joints.tables.size_bytes();
    return sum;
}

}  // namespace throng
