// similarity_from_affine() of gpu/similarity.glsl for lanes, which select where a shader thread branches.
#pragma once

#include "native/kernel_lanes.h"

namespace {

INLINE Quad select(Lanes::Mask mask, const Quad& yes, const Quad& no) {
    return {Lanes::select(mask, yes.x, no.x), Lanes::select(mask, yes.y, no.y), Lanes::select(mask, yes.z, no.z),
            Lanes::select(mask, yes.w, no.w)};
}

// Rotation x, y, z, w; translation, scale.
INLINE void similarity_words(const Matrix& m, V* words) {
    const V zero = Lanes::set(0), one = Lanes::set(1);
    const auto& a = m.of[0];
    const auto& b = m.of[1];
    const auto& c = m.of[2];
    const V size = Lanes::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    const V volume = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                     a[2] * (b[0] * c[1] - b[1] * c[0]);
    const V scale = Lanes::flip_where_negative(size, volume);
    const Lanes::Mask has_size = Lanes::less(zero, size);
    const V inverse = Lanes::select(has_size, one / Lanes::select(has_size, scale, one), zero);
    const V xx = a[0] * inverse, yy = b[1] * inverse, zz = c[2] * inverse;
    const V square_x = one + xx - yy - zz, square_y = one + yy - xx - zz, square_z = one + zz - xx - yy,
            square_w = one + xx + yy + zz;
    const V sum_x = (b[2] + c[1]) * inverse, sum_y = (a[2] + c[0]) * inverse, sum_z = (b[0] + a[1]) * inverse;
    const V turn_x = (c[1] - b[2]) * inverse, turn_y = (a[2] - c[0]) * inverse, turn_z = (b[0] - a[1]) * inverse;
    Quad q{turn_x, turn_y, turn_z, square_w};
    V largest = square_w;
    const auto take = [&](V square, const Quad& other) {
        const Lanes::Mask larger = Lanes::less(largest, square);
        q = select(larger, other, q);
        largest = Lanes::select(larger, square, largest);
    };
    take(square_x, {square_x, sum_z, sum_y, turn_x});
    take(square_y, {sum_z, square_y, sum_x, turn_y});
    take(square_z, {sum_y, sum_x, square_z, turn_z});
    q = q * Lanes::inverse_sqrt(dot(q, q));
    const V all[8] = {q.x, q.y, q.z, q.w, a[3], b[3], c[3], scale};
    for (uint32_t i = 0; i < 8; ++i) words[i] = all[i];
}

}  // namespace
