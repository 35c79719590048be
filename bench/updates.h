// How all benchmarks of crowd updates check and time them.
#pragma once

#include "bench/gpu_clock.h"
#include "bench/record.h"
#include "bench/value_of.h"

#include <throng/draw.h>
#include <throng/reference.h>

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace throng::bench {

inline constexpr float kFrame_s = 1.0f / 60;

// Far above float rounding at 120 levels, far below any mistake.
inline constexpr double kSkinErrorBound = 1e-4;

// The largest difference of any element, as a fraction of the character's size: translations divided by it, the other
// columns as displacements of a point one size away. Infinite if any number is NaN, or the counts differ.
double skin_error(std::span<const Affine> got, std::span<const AffineT<double>> wanted, double size);

// model_from_bind of each palette entry, as an update should have it.
using SkinReference = std::function<std::vector<AffineT<double>>(const Character&, const Playback&)>;
std::vector<AffineT<double>> skin_reference_of(const Character& character, const Playback& playback);

// The largest error of some instances, spread evenly over all of them up to the last.
double largest_error_of_some(uint32_t instance_count, const std::function<double(uint32_t instance)>& error_of);

// How the crowd is updated: "fused", "staged", "native, fused", …; "both" where its groups differ.
std::string path_name(const Crowd& crowd);

// What records of updates begin with: where and when, "bench", "configuration", and "joints" and "levels" of the
// character.
Json new_record(const Device& device, const char* bench, const std::string& configuration, const Character& character);

class UpdateTimes {
public:
    // Updates the crowd and waits; keeps the GPU busy just before.
    void take(const GpuLoad& load, Crowd& crowd, float time_step_s = kFrame_s, const CrowdView* view = nullptr);
    // Adds a sample that has no times for stages.
    void take(const Reading& reading) { readings_.push_back(reading); }

    size_t count() const { return readings_.size(); }
    size_t count_by_host() const;
    Spread total() const;
    Spread stage(size_t index) const { return spread_of(stage_ms_[index]); }
    // Adds "samples", "ms" and the medians of "stages" that took any time; nothing where nothing was timed.
    void add_to(Json& record) const;

private:
    std::vector<Reading> readings_;
    std::array<std::vector<double>, kStageLimit> stage_ms_;
};

}  // namespace throng::bench
