// The state of a crowd's wind over time.
#pragma once

#include "base/finite.h"
#include "procedural/procedural_io.h"

#include <throng/procedural.h>

#include <array>
#include <cmath>

namespace throng {

// Sway frequencies are multiples of 1 / kSwayPeriod_s, so that the time can wrap and floats keep their precision
inline constexpr double kSwayPeriod_s = 64;
inline double rounded_sway_hz(double sway_hz) { return std::round(sway_hz * kSwayPeriod_s) / kSwayPeriod_s; }

class WindClock {
public:
    // Throws kInvalidArgument for numbers that are not finite or out of range. The phases of gusts go on, but if
    // direction or wavelength changes, gusts are suddenly elsewhere.
    void set(const Wind& wind);
    void advance(double time_step_s);
    // Undoes the last advance().
    void step_back();

    struct Moment {
        Vec3<double> direction{1, 0, 0};  // unit length, world
        double speed = 0;                 // units a second
        double gust = 0;
        double gust_rate = 0;                 // 1 / wavelength
        std::array<double, 3> gust_phases{};  // cycles, 0..1
        double sway_time_s = 0;               // 0..kSwayPeriod_s

        void tell(io::ProceduralPush& push) const;
    };
    const Moment& moment() const { return moment_; }

    // Saves or restores the state.
    template <class Archive>
    void exchange(Archive& archive) {
        archive.value(moment_);
        const auto& [direction, speed, gust, gust_rate, phases, sway_time_s] = moment_;
        Archive::require(
            all_finite(direction) && all_finite(std::array{speed, gust, gust_rate, sway_time_s}) && all_finite(phases),
            "the wind is not finite");
    }

private:
    Moment moment_;
    double sway_time_before_s_ = 0;  // before the last advance()
    std::array<double, 3> gust_phases_before_{};
};

}  // namespace throng
