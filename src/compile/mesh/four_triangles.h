// Distances of points from triangles, four side by side: one point and one triangle in four poses, or one point and
// four triangles.
#pragma once

#include <throng/transform.h>

#include <algorithm>
#include <cstddef>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace throng {

// A vector type of GCC and Clang, which compile it to SSE and NEON instructions.
using Four = float __attribute__((vector_size(16)));
constexpr size_t kLanes = 4;

inline Four four(float all) { return Four{all, all, all, all}; }
#ifdef __SSE__  // GCC compiles what follows below to a comparison and three logical operations; the result is the same
inline Four lower(const Four& a, const Four& b) { return _mm_min_ps(a, b); }
inline Four higher(const Four& a, const Four& b) { return _mm_max_ps(a, b); }
#else
inline Four lower(const Four& a, const Four& b) { return a < b ? a : b; }
inline Four higher(const Four& a, const Four& b) { return a > b ? a : b; }
#endif
inline float smallest(const Four& a) { return std::min(std::min(a[0], a[1]), std::min(a[2], a[3])); }
inline float largest(const Four& a) { return std::max(std::max(a[0], a[1]), std::max(a[2], a[3])); }
// True or false, four times.
using FourFlags = decltype(Four{} < Four{});

inline bool is_any(const FourFlags& flags) {
    using Halves = long long __attribute__((vector_size(16)));
    const auto halves = reinterpret_cast<Halves>(flags);
    return (halves[0] | halves[1]) != 0;
}

// Four places.
struct Four3 {
    Four x, y, z;

    Vec3<float> at(size_t lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(size_t lane, const Vec3<float>& place) { x[lane] = place.x, y[lane] = place.y, z[lane] = place.z; }
};

inline Four3 four(const Vec3<float>& all) { return {four(all.x), four(all.y), four(all.z)}; }
inline Four3 operator+(const Four3& a, const Four3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Four3 operator-(const Four3& a, const Four3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Four3 operator*(const Four3& a, const Four& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Four dot(const Four3& a, const Four3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Four3 cross(const Four3& a, const Four3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Four3 lower(const Four3& a, const Four3& b) { return {lower(a.x, b.x), lower(a.y, b.y), lower(a.z, b.z)}; }
inline Four3 higher(const Four3& a, const Four3& b) { return {higher(a.x, b.x), higher(a.y, b.y), higher(a.z, b.z)}; }

// Four triangles, with the terms of their distance formula that do not depend on the point computed once. A triangle
// too thin for floats to have a normal is treated as its edges.
class FourTriangles {
public:
    FourTriangles(const Four3& a, const Four3& b, const Four3& c) : corners_{a, b, c}, edges_{b - a, c - b, a - c} {
        constexpr float kThin = 1e-6f;  // squared sine; below it, rounding decides the normal
        normal_ = cross(edges_[0], c - a);
        const Four squared = dot(normal_, normal_);
        for (size_t k = 0; k < 3; ++k) {
            const Four length_squared = dot(edges_[k], edges_[k]);
            inverse_[k] = length_squared > 0.0f ? 1.0f / length_squared : four(0);
            inwards_[k] = cross(normal_, edges_[k]);
        }
        squared_sine_ = squared * inverse_[0] * inverse_[2];
        has_normal_ = squared_sine_ > kThin;
        inverse_normal_ = has_normal_ ? 1.0f / squared : four(0);
    }

    Four squared_distance(const Four3& p) const {
        Four nearest = four(1e30f);
        FourFlags is_above = has_normal_;
        for (size_t k = 0; k < 3; ++k) {
            const Four3 way = p - corners_[k];
            const Four at = lower(higher(dot(way, edges_[k]) * inverse_[k], four(0)), four(1));
            const Four3 apart = way - edges_[k] * at;
            nearest = lower(nearest, dot(apart, apart));
            is_above &= dot(way, inwards_[k]) >= 0.0f;
        }
        const Four height = dot(p - corners_[0], normal_);
        return is_above ? height * height * inverse_normal_ : nearest;
    }

    // Squared sine of the angle at the first corner: near 0 if a triangle is thin.
    Four squared_sine() const { return squared_sine_; }

private:
    Four3 corners_[3], edges_[3], inwards_[3];
    Four inverse_[3];  // 1 / squared length of each edge
    Four3 normal_;
    Four squared_sine_;
    Four inverse_normal_;  // 1 / squared length of normal_
    FourFlags has_normal_;
};

}  // namespace throng
