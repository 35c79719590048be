#include "native/row_values.h"

#include "sample/sample_reference.h"

#include <algorithm>
#include <cmath>

namespace throng::native {
namespace {

double dot(const Four& a, const Four& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

}  // namespace

RowValues::RowValues(const Character& character, bool uniform_scale, std::vector<ClipRowCursors> cursors)
    : character_(character), uniform_scale_(uniform_scale), cursors_(std::move(cursors)) {
    for (const ClipRowCursors& clip : cursors_) {
        first_rows_.push_back(static_cast<uint32_t>(row_count_));
        row_count_ += clip.rows.size();
    }
}

JointValues RowValues::of(const RowJoint& joint) const {
    const auto rotation_of = [&](const Quaternion<double>& q) { return rotation_row(joint, q); };
    const Four rest = rotation_of(character_.rig.rest[joint.joint].rotation.as<double>());
    JointValues values;
    for (size_t c = 0; c < cursors_.size(); ++c) {
        const auto reader = [&](TrackTarget target) { return TrackReader(character_, c, joint.joint, target); };
        const TrackReader rotation = reader(TrackTarget::kRotation), translation = reader(TrackTarget::kTranslation),
                          scale = reader(TrackTarget::kScale);
        const bool moves = translation.varies() || scale.varies(), turns = rotation.varies();
        const Four* before = &rest;
        bool is_first = true;
        for (const RowCursor& row : cursors_[c].rows) {
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
                values.motion.push_back(motion_row(joint, {.translation = t, .scale = s}, uniform_scale_));
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

RowRange RowValues::range_of(std::span<const Four> rows) const {
    Four low = rows[0], high = rows[0];
    RowRange range;
    for (size_t row = 0; row < rows.size(); ++row) {
        const bool begins = std::binary_search(first_rows_.begin(), first_rows_.end(), row);
        for (size_t c = 0; c < 4; ++c) {
            low[c] = std::min(low[c], rows[row][c]);
            high[c] = std::max(high[c], rows[row][c]);
            if (!begins)
                range.largest_step[c] = std::max(range.largest_step[c], std::abs(rows[row][c] - rows[row - 1][c]));
        }
    }
    for (size_t c = 0; c < 4; ++c) {
        range.middle[c] = (low[c] + high[c]) / 2;
        range.half[c] = (high[c] - low[c]) / 2;
    }
    return range;
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

}  // namespace throng::native
