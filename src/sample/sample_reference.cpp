#include "sample/sample_reference.h"

#include <algorithm>

namespace throng {
namespace {

using Key = std::array<float, 4>;

struct KeyPair {
    Key earlier, later;
};

KeyPair fetch(const Character& character, uint32_t track, uint32_t row_stride, const RowCursor& rows) {
    const uint32_t position = track & kTrackPosition;
    if (!(track & kTrackAnimated)) return {character.keys[position], character.keys[position]};
    const Key& earlier = character.keys[position + rows.earlier * row_stride];
    return {earlier, track & kTrackStep ? earlier : character.keys[position + rows.later * row_stride]};
}

Quaternion<double> quaternion(const Key& key) { return normalized(Quaternion<double>{key[0], key[1], key[2], key[3]}); }

Vec3<double> lerp_keys(const KeyPair& keys, double w) {
    return lerp(Vec3<double>{keys.earlier[0], keys.earlier[1], keys.earlier[2]}, {keys.later[0], keys.later[1], keys.later[2]}, w);
}

}  // namespace

Quaternion<double> slerp_reference(Quaternion<double> a, Quaternion<double> b, double w) {
    double cosine = dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    const double angle = std::acos(std::min(cosine, 1.0));
    double from = 1 - w, to = w;
    if (angle > 1e-6) {  // below, chord and arc agree to 1e-13
        from = std::sin((1 - w) * angle) / std::sin(angle);
        to = std::sin(w * angle) / std::sin(angle);
    }
    return normalized(Quaternion<double>{from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z, from * a.w + to * b.w});
}

std::vector<Trs<double>> sample_reference(const Character& character, uint32_t clip, double local_time_s) {
    const uint32_t joint_count = character.rig.joint_count();
    RowCursor rows;
    uint32_t row_stride = 0;
    if (clip < character.clips.size()) {
        const Clip& c = character.clips[clip];
        rows = find_rows_reference(std::span(character.times_s).subspan(c.first_time, c.row_count), local_time_s);
        row_stride = c.row_stride;
    }
    std::vector<Trs<double>> pose(joint_count);
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        const JointTracks& tracks = character.tracks[size_t{clip} * joint_count + joint];
        const KeyPair rotation = fetch(character, tracks.rotation, row_stride, rows);
        pose[joint].rotation = slerp_reference(quaternion(rotation.earlier), quaternion(rotation.later), rows.fraction);
        pose[joint].translation = lerp_keys(fetch(character, tracks.translation, row_stride, rows), rows.fraction);
        pose[joint].scale = lerp_keys(fetch(character, tracks.scale, row_stride, rows), rows.fraction);
    }
    return pose;
}

}  // namespace throng
