#include "native/rows.h"

#include "base/failure.h"

#include "native/row_values.h"

#include <algorithm>
#include <cstring>

namespace throng::native {
namespace {

constexpr double kStill = 1e-7;         // of the character's size; less counts as no movement
constexpr double kFineError = 2e-6;     // of the character's size; above it, a joint gets floats
constexpr double kPart = 1 / kMaxWord;  // step of a fraction between 16-bit rows, which is off by at most half of it

constexpr size_t kLimit_bytes = size_t{1} << 30;  // of rows

[[noreturn]] void refuse_rows(const Character& character) {
    throw Failure(ErrorCode::kLimit, character.name + ": native update",
                  "its clips need more than the limit of " + std::to_string(kLimit_bytes >> 20) +
                      " MiB of rows; UpdatePath::kStaged needs none");
}

// How many rows fit into the limit with the rotations of this number of joints.
uint64_t row_limit(size_t joint_count) {
    return kLimit_bytes / (std::max(Rows::rounded_up(joint_count), kBlockJoints) * 4 * sizeof(int16_t));
}

std::vector<ClipRowCursors> checked_cursors(const Character& character, std::span<const RowJoint> joints) {
    std::optional<std::vector<ClipRowCursors>> cursors = row_cursors(character, joints, row_limit(joints.size()));
    if (!cursors) refuse_rows(character);
    return *std::move(cursors);
}

// The largest error of any of these components.
double error_of(const RowRange& range, size_t first, size_t end) {
    double error = 0;
    for (size_t c = first; c < end; ++c)
        error = std::max(error, range.half[c] / kMaxWord / 2 + range.largest_step[c] * kPart / 2);
    return error;
}

class RowMaker {
public:
    RowMaker(const Character& character, std::span<const RowJoint> joints, const RowSettings& settings)
        : character_(character),
          joints_(joints),
          settings_(settings),
          values_(character, settings.uniform_scale, checked_cursors(character, joints)) {
        rows_.row_count = values_.row_count();
    }

    Rows make() {
        add_clips();
        measure();
        lay_out();
        for (size_t j = 0; j < joints_.size(); ++j) {
            const JointValues values = values_.of(joints_[j]);
            write(values.rotation, static_cast<uint32_t>(j));
            const JointLayout& layout = rows_.layouts[j];
            if (layout.motion != kNoIndex) write(values.motion, rows_.first_motion() + layout.motion);
            if (layout.scales != kNoIndex) write(values.scales, rows_.first_scales() + layout.scales);
        }
        return std::move(rows_);
    }

private:
    void add_clips() {
        size_t span_count = 0;
        for (const ClipRowCursors& clip : values_.cursors()) span_count += clip.spans.size();
        rows_.spans.reserve(span_count);
        for (size_t c = 0; c < values_.cursors().size(); ++c) {
            rows_.clips.push_back({.spans = rows_.spans.data() + rows_.spans.size()});
            if (c < character_.clips.size() && character_.clips[c].row_stride > 0) {
                rows_.clips.back().first_key = character_.clips[c].first_row;
                rows_.clips.back().span_from_key = 1.0 / character_.clips[c].row_stride;
            }
            for (RowSpan span : values_.cursors()[c].spans) {
                span.first_row += values_.first_row(c);
                rows_.spans.push_back(span);
            }
        }
    }

    // Finds which joints only turn, the range of each, and whether it must be floats.
    void measure() {
        const double size = character_.size;
        std::vector<RowRange> rotations, motions, scales;
        std::vector<bool> fine_rotations, fine_motions, fine_scales;
        for (const RowJoint& joint : joints_) {
            const JointValues values = values_.of(joint);
            const RowRange rotation = values_.range_of(values.rotation), motion = values_.range_of(values.motion),
                           three = values_.range_of(values.scales);
            rotations.push_back(rotation);
            fine_rotations.push_back(2 * error_of(rotation, 0, 4) * joint.reach > kFineError * size);
            JointLayout layout{.centre = {motion.middle[0], motion.middle[1], motion.middle[2]}};
            const bool uniform = settings_.uniform_scale;
            layout.scale = uniform ? Vec3<double>{motion.middle[3], motion.middle[3], motion.middle[3]}
                                   : Vec3<double>{three.middle[0], three.middle[1], three.middle[2]};
            const auto most = [](const RowRange& range, size_t first, size_t end) {
                return *std::max_element(range.half.begin() + static_cast<ptrdiff_t>(first),
                                         range.half.begin() + static_cast<ptrdiff_t>(end));
            };
            if (settings_.all_move || most(motion, 0, 3) > kStill * size ||
                most(motion, 3, 4) * joint.reach > kStill * size) {
                layout.motion = rows_.motion_count++;
                motions.push_back(motion);
                fine_motions.push_back(std::max(error_of(motion, 0, 3), error_of(motion, 3, 4) * joint.reach) >
                                       kFineError * size);
            }
            if (!uniform && (settings_.all_move || most(three, 0, 3) * joint.reach > kStill * size)) {
                layout.scales = rows_.scales_count++;
                scales.push_back(three);
                fine_scales.push_back(error_of(three, 0, 3) * joint.reach > kFineError * size);
            }
            rows_.layouts.push_back(layout);
        }
        const auto add = [&](std::vector<RowRange>& ranges, std::vector<bool>& fine, const Four& filler) {
            ranges.resize(Rows::rounded_up(ranges.size()), {.middle = filler, .half = {}});
            fine.resize(ranges.size());
            ranges_.insert(ranges_.end(), ranges.begin(), ranges.end());
            is_fine_.insert(is_fine_.end(), fine.begin(), fine.end());
        };
        add(rotations, fine_rotations, {0, 0, 0, 1});
        add(motions, fine_motions, {0, 0, 0, 1});
        add(scales, fine_scales, {1, 1, 1, 1});
    }

