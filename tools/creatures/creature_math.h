// Arithmetic of the creature generator whose bits are the same on every platform: +, -, *, / and sqrt only.
#pragma once

#include <throng/transform.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace throng::creature {

using Vec = Vec3<double>;
using Rotation = Quaternion<double>;

// The sine of `turns` whole turns, with an error of at most 1e-10. std::sin differs between C libraries in its last
// bit.
inline double sine(double turns) {
    double x = turns - std::floor(turns + 0.5);  // -0.5 … 0.5
    if (x > 0.25) x = 0.5 - x;
    if (x < -0.25) x = -0.5 - x;
    x *= 2 * std::numbers::pi;
    const double square = x * x;
    double sum = 1;  // Taylor series to x^15, by Horner
    for (int power = 14; power >= 2; power -= 2) sum = 1 - sum * square / (power * (power + 1));
    return x * sum;
}
inline double cosine(double turns) { return sine(turns + 0.25); }

inline Rotation rotation_about(const Vec& unit_axis, double angle_rad) {
    const double half_turns = angle_rad / (4 * std::numbers::pi);
    const Vec v = unit_axis * sine(half_turns);
    return {v.x, v.y, v.z, cosine(half_turns)};
}
inline Rotation conjugate(const Rotation& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline Vec rotate(const Rotation& q, const Vec& v) {
    const Rotation r = q * Rotation{v.x, v.y, v.z, 0} * conjugate(q);
    return {r.x, r.y, r.z};
}

inline double mix(double a, double b, double w) { return a + (b - a) * w; }
inline double smooth_step(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

// `up` without its part along `forward`, unit length; any perpendicular if nothing is left.
inline Vec perpendicular(const Vec& up, const Vec& forward) {
    const Vec rest = up - forward * dot(up, forward);
    if (dot(rest, rest) > 1e-12) return normalized(rest);
    const Vec other = forward.x * forward.x < 0.5 ? Vec{1, 0, 0} : Vec{0, 1, 0};
    return normalized(other - forward * dot(other, forward));
}

// The rotation that takes x, y, z to cross(up, forward), up, forward; both unit and perpendicular.
Rotation rotation_to(const Vec& up, const Vec& forward);

// splitmix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t number() {
        uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    double unit() { return double(number() >> 11) / 9007199254740992.0; }  // 0 <= x < 1
    double between(double low, double high) { return mix(low, high, unit()); }

private:
    uint64_t state_;
};

constexpr double kSides[] = {1, -1};  // left and right

// One cross section of a limb: an ellipse, width to its sides and height along `up`. With one number it is a circle,
// with none a point.
struct Station {
    Vec center;
    double width = 0, height = width;
};

// A limb's flesh: a smooth curve through its stations, parameter 0 … 1 spread evenly over them.
class Outline {
public:
    Outline() = default;
    Outline(std::vector<Station> stations) : stations_(std::move(stations)) {}
    Outline(std::initializer_list<Station> stations) : stations_(stations) {}

    Station at(double t) const;
    Vec direction(double t) const;  // unit, towards larger t

private:
    std::vector<Station> stations_;
};

}  // namespace throng::creature
