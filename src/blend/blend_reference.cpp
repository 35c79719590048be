#include "blend/blend_reference.h"

namespace throng {

Trs<double> blend_reference(const Trs<double>& a, const Trs<double>& b, double weight) {
    const auto& p = a.rotation;
    const auto q = dot(a.rotation, b.rotation) < 0 ? -b.rotation : b.rotation;
    const double u = weight, v = 1 - weight;
    return {normalized(Quaternion<double>{u * p.x + v * q.x, u * p.y + v * q.y, u * p.z + v * q.z, u * p.w + v * q.w}),
            lerp(b.translation, a.translation, weight), lerp(b.scale, a.scale, weight)};
}

}  // namespace throng
