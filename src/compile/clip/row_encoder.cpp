#include "compile/clip/row_encoder.h"

#include "base/affine.h"
#include "compile/clip/packed_track.h"

#include <algorithm>

namespace throng {
RowEncoder::RowEncoder(const Character& character, const ClipGrid& grid, ClipMeter& meter)
    : character_(character),
      grid_(grid),
      meter_(meter),
      track_of_(grid.still.size() * 3),
      tracks_(track_of_.size()),
      bit_counts_(track_of_.size()) {
    for (size_t number = 0; number < grid.tracks.size(); ++number) {
        const ExactTrack& track = grid.tracks[number];
        track_of_[slot_of(track)] = number;
        decoded_.push_back({track.joint, track.target, track.step});
    }
}

void RowEncoder::plan(std::span<const TrackShape> shapes, std::span<const double> tolerances) {
    uint32_t bit = 0;
    still_ = grid_.still;
    for (size_t slot = 0; slot < tracks_.size(); ++slot) {
        PackedTrack& track = tracks_[slot] = plan_track(shapes[slot], tolerances[slot / 3]);
        bit_counts_[slot] = packed_row_bits(track);
        if (moves(slot)) {
            track.first_bit = bit;
            bit += bit_counts_[slot];
        } else {
            set_component(still_[slot / 3], shapes[slot].target, packed_value(track, shapes[slot].target, {}));
        }
    }
    for (Trs<double>& joint : still_) joint.rotation = normalized(joint.rotation);
    row_stride_ = (bit + 31) / 32;
}

double RowEncoder::encode(std::span<const TrackShape> shapes, std::span<const size_t> rows) {
    words_.assign(rows.size() * row_stride_, 0);
    for (ExactTrack& track : decoded_) track.keys.resize(moves(slot_of(track)) ? rows.size() : 0);
    double largest = 0;
    for (size_t row = 0; row < rows.size(); ++row) {
        const std::span<const AffineT<double>> wanted = meter_.exact(rows[row] * grid_.points_per_row);
        for (size_t joint = 0; joint < still_.size(); ++joint)
            largest = std::max(largest, meter_.place(joint, encode_joint(shapes, rows, row, joint, wanted), wanted));
    }
    return largest;
}

Trs<double> RowEncoder::encode_joint(std::span<const TrackShape> shapes, std::span<const size_t> rows, size_t row,
                                     size_t joint, std::span<const AffineT<double>> wanted) {
    Trs<double> packed = still_[joint];
    const size_t first = joint * 3;
    if (!moves(first) && !moves(first + 1) && !moves(first + 2)) return packed;
    Trs<double> local = packed;
    for (size_t slot = first; slot < first + 3; ++slot)
        if (moves(slot)) set_component(local, shapes[slot].target, grid_.tracks[track_of_[slot]].at_row(rows[row]));
    const Trs<double> aimed = aim(joint, local, wanted);
    for (size_t slot = first; slot < first + 3; ++slot) {
        if (!moves(slot)) continue;
        const TrackTarget target = shapes[slot].target;
        // A STEP track holds its value until the next key, so it must not make up for the errors of a parent that moves
        TrackValue value = component(shapes[slot].step ? local : aimed, target);
        if (target == TrackTarget::kRotation && !shapes[slot].full && value[shapes[slot].left_out] < 0)
            for (double& v : value) v = -v;
        const PackedBits bits = quantised(tracks_[slot], target, value);
        write_row(words_, row * row_stride_ * 32, tracks_[slot], bits);
        const TrackValue got = packed_value(tracks_[slot], target, bits);
        decoded_[track_of_[slot]].keys[row] = key_of(got);
        set_component(packed, target, got);
    }
    packed.rotation = normalized(packed.rotation);
    return packed;
}

// The local transform that puts the joint at its exact place in model space although its packed parent is not at its
// own, so that errors do not add up along a chain. The rotation makes up for the error of the parent's rotation, the
// translation for the error of its place.
Trs<double> RowEncoder::aim(size_t joint, const Trs<double>& local, std::span<const AffineT<double>> wanted) const {
    const uint32_t parent = character_.rig.parents[joint];
    if (parent == kNone) return local;
    const std::optional<AffineT<double>> parent_from_model = inverse(meter_.model_from_joint(parent));
    if (!parent_from_model) return local;
    const auto& packed = meter_.model_from_joint(parent).row;
    const auto seen = [&](size_t column) {  // the exact parent from the packed one: nearly the identity
        const auto& exact = wanted[parent].row;
        return transform_vector(*parent_from_model, Vec3<double>{exact[0][column], exact[1][column], exact[2][column]});
    };
    const auto& place = wanted[joint].row;
    Trs<double> aimed = local;
    aimed.translation = transform_vector(
        *parent_from_model,
        Vec3<double>{place[0][3] - packed[0][3], place[1][3] - packed[1][3], place[2][3] - packed[2][3]});
    const Vec3<double> x = seen(0), y = seen(1), z = seen(2);
    const double trace = x.x + y.y + z.z;
    constexpr double kNearIdentity = 2;  // of a trace of 3
    if (trace > kNearIdentity)
        aimed.rotation = normalized(normalized(Quaternion<double>{y.z - z.y, z.x - x.z, x.y - y.x, 4 * trace / 3}) *
                                    local.rotation);
    return aimed;
}

}  // namespace throng
