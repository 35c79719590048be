#include "native/native_rig.h"

#include "native/walk.h"
#include "sample/sample_reference.h"

#include <algorithm>

namespace throng {
namespace {

using native::Similarity;

constexpr size_t kSecondCache = 1 << 20;  // bytes, of most cores
// Parts of the character's size
constexpr double kSeen = 5e-7;    // below it a constant is the identity
constexpr double kUneven = 3e-6;  // below it the scales along x, y and z are one

// How far apart the scales of a joint along x, y and z are at most, as a part of the largest: files say 0.999999 for 1.
double unevenness(const Character& character, size_t joint) {
    double worst = 0;
    for (size_t clip = 0; clip <= character.clips.size(); ++clip) {
        const TrackReader scale(character, clip, joint, TrackTarget::kScale);
        for (uint32_t row = 0; row < scale.row_count(); ++row) {
            const TrackValue s = scale.at_row(row);
            const double most = std::max({s[0], s[1], s[2]}), least = std::min({s[0], s[1], s[2]});
            if (most != least) worst = std::max(worst, (most - least) / std::max(std::abs(most), std::abs(least)));
        }
    }
    return worst;
}

// Whether one scale a joint displaces nothing that could be seen; what joints do adds up from the root down.
bool has_uniform_scale(const Character& character, std::span<const double> reach) {
    std::vector<double> displaced(reach.size());
    for (size_t joint = 0; joint < reach.size(); ++joint) {
        const uint32_t parent = character.rig.parents[joint];
        displaced[joint] = (parent == kNone ? 0 : displaced[parent]) + unevenness(character, joint) * reach[joint];
        if (!(displaced[joint] <= kUneven * character.size)) return false;
    }
    return true;
}

Similarity rest_of(const Trs<float>& rest) {
    const Trs<double> trs = rest.as<double>();
    return {normalized(trs.rotation), trs.translation, trs.scale.x != 0 ? trs.scale.x : 1};
}

// model_from_joint of the rest pose, as far as that is a similarity.
std::vector<Similarity> rest_poses(const Rig& rig) {
    std::vector<Similarity> poses;
    for (size_t joint = 0; joint < rig.joint_count(); ++joint) {
        const Similarity local = rest_of(rig.rest[joint]);
        poses.push_back(rig.parents[joint] == kNone ? local : poses[rig.parents[joint]] * local);
    }
    return poses;
}

// B of each joint (native_rig.h).
std::vector<Similarity> joint_spaces(const Character& character, const std::vector<Similarity>& rest, bool is_uniform) {
    if (!is_uniform) return std::vector<Similarity>(rest.size());
    std::vector<Similarity> spaces = rest;
    std::vector<bool> is_bound(rest.size());
    for (const PaletteEntry& entry : character.palette) {
        if (is_bound[entry.joint]) continue;
        if (const auto s = native::similarity_of(entry.joint_from_bind.as<double>())) {
            spaces[entry.joint] = native::inverse(*s);
            is_bound[entry.joint] = true;
        }
    }
    // A joint that is small at rest may be large in a clip: divided by the small scale, its digits would be lost.
    for (size_t joint = 0; joint < spaces.size(); ++joint) {
        const uint32_t parent = character.rig.parents[joint];
        const double least = std::abs(parent == kNone ? 1 : spaces[parent].scale);
        if (!is_bound[joint] && std::abs(spaces[joint].scale) < least) spaces[joint].scale = least;
    }
    return spaces;
}

// How far from the joint what moves with it may be in any pose: the bones on the way, and the vertices at the end.
std::vector<double> reaches(const Character& character, const std::vector<Similarity>& rest) {
    std::vector<double> reach(rest.size(), 0.1 * character.size);  // where nothing hangs on it: an attachment
    for (const MeshSection& section : character.sections)
        for (uint32_t v = 0; v < section.vertex_count; ++v)
            for (uint32_t set = 0; set < section.influence_sets; ++set) {
                const Influences& of =
                    character.influences[section.first_influences + v * section.influence_sets + set];
                for (size_t k = 0; k < 4; ++k) {
                    if (!(of.weights[k] > 0)) continue;
                    const PaletteEntry& entry = character.palette[of.entries[k]];
                    const Vec3<double> at = transform_point(
                        entry.joint_from_bind.as<double>(),
                        character.vertices[section.first_vertex + v].position.as<double>());
                    double& reached = reach[entry.joint];
                    reached = std::max(reached, length(at) * std::abs(rest[entry.joint].scale));
                }
            }
    for (size_t joint = rest.size(); joint-- > 0;) {
        const uint32_t parent = character.rig.parents[joint];
        if (parent == kNone) continue;
        const double bone = length(rest[joint].translation - rest[parent].translation);
        reach[parent] = std::max(reach[parent], reach[joint] + bone);
    }
    return reach;
}

bool is_identity(const AffineT<double>& m, double size) {
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 4; ++c)
            if (!(std::abs(m.row[r][c] - (r == c ? 1 : 0)) * (c < 3 ? size : 1) <= kSeen * size)) return false;
    return true;
}

template <class T>
void put(float (&to)[3], const Vec3<T>& v) {
    to[0] = static_cast<float>(v.x);
    to[1] = static_cast<float>(v.y);
    to[2] = static_cast<float>(v.z);
}

}  // namespace

