#include "native/row_spaces.h"

#include "sample/sample_reference.h"

#include <algorithm>

namespace throng::native {
namespace {

// Parts of the character's size
constexpr double kIdentityError = 5e-7;  // below it a matrix counts as the identity
constexpr double kUneven = 3e-6;         // below it scales count as uniform

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

// Whether using one scale a joint displaces nothing visibly; displacements add up from the root down.
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

// model_from_joint of the rest pose, as if all its scales were uniform.
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
    // A joint that is small at rest may be large in a clip. Dividing by its small scale would lose digits.
    for (size_t joint = 0; joint < spaces.size(); ++joint) {
        const uint32_t parent = character.rig.parents[joint];
        const double least = std::abs(parent == kNone ? 1 : spaces[parent].scale);
        if (!is_bound[joint] && std::abs(spaces[joint].scale) < least) spaces[joint].scale = least;
    }
    return spaces;
}

// How far from a joint anything that moves with it may be in any pose: the bones on the way, and the vertices at the
// end.
std::vector<double> reaches(const Character& character, const std::vector<Similarity>& rest) {
    std::vector<double> reach(rest.size(), 0.1 * character.size);  // at least: room for an attachment
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

}  // namespace

RowSpaces::RowSpaces(const Character& character, bool may_scale_unevenly) {
    const Rig& rig = character.rig;
    const std::vector<Similarity> rest = rest_poses(rig);
    const std::vector<double> reach = reaches(character, rest);
    uniform_scale = !may_scale_unevenly && has_uniform_scale(character, reach);
    const std::vector<Similarity> spaces = joint_spaces(character, rest, uniform_scale);
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        of_joints.push_back({.joint = joint,
                             .parent_space = rig.parents[joint] == kNone ? Similarity{} : spaces[rig.parents[joint]],
                             .joint_space = spaces[joint],
                             .reach = reach[joint]});
}

bool is_identity(const AffineT<double>& m, double size) {
    for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 4; ++c)
            if (!(std::abs(m.row[r][c] - (r == c ? 1 : 0)) * (c < 3 ? size : 1) <= kIdentityError * size)) return false;
    return true;
}

}  // namespace throng::native
