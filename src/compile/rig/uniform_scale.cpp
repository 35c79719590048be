#include "compile/rig/uniform_scale.h"

#include "sample/sample_reference.h"

namespace throng {
namespace {

bool is_same(const auto& xyz) { return xyz[0] == xyz[1] && xyz[0] == xyz[2]; }

// Checks the header, which all rows of a packed track share.
bool has_uniform_header(const PackedTrack& track) {
    return is_same(track.minimum) && is_same(track.step) && packed_bit_count(track, 0) == packed_bit_count(track, 1) &&
           packed_bit_count(track, 0) == packed_bit_count(track, 2);
}

}  // namespace

bool has_uniform_scale(const Character& character) {
    const size_t joint_count = character.rig.joint_count();
    for (size_t index = 0; index < character.tracks.size(); ++index) {
        const TrackReader track(character, index / joint_count, index % joint_count, TrackTarget::kScale);
        if (character.packed && !has_uniform_header(track.packed())) return false;
        for (uint32_t row = 0; row < track.row_count(); ++row)
            if (!is_same(track.at_row(row))) return false;
    }
    return true;
}

}  // namespace throng