NativeRig::NativeRig(const Character& character, const NativeRigSettings& settings) {
    const Rig& rig = character.rig;
    const bool some_joints = settings.lod > 0 && !character.joint_lods.empty();
    std::vector<bool> moves(rig.joint_count(), true);
    for (size_t joint = 0; some_joints && joint < moves.size(); ++joint)
        moves[joint] = character.joint_lods[joint] >= settings.lod;
    const std::span<const PaletteEntry> palette = settings.sockets_only ? std::span<const PaletteEntry>()
                                                                        : character.palette;
    native::Walk walk = native::plan_walk({.parents = rig.parents,
                                           .moves = moves,
                                           .palette = palette,
                                           .keeps_model = settings.keeps_model && !settings.sockets_only,
                                           .sockets = settings.sockets});
    const std::vector<Similarity> rest = rest_poses(rig);
    const std::vector<double> reach = reaches(character, rest);
    // Poses from outside may have any scale
    const bool uniform_scale = !settings.all_move && has_uniform_scale(character, reach);
    const std::vector<Similarity> spaces = joint_spaces(character, rest, uniform_scale);
    for (const uint32_t joint : walk.joints)
        joints_.push_back({.joint = joint,
                           .parent_space = rig.parents[joint] == kNone ? Similarity{} : spaces[rig.parents[joint]],
                           .joint_space = spaces[joint],
                           .reach = reach[joint]});
    rows_ = native::make_rows(character, joints_, {.uniform_scale = uniform_scale, .all_move = settings.all_move});
    steps_ = std::move(walk.steps);
    for (size_t i = 0; i < steps_.size(); ++i) {
        const native::StillJoint& still = rows_.still[i];
        put(steps_[i].centre, still.centre);
        put(steps_[i].scale, still.scale);
        put(steps_[i].pivot, joints_[i].joint_space.translation);
        steps_[i].motion = still.motion;
        steps_[i].scales = still.scales;
    }
    emissions_ = std::move(walk.emissions);
    for (size_t i = 0; i < emissions_.size(); ++i) {
        native::Emission& emission = emissions_[i];
        const bool is_skin = emission.kind == native::EmissionKind::kSkin ||
                             emission.kind == native::EmissionKind::kSkinAt;
        AffineT<double> constant = native::to_affine(spaces[walk.emitted_joints[i]]);
        if (is_skin) constant = constant * character.palette[emission.target].joint_from_bind.as<double>();
        if (is_identity(constant, character.size)) continue;
        emission.constant = static_cast<uint32_t>(constants_.size() / 12);
        for (const auto& row : constant.as<float>().row) constants_.insert(constants_.end(), row.begin(), row.end());
    }
    joints_of_places_.assign(rows_.place_count(), kNone);
    for (size_t i = 0; i < joints_.size(); ++i) {
        const native::StillJoint& still = rows_.still[i];
        joints_of_places_[i] = joints_[i].joint;
        if (still.motion != native::kNoIndex) joints_of_places_[rows_.first_motion() + still.motion] = joints_[i].joint;
        if (still.scales != native::kNoIndex) joints_of_places_[rows_.first_scales() + still.scales] = joints_[i].joint;
    }
    kernel_ = {.rows = rows_.bytes.get(),
               .row_bytes = rows_.row_bytes,
               .prefetches = rows_.row_bytes * rows_.row_count > kSecondCache,
               .clips = rows_.clips.data(),
               .clip_from_track = 1.0 / rig.joint_count(),
               .blocks = rows_.blocks.data(),
               .ranges = reinterpret_cast<const float*>(rows_.ranges.get()),
               .joint_count = static_cast<uint32_t>(steps_.size()),
               .motion_count = rows_.motion_count,
               .scales_count = rows_.scales_count,
               .three_scales = !uniform_scale,
               .steps = steps_.data(),
               .emissions = emissions_.data(),
               .constants = constants_.data(),
               .slot_count = walk.slot_count,
               .place_count = rows_.place_count(),
               .mask_stride = rows_.place_count() + native::Rows::rounded_up(rows_.blocks.size()),
               .rig_joint_count = rig.joint_count(),
               .palette_count = static_cast<uint32_t>(palette.size()),
               .socket_count = static_cast<uint32_t>(settings.sockets.size())};
}

