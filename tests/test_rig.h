// Rigs, characters and transforms generated from a seed, identical on every machine.
#pragma once

#include <throng/throng.h>

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace throng::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                       kNan = std::numeric_limits<float>::quiet_NaN();

// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014). The standard library's distributions differ between implementations.
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}

    uint64_t next() {
        uint64_t z = state_ += 0x9E3779B97F4A7C15u;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    uint32_t below(uint32_t end) { return static_cast<uint32_t>((next() >> 32) * end >> 32); }
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // 0 <= unit < 1
    double between(double low, double high) { return low + (high - low) * unit(); }
    bool chance(double probability) { return unit() < probability; }
    Vec3<double> vector(double extent);  // each component within -extent..extent
    Vec3<double> direction();            // unit length
    Quaternion<double> rotation() { return axis_angle(direction(), between(0, 3.14159)); }
    Trs<double> trs(double extent, double scale_spread);  // scale: within 1 - spread..1 + spread, each axis its own

private:
    uint64_t state_;
};

enum class RigShape {
    kChain,   // one joint below the other
    kStar,    // all below the first
    kComb,    // a spine of every second joint, a tooth on each
    kBinary,  // two children each, level after level
    kRandom,  // the parent is one of the 16 joints before; some roots more. Deep: joints / 8 levels
    kBushy,   // the parent is any joint before. Flat: some 20 levels, whatever the joint count
};
inline constexpr std::array kRigShapes{RigShape::kChain, RigShape::kStar, RigShape::kComb, RigShape::kBinary,
                                       RigShape::kRandom};
std::string_view name_of(RigShape shape);

// parents[j] < j, or kNone.
std::vector<uint32_t> make_parents(RigShape shape, uint32_t joint_count, uint64_t seed = 1);

// A rotation by quarter turns about the axes and an integer translation within -4..4: products are exact in float as
// long as the sums stay below 2^24.
Affine exact_transform(Random& random);

struct AssetSettings {
    std::string name = "test";
    uint32_t joint_count = 20;
    RigShape shape = RigShape::kRandom;
    uint64_t seed = 1;
    double scale_spread = 0.1;   // of joints, in the rest pose and in clips; 0: no scale
    uint32_t clip_count = 3;     // 1, 2, … seconds long
    uint32_t axis_count = 3;     // different sets of key times among a clip's tracks
    uint32_t key_count = 6;      // per track
    bool cubic = false;          // a third of the tracks; the rest is linear, and some step
    uint32_t vertex_count = 30;  // of each of the two meshes: the first with 4 influences, the second with 8
    // Targets per mesh, with weights in most clips. If there are any, the second mesh is at node 1
    uint32_t morph_count = 0;

    friend auto operator<=>(const AssetSettings&, const AssetSettings&) = default;
};
// Every node is a joint of the only skin; the parent of node k is make_parents()[k].
Asset make_asset(const AssetSettings& settings);
// If compilation fails, fails the test and returns an empty character.
Character compiled(const Asset& asset, const CompileSettings& settings = kExact);
inline Character make_character(const AssetSettings& settings) { return compiled(make_asset(settings)); }

// The larger of two errors. Infinite if one is NaN, which std::max() may ignore.
double worse_of(double a, double b);

// The linear part is compared relative to its largest element (at least 1), the translation relative to `size`.
// Infinite if a number is not finite.
double matrix_error(const Affine& got, const AffineT<double>& wanted, double size);

}  // namespace throng::test
