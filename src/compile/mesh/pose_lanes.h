// Distances of points from triangles, in four poses at once.
#pragma once

#include <throng/transform.h>

#include <algorithm>
#include <cstddef>

namespace throng {

// One number for each of four poses. (A type of GCC and Clang, for which SSE and NEON have instructions.)
using Four = float __attribute__((vector_size(16)));
constexpr size_t kLanes = 4;

inline Four four(float all) { return Four{all, all, all, all}; }
inline Four lower(const Four& a, const Four& b) { return a < b ? a : b; }
inline Four higher(const Four& a, const Four& b) { return a > b ? a : b; }
inline float largest(const Four& a) { return std::max(std::max(a[0], a[1]), std::max(a[2], a[3])); }

// A place in each of four poses.
struct Four3 {
    Four x, y, z;

    Vec3<float> in_pose(size_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

inline Four3 operator+(const Four3& a, const Four3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Four3 operator-(const Four3& a, const Four3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Four3 operator*(const Four3& a, const Four& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Four dot(const Four3& a, const Four3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Four3 cross(const Four3& a, const Four3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// What distances from one triangle have in common. One that is too thin for floats to have a normal is its edges.
class TriangleInPoses {
public:
    TriangleInPoses(const Four3& a, const Four3& b, const Four3& c) : corners_{a, b, c}, edges_{b - a, c - b, a - c} {
        constexpr float kThin = 1e-6f;  // the squared sine of the angle at a, below which rounding decides its normal
        normal_ = cross(edges_[0], c - a);
        const Four squared = dot(normal_, normal_);
        for (size_t k = 0; k < 3; ++k) {
            const Four length_squared = dot(edges_[k], edges_[k]);
            inverse_[k] = length_squared > 0.0f ? 1.0f / length_squared : four(0);
            inwards_[k] = cross(normal_, edges_[k]);
        }
        has_normal_ = squared * inverse_[0] * inverse_[2] > kThin;
        inverse_normal_ = has_normal_ ? 1.0f / squared : four(0);
    }

    Four squared_distance(const Four3& p) const {
        Four nearest = four(1e30f);
        auto is_above = has_normal_;
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

private:
    Four3 corners_[3], edges_[3], inwards_[3];
    Four inverse_[3];  // of the edges' squared lengths
    Four3 normal_;
    Four inverse_normal_;  // squared
    decltype(Four{} < Four{}) has_normal_;
};

}  // namespace throng