native::AlignedBytes NativeRig::masks_in_order(std::span<const float> masks) const {
    const size_t count = masks.size() / kernel_.rig_joint_count;
    native::AlignedBytes bytes = native::aligned_bytes(count * kernel_.mask_stride * sizeof(float));
    auto* ordered = reinterpret_cast<float*>(bytes.get());
    std::fill_n(ordered, count * kernel_.mask_stride, 0.0f);
    for (size_t mask = 0; mask < count; ++mask) {
        float* places = ordered + mask * kernel_.mask_stride;
        for (size_t place = 0; place < joints_of_places_.size(); ++place) {
            if (joints_of_places_[place] == kNone) continue;
            places[place] = masks[mask * kernel_.rig_joint_count + joints_of_places_[place]];
            float& of_block = places[kernel_.place_count + place / native::kBlockJoints];
            of_block = std::max(of_block, places[place]);
        }
    }
    return bytes;
}

void NativeRig::put_pose(std::span<const Trs<float>> parent_from_joint, std::span<float> pose) const {
    const auto put = [&](size_t place, const std::array<double, 4>& value) {
        float* at = pose.data() + place / native::kBlockJoints * 4 * native::kBlockJoints +
                    place % native::kBlockJoints;
        for (size_t c = 0; c < 4; ++c) at[c * native::kBlockJoints] = static_cast<float>(value[c]);
    };
    for (size_t place = 0; place < kernel_.place_count; ++place) put(place, {0, 0, 0, 1});  // what no joint has
    for (size_t i = 0; i < joints_.size(); ++i) {
        const Trs<double> local = parent_from_joint[joints_[i].joint].as<double>();
        const native::StillJoint& still = rows_.still[i];
        put(i, native::rotation_row(joints_[i], local.rotation));
        if (still.motion != native::kNoIndex)
            put(rows_.first_motion() + still.motion, native::motion_row(joints_[i], local, !kernel_.three_scales));
        if (still.scales != native::kNoIndex)
            put(rows_.first_scales() + still.scales, {local.scale.x, local.scale.y, local.scale.z, 1});
    }
}

uint64_t NativeRig::size_bytes() const {
    return rows_.size_bytes() + steps_.size() * sizeof(native::WalkStep) +
           emissions_.size() * sizeof(native::Emission) + constants_.size() * sizeof(float);
}

}  // namespace throng
