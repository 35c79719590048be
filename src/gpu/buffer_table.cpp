#include "gpu/buffer_table.h"

#include <algorithm>

namespace throng {
namespace {

constexpr std::array<BufferInfo, io::kBufferCount> kInfos{{
    {io::kTimelineBuffer, "timeline", "[C+1]", "`ClipAxis`, 20 bytes", "rows, s; the last is the rest pose", "upload",
     "control, controller"},
    {io::kTimesBuffer, "times", "[all rows]", "float", "s", "upload", "control, controller"},
    {io::kRootRowsBuffer, "root rows", "[rows]", "float4", "(x, z, cos, sin) on the ground", "upload", "controller"},
    {io::kTracksBuffer, "tracks", "[C+1][J]", "`JointTracks`, 16 bytes", "positions in `keys`, flags", "upload",
     "sample, layered, fused"},
    {io::kKeysBuffer, "keys",
     "exact: rest [J][3], then a clip's constants and rows [rows][columns]; packed: `PackedTrack`s", "float4",
     "quaternion, length, factor", "upload", "sample, layered, fused"},
    {io::kWordsBuffer, "words", "packed rows of bits", "uint", "[file format](file_format.md)", "upload",
     "sample, layered, fused"},
    {io::kPaletteJointsBuffer, "palette joints", "[P]", "uint", "joint", "upload", "bind"},
    {io::kJointFromBindBuffer, "joint from bind", "[P]", "affine, 48 bytes",
     "inverse bind; `joint_from_mesh` for rigid meshes", "upload", "bind"},
    {io::kParentsBuffer, "parents", "[J]", "uint", "joints", "upload", "layered in order"},
    {io::kControllerBuffer, "controller", "structs of `controller_io.h` as words", "uint",
     "states, transitions, blend spaces, events", "upload", "controller"},
    {io::kMasksBuffer, "masks", "[masks][J]", "float", "0..1", "upload", "layered, fused"},
    {io::kSocketJointsBuffer, "socket joints", "[sockets]", "uint", "joints", "upload", "sockets"},
    {io::kSocketSlotsBuffer, "socket slots", "[J]", "uint", "1 + the joint's place in `socket joints`, or 0", "upload",
     "fused"},
    {io::kRulesBuffer, "rules", "structs of `procedural_io.h` as words", "uint", "parents, chains, bones, rules",
     "upload", "procedural"},
    {io::kSetPosesBuffer, "set poses", "[pose_capacity][J]", "`JointPose`, 48 bytes", "`parent_from_joint`",
     "`set_pose`", "blend, layered, fused"},
    {io::kAnimatedJointsBuffer, "animated joints", "[joints of a set]", "uint", "joints of the rig", "upload", "fused"},
    {io::kScanLinksBuffer, "scan links", "the method's own", "uint", "joints", "upload", "scan, fused"},
    {io::kBindRangesBuffer, "bind ranges", "[J+1]", "uint", "where a joint's entries begin in the next two", "upload",
     "fused"},
    {io::kBindEntriesBuffer, "bind entries", "[P]", "uint", "palette entries, sorted by joint", "upload", "fused"},
    {io::kBindsBuffer, "binds", "[P]", "affine, 48 bytes", "their inverse binds", "upload", "fused"},
    {io::kPaletteBySetBuffer, "palette by set", "[P]", "uint", "palette entries, those of coarser sets of joints first",
     "upload", "pace"},
    {io::kVerticesBuffer, "vertices", "[vertices]", "`Vertex`, 32 bytes", "bind space", "upload", "skin, draw"},
    {io::kInfluencesBuffer, "influences", "[vertex][sets]", "`Influences`, 24 bytes",
     "palette entries, weights of sum 1", "upload", "skin, draw"},
    {io::kSkinSectionsBuffer, "skin sections", "[levels of detail][sections]", "`SkinSection`, 32 bytes",
     "which vertices a level of detail has", "upload", "skin"},
    {io::kListedVerticesBuffer, "listed vertices", "those of each section", "uint", "vertices", "upload", "skin"},
    {io::kMorphDeltasBuffer, "morph deltas", "[vertex that any moves][morphs of its section]", "`MorphDelta`, 16 bytes",
     "bind space, times the weight", "upload", "skin, draw"},
    {io::kMorphTimelineBuffer, "morph timeline", "[C+1]", "`ClipAxis`, 20 bytes", "rows, s", "upload", "morph"},
    {io::kMorphTimesBuffer, "morph times", "[rows of weights]", "float", "s", "upload", "morph"},
    {io::kMorphTracksBuffer, "morph tracks", "[C+1][morphs]", "uint", "positions in `morph values`, flags", "upload",
     "morph"},
    {io::kMorphValuesBuffer, "morph values", "defaults, then weights of clips", "float", "weight", "upload", "morph"},
    {io::kPlacementsBuffer, "placements", "[I]", "affine, 48 bytes", "`world_from_model`",
     "`set_placement`, controller, steer", "cull, steer, procedural, sockets, draw, your renderer"},
    {io::kPlaybacksBuffer, "playbacks", "[I]", "`InstancePlayback`, 36 bytes", "clip, s, s/s, weight",
     "`set_playback`, then control (times)", "control, morph"},
    {io::kCursorsBuffer, "cursors", "[I]", "`InstanceCursor`, 36 bytes", "rows, fraction 0..1", "control",
     "sample, blend, fused"},
    {io::kCommandsBuffer, "commands", "[a round of them]", "`ControlCommand`, 32 bytes",
     "what `play`, `set_layer` and `set_parameters` asked for", "`record`", "commands"},
    {io::kLayersBuffer, "layers", "[I][layers]", "`LayerState`, 116 bytes", "phases in 2^-32 cycles, weights",
     "commands, controller", "controller, feedback"},
    {io::kLayersBeforeBuffer, "layers before", "is `layers`", "uint", "the same, read as a table", "–", "controller"},
    {io::kParametersBuffer, "parameters", "[I][parameters]", "float", "the controller's",
     "commands, the application, controller (triggers), steer", "controller, feedback"},
    {io::kParametersBeforeBuffer, "parameters before", "is `parameters`", "uint", "the same, read as a table", "–",
     "controller"},
    {io::kVoicesBuffer, "voices", "[I][voice_limit]", "`Voice`, 32 bytes", "rows, fraction, weights 0..1", "controller",
     "layered, fused, morph"},
    {io::kVoiceTimesBuffer, "voice times", "[I][voice_limit]", "float", "s; of characters with morphs", "controller",
     "morph"},
    {io::kRootsBuffer, "roots", "[I]", "`RootState`, 80 bytes", "(x, z, cos, sin) on the ground", "controller",
     "controller, steer"},
    {io::kInertiasBuffer, "inertias", "[I]", "`InstanceInertia`, 24 bytes", "s", "controller", "layered, fused"},
    {io::kInertiaStatesBuffer, "inertia states", "[I][J]", "`InertiaState`, 144 bytes",
     "offsets and poses shown, `parent_from_joint`", "layered, fused", "layered, fused"},
    {io::kRotationsBuffer, "rotations", "[layers in model space][J][I]", "`ModelRotations`, 48 bytes",
     "`model_from_joint` as quaternions", "layered in order", "the same, for the joints below"},
    {io::kPosedBuffer, "posed", "[I]", "`InstancePose`, 8 bytes", "slot in `set poses`, weight 0..1",
     "`set_pose`, `clear_pose`, fades", "blend, layered, fused"},
    {io::kActiveMorphsBuffer, "active morphs", "[I][8]", "`ActiveMorph`, 8 bytes", "morph, weight", "morph",
     "draw, skin, your renderer"},
    {io::kTargetsBuffer, "targets", "[I][targets]", "float4", "world; w: weight 0..1", "`set_target`, the application",
     "procedural"},
    {io::kSpringsBuffer, "springs", "[I][springs]", "`SpringState`, 48 bytes", "world, units/s", "procedural",
     "procedural"},
    {io::kDestinationsBuffer, "destinations", "[I]", "float4", "world; w: whether there is one",
     "`set_destination`, the application", "steer"},
    {io::kAgentsBuffer, "agents", "[I]", "`AgentState`, 12 bytes", "units/s, 0..1", "steer", "steer"},
    {io::kSocketsBuffer, "sockets", "[I][sockets]", "affine, 48 bytes", "`model_from_joint` or `world_from_joint`",
     "fused, sockets", "your renderer, feedback"},
    {io::kSampledPosesBuffer, "sampled poses", "is `first poses` or `second poses`", "`JointPose`, 48 bytes",
     "`parent_from_joint`", "sample", "–"},
    {io::kFirstPosesBuffer, "first poses", "[I][J]", "`JointPose`, 48 bytes",
     "`parent_from_joint` as rotation, translation, scale", "sample", "blend"},
    {io::kSecondPosesBuffer, "second poses", "[I][J]", "`JointPose`, 48 bytes", "the same of the second clip", "sample",
     "blend"},
    {io::kLocalBuffer, "local", "[I][J]", "affine, 48 bytes; similarity, 32, for quaternion scans",
     "`parent_from_joint`", "blend, layered, procedural", "procedural, scan"},
    {io::kModelBuffer, "model", "[I][J]", "affine, 48 bytes", "`model_from_joint`", "scan, fused",
     "bind, sockets, `read_model_matrices`"},
    {io::kScratchBuffer, "scratch", "is `second poses`", "affine, 48 bytes", "the method's own", "scan", "scan"},
    {io::kSkinBuffer, "skin", "[I][P]", "affine, 48 bytes; half affine, 24; similarity, 32", "`model_from_bind`",
     "bind, fused, pace", "draw, skin, pace, your renderer"},
    {io::kPreviousSkinBuffer, "previous skin", "[I][P]", "as `skin`", "that of the update before",
     "take turns with `skin`", "pace, your renderer"},
    {io::kSkinAheadBuffer, "skin ahead", "[I][P]", "as `skin`",
     "`model_from_bind` of the pose that an instance goes on to", "fused", "pace"},
    {io::kSkinnedBuffer, "skinned", "[I][vertices]", "`SkinnedVertex`, 16 bytes",
     "model space; [skinning](skinning.md)", "skin", "draw, your renderer, `read_positions`"},
    {io::kStatesBuffer, "states", "[I]", "uint",
     "drawn and visible in the last update, updates left to the next pose, its set of joints", "cull, reveal",
     "the same; pace"},
    {io::kVerdictsBuffer, "verdicts", "[I]", "uint", "what is done with an instance", "cull, reveal", "list, skin"},
    {io::kCountsBuffer, "counts", "[workgroups][16]", "uint", "how many of each verdict, then where they begin",
     "cull, reveal, offsets", "offsets, list"},
    {io::kListBuffer, "list", "5, then [I]", "uint", "how many are drawn, where levels begin, instances",
     "offsets, list", "draw, skin, your renderer"},
    {io::kWorkBuffer, "work", "20, then [2 I]", "uint", "where sections begin, how many they have, instances",
     "offsets, list", "fused, pace"},
    {io::kDispatchesBuffer, "dispatches", "11", "`VkDispatchIndirectCommand`", "workgroups", "offsets",
     "fused, pace, skin"},
    {io::kDrawsBuffer, "draws", "[sections][4]", "`VkDrawIndexedIndirectCommand`", "instances", "offsets",
     "draw, your renderer"},
    {io::kEventsBuffer, "events", "[1 + capacity]", "`EventRecord`, 16 bytes", "instance, event, layer, s",
     "controller", "`feedback()`"},
    {io::kViewBuffer, "view", "1", "`CullView`, 208 bytes", "world space, pixels", "`record`", "cull, reveal"},
    {io::kAgentPlacesBuffer, "agent places", "all agents of the crowd", "`AgentPlace`, 16 bytes",
     "world; the next of its bucket", "places", "steer"},
    {io::kAgentBucketsBuffer, "agent buckets", "2 to 4 times as many", "uint", "the first agent of a bucket",
     "fill, places", "steer"},
    {io::kDepthsBuffer, "depths", "a picture, or a level", "float", "depth", "the application, pyramid", "pyramid"},
    {io::kCoarserDepthsBuffer, "coarser depths", "levels, down to one texel", "float", "depth, greater where nearer",
     "pyramid", "reveal"},
}};
static_assert(std::ranges::is_sorted(kInfos, {}, &BufferInfo::number) && kInfos.back().number == io::kBufferCount - 1);

}  // namespace

std::span<const BufferInfo> buffer_infos() { return kInfos; }
std::string_view name_of_buffer(uint32_t number) { return number < kInfos.size() ? kInfos[number].name : "unknown"; }

uint64_t Buffers::size_bytes() const {
    uint64_t sum = 0;
    for (const Buffer& buffer : buffers_) sum += buffer.size_bytes();
    return sum;
}

BufferTable& BufferTable::set(std::initializer_list<Entry> entries) {
    for (const Entry& entry : entries) ranges_.at(entry.number) = entry.range;
    return *this;
}

BufferTable& BufferTable::add(const Buffers& buffers) {
    for (uint32_t number = 0; number < io::kBufferCount; ++number)
        if (buffers.has(number)) ranges_[number] = buffers[number];
    return *this;
}

BufferTable& BufferTable::set_absent(const BufferRange& storage, const BufferRange& table) {
    absent_storage_ = storage;
    absent_table_ = table;
    return *this;
}

}  // namespace throng
