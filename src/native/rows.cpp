#include "native/rows.h"

#include "base/failure.h"

#include "native/row_times.h"
#include "sample/sample_reference.h"

#include <algorithm>
#include <cstring>

namespace throng::native {
namespace {

using Four = std::array<double, 4>;

constexpr double kStill = 1e-7;      // parts of the character's size below which nothing moves
constexpr double kSeen = 2e-6;       // and above which a joint's words are floats
constexpr double kMost = 32767;      // of a word
constexpr double kPart = 1 / kMost;  // a fraction between two rows is off by half of it

// What a joint has in all rows of all clips: as it lies in rotations, motions and three scales.
struct JointValues {
    std::vector<Four> rotation, motion, scales;
};

struct Range {
    Four middle{}, half{};
    double largest_step = 0;  // from one row to the next

    // How far a component is off at most.
    double error() const {
        const double half_most = *std::max_element(half.begin(), half.end());
        return half_most / kMost / 2 + largest_step * kPart / 2;
    }
};

Range range_of(std::span<const Four> rows, std::span<const uint32_t> first_rows) {
    Four low = rows[0], high = rows[0];
    Range range;
    for (size_t row = 0; row < rows.size(); ++row) {
        const bool begins = std::binary_search(first_rows.begin(), first_rows.end(), row);
        for (size_t c = 0; c < 4; ++c) {
            low[c] = std::min(low[c], rows[row][c]);
            high[c] = std::max(high[c], rows[row][c]);
            if (!begins) range.largest_step = std::max(range.largest_step, std::abs(rows[row][c] - rows[row - 1][c]));
        }
    }
    for (size_t c = 0; c < 4; ++c) {
        range.middle[c] = (low[c] + high[c]) / 2;
        range.half[c] = (high[c] - low[c]) / 2;
    }
    return range;
}

double dot(const Four& a, const Four& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

class RowMaker {
public:
    RowMaker(const Character& character, std::span<const RowJoint> joints, const RowSettings& settings)
        : character_(character), joints_(joints), settings_(settings), times_(row_times(character, joints)) {
        for (const ClipRowTimes& clip : times_) {
            first_rows_.push_back(static_cast<uint32_t>(rows_.row_count));
            rows_.row_count += clip.rows.size();
            check_size(rows_.row_count * Rows::rounded_up(joints.size()) * 4 * sizeof(int16_t));  // of rotations alone
        }
    }

    Rows make() {
        add_clips();
        measure();
        lay_out();
        for (size_t j = 0; j < joints_.size(); ++j) {
            const JointValues values = values_of(joints_[j]);
            write(values.rotation, static_cast<uint32_t>(j));
            const StillJoint& still = rows_.still[j];
            if (still.motion != kNoIndex) write(values.motion, rows_.first_motion() + still.motion);
            if (still.scales != kNoIndex) write(values.scales, rows_.first_scales() + still.scales);
        }
        return std::move(rows_);
    }

private:
    void check_size(size_t size_bytes) const {
        constexpr size_t kLimit_bytes = size_t{1} << 30;
        if (size_bytes > kLimit_bytes)
            throw Failure(ErrorCode::kLimit, character_.name + ": native update",
                          "more than " + std::to_string(kLimit_bytes >> 20) +
                              " MiB of rows of its clips: UpdatePath::kStaged does without");
    }

    void add_clips() {
        size_t span_count = 0;
        for (const ClipRowTimes& clip : times_) span_count += clip.spans.size();
        rows_.spans.reserve(span_count);
        for (size_t c = 0; c < times_.size(); ++c) {
            rows_.clips.push_back({.spans = rows_.spans.data() + rows_.spans.size()});
            if (c < character_.clips.size() && character_.clips[c].row_stride > 0) {
                rows_.clips.back().first_key = character_.clips[c].first_row;
                rows_.clips.back().span_from_key = 1.0 / character_.clips[c].row_stride;
            }
            for (RowSpan span : times_[c].spans) {
                span.first_row += first_rows_[c];
                rows_.spans.push_back(span);
            }
        }
    }

    JointValues values_of(const RowJoint& joint) const {
        const auto rotation_of = [&](const Quaternion<double>& q) { return rotation_row(joint, q); };
        const Four rest = rotation_of(character_.rig.rest[joint.joint].rotation.as<double>());
        JointValues values;
        for (size_t c = 0; c < times_.size(); ++c) {
            const auto reader = [&](TrackTarget target) { return TrackReader(character_, c, joint.joint, target); };
            const TrackReader rotation = reader(TrackTarget::kRotation),
                              translation = reader(TrackTarget::kTranslation), scale = reader(TrackTarget::kScale);
            const bool moves = translation.varies() || scale.varies(), turns = rotation.varies();
            const Four* before = &rest;
            bool is_first = true;
            for (const RowCursor& row : times_[c].rows) {
                if (is_first || turns) {
                    Four q = rotation_of(quaternion_of(rotation.between(row)));
                    if (dot(q, *before) < 0)
                        for (double& component : q) component = -component;
                    values.rotation.push_back(q);
                } else {
                    values.rotation.push_back(Four(values.rotation.back()));
                }
                if (is_first || moves) {
                    const Vec3<double> s = vector_of(scale.between(row)), t = vector_of(translation.between(row));
                    values.motion.push_back(motion_row(joint, {.translation = t, .scale = s}, settings_.uniform_scale));
                    values.scales.push_back({s.x, s.y, s.z, 1});
                } else {
                    values.motion.push_back(Four(values.motion.back()));
                    values.scales.push_back(Four(values.scales.back()));
                }
                before = &values.rotation.back();
                is_first = false;
            }
        }
        return values;
    }

    // Which joints only turn, the range of each, and whether it must be floats.
    void measure() {
        const double size = character_.size;
        std::vector<Range> rotations, motions, scales;
        std::vector<bool> fine_rotations, fine_motions, fine_scales;
        for (const RowJoint& joint : joints_) {
            const JointValues values = values_of(joint);
            const Range rotation = range_of(values.rotation, first_rows_),
                        motion = range_of(values.motion, first_rows_), three = range_of(values.scales, first_rows_);
            rotations.push_back(rotation);
            fine_rotations.push_back(2 * rotation.error() * joint.reach > kSeen * size);
            StillJoint still{.centre = {motion.middle[0], motion.middle[1], motion.middle[2]}};
            const bool uniform = settings_.uniform_scale;
            still.scale = uniform ? Vec3<double>{motion.middle[3], motion.middle[3], motion.middle[3]}
                                  : Vec3<double>{three.middle[0], three.middle[1], three.middle[2]};
            const auto most = [](const Range& range, size_t first, size_t end) {
                return *std::max_element(range.half.begin() + static_cast<ptrdiff_t>(first),
                                         range.half.begin() + static_cast<ptrdiff_t>(end));
            };
            if (settings_.all_move || most(motion, 0, 3) > kStill * size ||
                most(motion, 3, 4) * joint.reach > kStill * size) {
                still.motion = rows_.motion_count++;
                motions.push_back(motion);
                fine_motions.push_back(motion.error() * std::max(1.0, joint.reach / size) > kSeen * size);
            }
            if (!uniform && (settings_.all_move || most(three, 0, 3) * joint.reach > kStill * size)) {
                still.scales = rows_.scales_count++;
                scales.push_back(three);
                fine_scales.push_back(three.error() * joint.reach > kSeen * size);
            }
            rows_.still.push_back(still);
        }
        const auto add = [&](std::vector<Range>& ranges, std::vector<bool>& fine, const Four& filler) {
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
                at[4 * kBlockJoints] = static_cast<float>(ranges_[place].half[c] / kMost / kMost);
            }
        const size_t size = rows_.row_bytes * rows_.row_count;
        check_size(size);
        rows_.bytes = aligned_bytes(size);
        std::memset(rows_.bytes.get(), 0, size);
        // What no joint has turns nothing: words of 0 are the middle
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
                const Range& range = ranges_[place];
                const double part = range.half[c] > 0 ? (value[c] - range.middle[c]) / range.half[c] : 0;
                const auto word = static_cast<int16_t>(std::lround(std::clamp(part, -1.0, 1.0) * kMost));
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
    std::vector<ClipRowTimes> times_;
    std::vector<uint32_t> first_rows_;  // of clips
    std::vector<Range> ranges_;         // [place]
    std::vector<bool> is_fine_;
    Rows rows_;
};

}  // namespace

uint64_t Rows::size_bytes() const {
    return row_bytes * row_count + spans.size() * sizeof(RowSpan) + clips.size() * sizeof(RowClip) +
           blocks.size() * (sizeof(RowBlock) + 8 * kBlockJoints * sizeof(float));
}

std::array<double, 4> rotation_row(const RowJoint& joint, const Quaternion<double>& rotation) {
    const Quaternion<double>& j = joint.joint_space.rotation;
    const Quaternion<double> back{-j.x, -j.y, -j.z, j.w};
    return value_of(normalized(joint.parent_space.rotation * normalized(rotation) * back));
}

std::array<double, 4> motion_row(const RowJoint& joint, const Trs<double>& parent_from_joint, bool uniform_scale) {
    const Similarity& p = joint.parent_space;
    const Vec3<double>& s = parent_from_joint.scale;
    const Vec3<double> centre = rotated(p.rotation, parent_from_joint.translation) * p.scale + p.translation;
    return {centre.x, centre.y, centre.z,
            uniform_scale ? p.scale * (s.x + s.y + s.z) / 3 / joint.joint_space.scale : 1};
}

Rows make_rows(const Character& character, std::span<const RowJoint> joints, const RowSettings& settings) {
    return RowMaker(character, joints, settings).make();
}

}  // namespace throng::native