    void lay_out() {
        for (uint32_t place = 0; place < rows_.place_count(); place += kBlockJoints) {
            const auto begin = is_fine_.begin() + place;
            const bool is_float = std::find(begin, begin + kBlockJoints, true) != begin + kBlockJoints;
            rows_.blocks.push_back({static_cast<uint32_t>(rows_.row_bytes), is_float});
            rows_.row_bytes += kBlockJoints * 4 * (is_float ? sizeof(float) : sizeof(int16_t));
        }
        rows_.ranges = aligned_bytes(size_t{rows_.place_count()} * 8 * sizeof(float));
        auto* ranges = reinterpret_cast<float*>(rows_.ranges.get());
        for (uint32_t place = 0; place < rows_.place_count(); ++place)
            for (uint32_t c = 0; c < 4; ++c) {
                float* at = ranges + (place / kBlockJoints * 8 + c) * kBlockJoints + place % kBlockJoints;
                *at = static_cast<float>(ranges_[place].middle[c]);
                at[4 * kBlockJoints] = static_cast<float>(ranges_[place].half[c] / kMaxWord / kMaxWord);
            }
        const size_t size = rows_.row_bytes * rows_.row_count;
        if (size > kLimit_bytes) refuse_rows(character_);
        rows_.bytes = aligned_bytes(size);
        std::memset(rows_.bytes.get(), 0, size);
        // Places without a joint hold the identity: words of 0 are the middle of a range
        for (uint32_t place = 0; place < rows_.place_count(); ++place)
            for (size_t row = 0; rows_.blocks[place / kBlockJoints].is_float && row < rows_.row_count; ++row)
                put(row, place, ranges_[place].middle);
    }

    void put(size_t row, uint32_t place, const Four& value) {
        const RowBlock& block = rows_.blocks[place / kBlockJoints];
        std::byte* at = rows_.bytes.get() + row * rows_.row_bytes + block.offset;
        const uint32_t lane = place % kBlockJoints;
        for (uint32_t c = 0; c < 4; ++c) {
            if (block.is_float) {
                const auto number = static_cast<float>(value[c]);
                std::memcpy(at + (c * kBlockJoints + lane) * sizeof number, &number, sizeof number);
            } else {
                const RowRange& range = ranges_[place];
                const double part = range.half[c] > 0 ? (value[c] - range.middle[c]) / range.half[c] : 0;
                const auto word = static_cast<int16_t>(std::lround(std::clamp(part, -1.0, 1.0) * kMaxWord));
                std::memcpy(at + (c / 2 * 32 + lane / 4 * 8 + c % 2 * 4 + lane % 4) * sizeof word, &word, sizeof word);
            }
        }
    }

    void write(std::span<const Four> values, uint32_t place) {
        for (size_t row = 0; row < values.size(); ++row) put(row, place, values[row]);
    }

    const Character& character_;
    std::span<const RowJoint> joints_;
    RowSettings settings_;
    RowValues values_;
    std::vector<RowRange> ranges_;  // [place]
    std::vector<bool> is_fine_;
    Rows rows_;
};

}  // namespace

uint64_t Rows::size_bytes() const {
    return row_bytes * row_count + spans.size() * sizeof(RowSpan) + clips.size() * sizeof(RowClip) +
           blocks.size() * (sizeof(RowBlock) + 8 * kBlockJoints * sizeof(float));
}

void check_key_rows(const Character& character, size_t joint_count) {
    uint64_t row_count = 1;  // of the rest pose
    for (const Clip& clip : character.clips) row_count += clip.row_count;
    if (row_count > row_limit(joint_count)) refuse_rows(character);
}

Rows make_rows(const Character& character, std::span<const RowJoint> joints, const RowSettings& settings) {
    return RowMaker(character, joints, settings).make();
}

}  // namespace throng::native
