#include "base/slerp.h"

#include <algorithm>
#include <cmath>

namespace throng {

Quaternion<double> slerp(Quaternion<double> a, Quaternion<double> b, double w) {
    double cosine = dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    const double angle = std::acos(std::min(cosine, 1.0));
    double from = 1 - w, to = w;
    if (angle > 1e-6) {  // below, chord and arc agree to 1e-13
        from = std::sin((1 - w) * angle) / std::sin(angle);
        to = std::sin(w * angle) / std::sin(angle);
    }
    return normalized(
        Quaternion<double>{from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z, from * a.w + to * b.w});
}

}  // namespace throng
