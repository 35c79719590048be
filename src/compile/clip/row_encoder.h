// The rows of a clip as bits, and what they decode to.
#pragma once

#include "compile/clip/clip_meter.h"
#include "compile/clip/track_shape.h"

namespace throng {

// Keeps references.
class RowEncoder {
public:
    RowEncoder(const Character& character, const ClipGrid& grid, ClipMeter& meter);

    // Chooses the bits of every track. `shapes[joint_count][3]`, `tolerances[joint_count]`: displacements, see
    // plan_track().
    void plan(std::span<const TrackShape> shapes, std::span<const double> tolerances);

    // Writes these rows of the grid. Returns the largest displacement in them.
    double encode(std::span<const TrackShape> shapes, std::span<const size_t> rows);

    // [joint_count][3], in the order of TrackTarget
    const std::vector<PackedTrack>& tracks() const { return tracks_; }
    const std::vector<Trs<double>>& still() const { return still_; }     // [joint_count], of the tracks without bits
    const std::vector<ExactTrack>& decoded() const { return decoded_; }  // the grid's; those without bits have no keys
    const std::vector<uint32_t>& words() const { return words_; }        // [row][row_stride()]
    uint32_t row_stride() const { return row_stride_; }

private:
    Trs<double> aim(size_t joint, const Trs<double>& local, std::span<const AffineT<double>> wanted) const;
    Trs<double> encode_joint(std::span<const TrackShape> shapes, std::span<const size_t> rows, size_t row, size_t joint,
                             std::span<const AffineT<double>> wanted);
    bool moves(size_t slot) const { return bit_counts_[slot] > 0; }

    const Character& character_;
    const ClipGrid& grid_;
    ClipMeter& meter_;
    std::vector<size_t> track_of_;  // [joint_count][3], of the grid
    std::vector<PackedTrack> tracks_;
    std::vector<uint32_t> bit_counts_;  // [joint_count][3], of a row
    std::vector<Trs<double>> still_;
    std::vector<ExactTrack> decoded_;
    std::vector<uint32_t> words_;
    uint32_t row_stride_ = 0;
};

}  // namespace throng
