#include "native/gpu_rows.h"

#include "fused/rows_io.h"
#include "native/row_values.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace throng {
namespace {

using namespace native;

// Parts of the character's size, as in rows.cpp
constexpr double kGpuStill = 1e-7;
constexpr double kGpuFineError = 1e-6;    // half of what is allowed there: a further column costs little
constexpr double kFiner = 65536;          // steps of a finer word in one step of a word
constexpr double kMinStep = 1.0 / 16384;  // of a rotation's range: the least normal half float

// The smallest half float that is at least `value` and at least kMinStep, so that a range of this size holds all its
// values.
uint32_t half_up(double value) {
    uint32_t half = 0x0400;  // kMinStep
    for (uint32_t bit = 0x4000; bit >= 1; bit /= 2) {
        const uint32_t larger = half + bit;
        if (larger > 0x7BFF) continue;
        const double of_larger = std::ldexp(1 + (larger & 0x3FF) / 1024.0, static_cast<int>(larger >> 10) - 15);
        if (of_larger < value) half = larger;
    }
    return value <= kMinStep ? 0x0400 : half + 1;
}

double value_of_half(uint32_t half) {
    const double size = std::ldexp(1 + (half & 0x3FF) / 1024.0, static_cast<int>(half >> 10 & 0x1F) - 15);
    return (half >> 10 & 0x1F) == 0 ? 0 : half & 0x8000 ? -size : size;
}

// The nearest half float. Denormal ones become 0, since devices may take them for 0.
uint32_t nearest_half(double value) {
    const uint32_t sign = value < 0 ? 0x8000 : 0;
    if (std::abs(value) < kMinStep) return 0;
    const uint32_t above = half_up(std::abs(value));
    const uint32_t below = above > 0x0400 ? above - 1 : above;
    return sign | (value_of_half(above) - std::abs(value) < std::abs(value) - value_of_half(below) ? above : below);
}

// The range that words are fractions of.
struct WordRange {
    Four middle{}, half{};

    int64_t finest(const Four& value, size_t c) const {
        const double part = half[c] > 0 ? (value[c] - middle[c]) / half[c] : 0;
        return std::llround(std::clamp(part, -1.0, 1.0) * kMaxWord * kFiner);
    }
    // The largest error of any of these components.
    double error(size_t first, size_t end) const {
        double error = 0;
        for (size_t c = first; c < end; ++c) error = std::max(error, half[c] / kMaxWord / 2);
        return error;
    }
};

std::array<uint32_t, 2> packed(const std::array<int64_t, 4>& words) {
    const auto word = [&](size_t c) { return static_cast<uint32_t>(words[c]) & 0xFFFF; };
    return {word(0) | word(1) << 16, word(2) | word(3) << 16};
}

class GpuRowMaker {
public:
    GpuRowMaker(const Character& character, std::span<const RowJoint> joints, std::vector<ClipRowCursors> cursors)
        : character_(character), joints_(joints), values_(character, true, std::move(cursors)) {}

    std::optional<GpuRows> make(uint64_t max_bytes) {
        measure();
        if (uint64_t{values_.row_count()} * out_.column_count * sizeof out_.rows[0] > max_bytes) return std::nullopt;
        out_.rows.resize(values_.row_count() * out_.column_count);
        for (size_t j = 0; j < joints_.size(); ++j) write(static_cast<uint32_t>(j));
        write_places();
        return std::move(out_);
    }

private:
    struct Columns {
        uint32_t motion = kNoIndex, fine_rotation = kNoIndex;  // counted among their kind
        bool is_fine_motion = false;
    };

    void measure() {
        const double size = character_.size;
        for (const RowJoint& joint : joints_) {
            const JointValues values = values_.of(joint);
            const RowRange rotation = values_.range_of(values.rotation), motion = values_.range_of(values.motion);
            WordRange& turns = rotations_.emplace_back();
            for (size_t c = 0; c < 4; ++c) {
                turns.middle[c] = value_of_half(nearest_half(kMaxWord * rotation.middle[c])) / kMaxWord;
                turns.half[c] = value_of_half(
                    half_up(rotation.half[c] + std::abs(rotation.middle[c] - turns.middle[c])));
            }
            // The middle is rounded to a float first, since words are relative to that
            WordRange& moves = motions_.emplace_back();
            for (size_t c = 0; c < 4; ++c) {
                moves.middle[c] = static_cast<float>(motion.middle[c]);
                moves.half[c] = motion.half[c] * (1 + 1e-6) + std::abs(motion.middle[c] - moves.middle[c]);
            }
            Columns& columns = columns_.emplace_back();
            if (2 * turns.error(0, 4) * joint.reach > kGpuFineError * size)
                columns.fine_rotation = out_.fine_rotation_count++;
            const double most_moved = std::max({motion.half[0], motion.half[1], motion.half[2]});
            if (most_moved <= kGpuStill * size && motion.half[3] * joint.reach <= kGpuStill * size) continue;
            columns.motion = 0;
            columns.is_fine_motion = std::max(moves.error(0, 3), moves.error(3, 4) * joint.reach) >
                                     kGpuFineError * size;
        }
        // Numbers motions with a fine column first, so that a fine column has the same index as its motion
        for (const bool fine : {true, false})
            for (Columns& columns : columns_)
                if (columns.motion != kNoIndex && columns.is_fine_motion == fine) {
                    columns.motion = out_.motion_count++;
                    out_.fine_motion_count += fine ? 1 : 0;
                }
        out_.column_count = static_cast<uint32_t>(joints_.size()) + out_.fine_rotation_count + out_.motion_count +
                            out_.fine_motion_count;
        out_.joints.resize(joints_.size() * io::kRowJointRows + out_.motion_count);
    }

