#include "procedural/wind_clock.h"

#include "base/failure.h"

#include <cmath>

namespace throng {
namespace {

constexpr std::array kGustRates{1.0, 2.7, 7.1};  // of the three waves that gusts consist of (wind.glsl)
double wrapped(double value, double period) { return value - std::floor(value / period) * period; }

}  // namespace

void WindClock::set(const Wind& wind) {
    const auto fail = [](const char* what) { throw Failure(ErrorCode::kInvalidArgument, "wind", what); };
    const Vec3<double> velocity = wind.velocity.as<double>();
    if (!(length(velocity) <= 1e6)) fail("its velocity must be finite, and at most 1e6");
    if (!(wind.gust >= 0 && wind.gust <= 1)) fail("its gust must be within 0..1");
    if (!(std::isfinite(wind.wavelength) && wind.wavelength >= 1e-6f))
        fail("its wavelength must be finite, and at least 1e-6");
    moment_.speed = length(velocity);
    if (moment_.speed > 0) moment_.direction = normalized(velocity);
    moment_.gust = wind.gust;
    moment_.gust_rate = 1.0 / wind.wavelength;
}

void WindClock::advance(double time_step_s) {
    sway_time_before_s_ = moment_.sway_time_s;
    gust_phases_before_ = moment_.gust_phases;
    for (size_t i = 0; i < kGustRates.size(); ++i)
        moment_.gust_phases[i] = wrapped(
            moment_.gust_phases[i] + time_step_s * moment_.speed * moment_.gust_rate * kGustRates[i], 1);
    moment_.sway_time_s = wrapped(moment_.sway_time_s + time_step_s, kSwayPeriod_s);
}

void WindClock::step_back() {
    moment_.sway_time_s = sway_time_before_s_;
    moment_.gust_phases = gust_phases_before_;
}

void WindClock::Moment::tell(io::ProceduralPush& push) const {
    push.sway_time_s = static_cast<float>(sway_time_s);
    push.wind_speed = static_cast<float>(speed);
    push.wind_x = static_cast<float>(direction.x);
    push.wind_y = static_cast<float>(direction.y);
    push.wind_z = static_cast<float>(direction.z);
    push.gust = static_cast<float>(gust);
    push.gust_rate = static_cast<float>(gust_rate);
    push.gust_phase0 = static_cast<float>(gust_phases[0]);
    push.gust_phase1 = static_cast<float>(gust_phases[1]);
    push.gust_phase2 = static_cast<float>(gust_phases[2]);
}

}  // namespace throng
