// The definition of inertial transitions.
#pragma once

#include <throng/transform.h>

namespace throng {

// A quintic that starts at offset x >= 0 with speed v <= 0, and reaches 0 with speed and acceleration 0 after
// `duration_s`, or earlier if it would otherwise overshoot.
double decayed_reference(double x, double v, double elapsed_s, double duration_s);

// Each offset is a length along a direction. `speed` is the rate at which the length changes, at most 0.
struct ReferenceInertia {
    struct Offset {
        Vec3<double> direction;
        double size = 0, speed = 0;
    };
    Offset rotation;  // axis, radians; from the target's rotation to the one shown, in parent space
    Offset translation, scale;
};

// The last two poses shown and the target's poses at the same two times, `time_step_s` apart. If `target_before` equals
// `target`, as in ReferenceCharacter, the offset's speed is that of the poses shown.
struct InertiaPoses {
    Trs<double> shown, shown_before, target, target_before;
};
ReferenceInertia inertia_begin_reference(const InertiaPoses& poses, double time_step_s);

// The pose to show `elapsed_s` after InertiaPoses::shown. `target`: the current target pose.
Trs<double> inertia_apply_reference(const ReferenceInertia& inertia, double elapsed_s, double duration_s,
                                    const Trs<double>& target);

}  // namespace throng
