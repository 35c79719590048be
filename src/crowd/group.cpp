#include "crowd/group.h"

#include "control/control_io.h"
#include "sample/sample_io.h"
#include "skin/skin_io.h"

namespace throng {
namespace {

static_assert(io::kTrackAnimatedBit == kTrackAnimated && io::kTrackStepBit == kTrackStep && io::kTrackPositionMask == kTrackPosition);
static_assert(io::kScanNoJoint == kNone);
static_assert(sizeof(io::VertexRows) == sizeof(Vertex));

// One axis per clip, and the rest pose's: a single row at time 0.
std::vector<io::ClipAxis> clip_axes(const Character& character) {
    std::vector<io::ClipAxis> axes;
    for (const Clip& clip : character.clips) axes.push_back({clip.first_time, clip.row_count, clip.row_stride, clip.first_row, clip.duration_s});
    axes.push_back({.first_time = 0, .row_count = 1, .row_stride = 0, .first_row = 0, .duration_s = 0});
    return axes;
}

// A packed track is read as two rows, also where the second is left out: the last one too.
std::vector<std::array<float, 4>> readable_keys(const Character& character) {
    std::vector<std::array<float, 4>> keys = character.keys;
    if (character.packed) keys.emplace_back();
    return keys;
}

}  // namespace

Group::Group(const std::shared_ptr<Gpu>& gpu, const Character& character, const PathChoice& choice)
    : name(character.name),
      joint_count(character.rig.joint_count()),
      palette_count(static_cast<uint32_t>(character.palette.size())),
      vertex_count(static_cast<uint32_t>(character.vertices.size())),
      sections(character.sections),
      materials(character.materials),
      images(character.images),
      bounds_min(character.bounds_min),
      bounds_max(character.bounds_max),
      packed(character.packed),
      scan_choice(choice.scan),
      scan_reason(choice.scan_reason),
      path_reason(choice.path_reason) {
    if (choice.fused) fused.emplace(FusedGroup{*choice.fused, FusedTables(gpu, character, *choice.fused)});
    else scan.emplace(gpu, scan_choice, ScanRig(character.rig.parents, character.rig.uniform_scale), scan_limits(*gpu));
    std::vector<uint32_t> joints;
    std::vector<Affine> binds;
    for (const PaletteEntry& entry : character.palette) {
        joints.push_back(entry.joint);
        binds.push_back(entry.joint_from_bind);
    }
    for (const Clip& clip : character.clips) clip_durations_s.push_back(clip.duration_s);
    axes = upload(gpu, name + ": clip axes", clip_axes(character));
    times = upload(gpu, name + ": key times", character.times_s);
    tracks = upload_table(gpu, name + ": tracks", character.tracks);
    keys = upload_table(gpu, name + ": keys", readable_keys(character));
    words = upload_table(gpu, name + ": key words", character.words);
    palette_joints = upload_table(gpu, name + ": palette joints", joints);
    joint_from_bind = upload_table(gpu, name + ": inverse binds", binds);
    vertices = upload(gpu, name + ": vertices", character.vertices);
    influences = upload(gpu, name + ": influences", character.influences);
    indices = upload(gpu, name + ": indices", character.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
}

uint64_t Group::size_bytes() const {
    uint64_t sum = fused ? fused->tables.size_bytes() : scan->links().size_bytes();
    for (const Buffer* buffer : {&axes, &times, &tracks, &keys, &words, &palette_joints, &joint_from_bind, &vertices, &influences, &indices})
        sum += buffer->size_bytes();
    return sum;
}

}  // namespace throng