    void write(uint32_t joint) {
        const Columns& columns = columns_[joint];
        const JointValues values = values_.of(joints_[joint]);
        const auto joint_count = static_cast<uint32_t>(joints_.size());
        const uint32_t first_motion = joint_count + out_.fine_rotation_count;
        write_words(values.rotation, rotations_[joint], joint,
                    columns.fine_rotation == kNoIndex ? kNoIndex : joint_count + columns.fine_rotation);
        if (columns.motion != kNoIndex)
            write_words(values.motion, motions_[joint], first_motion + columns.motion,
                        columns.is_fine_motion ? first_motion + out_.motion_count + columns.motion : kNoIndex);
        write_joint(joint);
    }

    void write_words(std::span<const Four> values, const WordRange& range, uint32_t column, uint32_t fine_column) {
        for (size_t row = 0; row < values.size(); ++row) {
            std::array<int64_t, 4> words{}, finer{};
            for (size_t c = 0; c < 4; ++c) {
                const int64_t finest = range.finest(values[row], c);
                const auto least = static_cast<int64_t>(kFiner) / 2;
                words[c] = std::clamp<int64_t>((finest + least) >> 16, -32767, 32767);
                finer[c] = std::clamp<int64_t>(finest - words[c] * static_cast<int64_t>(kFiner), -least, least - 1);
            }
            std::array<uint32_t, 2>* at = out_.rows.data() + row * out_.column_count;
            at[column] = packed(words);
            if (fine_column != kNoIndex) at[fine_column] = packed(finer);
        }
    }

    void write_joint(uint32_t joint) {
        const Columns& columns = columns_[joint];
        const RowJoint& of = joints_[joint];
        const size_t joint_count = joints_.size();
        const auto row_at = [&](uint32_t kind) -> std::array<uint32_t, 4>& {
            return out_.joints[kind * joint_count + joint];
        };
        const auto bits = [](double value) { return std::bit_cast<uint32_t>(static_cast<float>(value)); };
        const auto halves = [](double a, double b) { return nearest_half(a) | nearest_half(b) << 16; };
        const Four &middle = rotations_[joint].middle, &half = rotations_[joint].half;
        row_at(io::kRowRange) = {halves(kMaxWord * middle[0], kMaxWord * middle[1]),
                                 halves(kMaxWord * middle[2], kMaxWord * middle[3]), halves(half[0], half[1]),
                                 halves(half[2], half[3])};
        const Four& centre = motions_[joint].middle;
        row_at(io::kRowCentre) = {bits(centre[0]), bits(centre[1]), bits(centre[2]), bits(centre[3])};
        const Vec3<double>& pivot = of.joint_space.translation;
        const auto column = [](uint32_t index) { return index == kNoIndex ? io::kNoColumn : index; };
        row_at(io::kRowPivot) = {bits(pivot.x), bits(pivot.y), bits(pivot.z),
                                 column(columns.motion) | column(columns.fine_rotation) << 16};
        const AffineT<float> space = to_affine(of.joint_space).as<float>();
        for (uint32_t r = 0; r < 3; ++r)
            row_at(io::kRowSpace + r) = {bits(space.row[r][0]), bits(space.row[r][1]), bits(space.row[r][2]),
                                         bits(space.row[r][3])};
        if (columns.motion == kNoIndex) return;
        const Four& step = motions_[joint].half;
        out_.joints[io::kRowJointRows * joint_count + columns.motion] = {
            bits(step[0] / kMaxWord), bits(step[1] / kMaxWord), bits(step[2] / kMaxWord), bits(step[3] / kMaxWord)};
    }

    void write_places() {
        const std::vector<ClipRowCursors>& cursors = values_.cursors();
        auto span_word = static_cast<uint32_t>(cursors.size() * io::kRowClipWords);
        std::vector<uint32_t> spans;
        for (size_t c = 0; c < cursors.size(); ++c) {
            const bool has_keys = c < character_.clips.size() && character_.clips[c].row_stride > 0;
            const float spans_a_key = has_keys ? 1.0f / static_cast<float>(character_.clips[c].row_stride) : 0;
            out_.places.insert(out_.places.end(), {has_keys ? character_.clips[c].first_row : 0,
                                                   std::bit_cast<uint32_t>(spans_a_key), span_word, 0});
            for (const RowSpan& span : cursors[c].spans) {
                spans.push_back(values_.first_row(c) + span.first_row);
                spans.push_back(std::bit_cast<uint32_t>(span.piece_count));
                span_word += io::kRowSpanWords;
            }
        }
        out_.places.insert(out_.places.end(), spans.begin(), spans.end());
    }

    GpuRows out_;
    const Character& character_;
    std::span<const RowJoint> joints_;
    RowValues values_;
    std::vector<WordRange> rotations_, motions_;  // [joint]
    std::vector<Columns> columns_;                // [joint]
};

}  // namespace

std::optional<GpuRows> make_gpu_rows(const Character& character, std::span<const native::RowJoint> joints,
                                     uint64_t max_bytes) {
    const uint64_t row_bytes = joints.size() * sizeof(GpuRows::rows[0]);  // of rotations alone
    std::optional<std::vector<ClipRowCursors>> cursors = row_cursors(character, joints,
                                                                     max_bytes / std::max<uint64_t>(row_bytes, 1));
    if (!cursors) return std::nullopt;
    return GpuRowMaker(character, joints, *std::move(cursors)).make(max_bytes);
}

}  // namespace throng
