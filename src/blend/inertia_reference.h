// The definition of inertial transitions.
#pragma once

#include <throng/transform.h>

namespace throng {

// A quintic from offset x >= 0 and speed v <= 0 that reaches 0, with speed and acceleration 0, after `duration_s`; or
// sooner, where it would otherwise swing to the other side.
double decayed_reference(double x, double v, double elapsed_s, double duration_s);

// An offset: how far along a direction, and the speed at which that shrinks (0 where it would grow).
struct ReferenceInertia {
    struct Offset {
        Vec3<double> direction;
        double size = 0, speed = 0;
    };
    Offset rotation;  // axis, radians; the turn leads from the target's to the pose shown, in the space of the parent
    Offset translation, scale;
};

// From the last two poses shown and the target's at the same times, `time_step_s` apart. With `target` as
// `target_before`, as ReferenceCharacter passes it, the offset's speed is that of what was shown.
struct InertiaPoses {
    Trs<double> shown, shown_before, target, target_before;
};
ReferenceInertia inertia_begin_reference(const InertiaPoses& poses, double time_step_s);

// `elapsed_s` after the last pose was shown; `target` as it is by now.
Trs<double> inertia_apply_reference(const ReferenceInertia& inertia, double elapsed_s, double duration_s,
                                    const Trs<double>& target);

}  // namespace throng
