#include "fused/fixed_joints.h"

#include <bit>

namespace throng {
namespace {

bool is_animated(const Character& character, uint32_t track) {
    if (!character.packed) return (track & kTrackAnimated) != 0;
    return (std::bit_cast<uint32_t>(character.keys[track][3]) & kPackedBitsMask) != 0;
}

bool is_same(const Character& character, uint32_t a, uint32_t b) {
    const auto &p = character.keys[a & kTrackPosition], &q = character.keys[b & kTrackPosition];
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

}  // namespace

std::vector<bool> fixed_joints(const Character& character) {
    const size_t joint_count = character.rig.joint_count(), clip_count = character.clips.size();
    std::vector<bool> fixed(joint_count, true);
    for (size_t joint = 0; joint < joint_count; ++joint) {
        const JointTracks& rest = character.tracks[clip_count * joint_count + joint];
        for (size_t clip = 0; clip < clip_count && fixed[joint]; ++clip) {
            const JointTracks& tracks = character.tracks[clip * joint_count + joint];
            const auto stands = [&](uint32_t track, uint32_t rest_track) {
                return !is_animated(character, track) && is_same(character, track, rest_track);
            };
            fixed[joint] = stands(tracks.translation, rest.translation) && stands(tracks.scale, rest.scale);
        }
    }
    return fixed;
}

}  // namespace throng
