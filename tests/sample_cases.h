// Cursors into clips, and how far a pose is off.
#pragma once

#include "control/control_reference.h"
#include "sample/sample_io.h"
#include "tests/test_rig.h"

#include <algorithm>
#include <cmath>

namespace throng::test {

// The cursor that the control stage gives for this time. The fraction is rounded to float there, so the reference's
// fraction is too.
inline io::SlotCursor cursor_at(const Character& character, uint32_t clip, double time_s) {
    io::SlotCursor cursor{.first_track = clip * character.rig.joint_count(), .earlier = 0, .later = 0, .fraction = 0};
    if (clip == character.clips.size()) return cursor;
    const Clip& c = character.clips[clip];
    const RowCursor rows = find_rows_reference(std::span(character.times_s).subspan(c.first_time, c.row_count), time_s);
    cursor.earlier = c.first_row + rows.earlier * c.row_stride;
    cursor.later = c.first_row + rows.later * c.row_stride;
    cursor.fraction = static_cast<float>(rows.fraction);
    return cursor;
}

inline double component_error(double got, double wanted) {
    const double error = std::abs(got - wanted) / std::max(1.0, std::abs(wanted));
    return std::isnan(error) ? 1e9 : error;
}

// q and -q are one rotation.
inline double pose_error(const io::JointPose& got, const Trs<double>& wanted) {
    const Quaternion<double> q{got.rotation.x, got.rotation.y, got.rotation.z, got.rotation.w};
    const Quaternion<double> w = dot(q, wanted.rotation) < 0 ? -wanted.rotation : wanted.rotation;
    return std::max({component_error(q.x, w.x), component_error(q.y, w.y), component_error(q.z, w.z),
                     component_error(q.w, w.w), component_error(got.translation.x, wanted.translation.x),
                     component_error(got.translation.y, wanted.translation.y),
                     component_error(got.translation.z, wanted.translation.z),
                     component_error(got.scale.x, wanted.scale.x), component_error(got.scale.y, wanted.scale.y),
                     component_error(got.scale.z, wanted.scale.z)});
}

}  // namespace throng::test
