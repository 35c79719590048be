// Collects pixels of masked or blended triangles until they fill the lanes, then tests their alpha.
#pragma once

#include "raster/coverage.h"
#include "raster/mask.h"
#include "raster/samples.h"

namespace throng::raster {
namespace {

template <Into kInto>
class Fragments {
public:
    Fragments(const Draw& draw, const Target<kInto>& target) : draw_(draw), target_(target) {}

    // `samples`: bits of those in the triangle.
    void add(int x, int y, uint32_t samples, const Plane<float>& plane, uint32_t triangle) {
        x_[count_] = static_cast<uint32_t>(x);
        y_[count_] = static_cast<uint32_t>(y);
        triangles_[count_] = triangle;
        samples_[count_] = samples;
        planes_[count_] = plane;
        if (++count_ == Lanes::kCount) finish();
    }
    void finish() {
        if (count_ == 0) return;
        for (uint32_t i = count_; i < Lanes::kCount; ++i) {
            x_[i] = x_[0];
            y_[i] = y_[0];
            triangles_[i] = triangles_[0];
        }
        const Material& material = *draw_.material;
        const Real alphas = alphas_of(target_.frame, draw_, kInto == Into::kMap, load_any(triangles_), load_any(x_),
                                      load_any(y_));
        Mask passes = first_lanes(count_);
        if (material.is_blended)
            cover(alphas);
        else
            passes = passes & ~(alphas < material.alpha_cutoff);
        for (uint32_t rest = bits(passes); rest != 0; rest &= rest - 1) {
            const int i = __builtin_ctz(rest);
            const int x = static_cast<int>(x_[i]), y = static_cast<int>(y_[i]);
            for (uint32_t samples = samples_[i]; samples != 0; samples &= samples - 1) {
                const int sample = __builtin_ctz(samples);
                const float depth = planes_[i].at(static_cast<float>(256 * x) + Pattern<kInto>::kX[sample],
                                                  static_cast<float>(256 * y) + Pattern<kInto>::kY[sample]);
                target_.write(x, y, static_cast<uint32_t>(sample), depth, draw_.first_id + triangles_[i]);
            }
        }
        count_ = 0;
    }

private:
    // Leaves out the samples that are not covered.
    void cover(Real alphas) {
        alignas(64) float of_lanes[Lanes::kCount];
        store(of_lanes, alphas);
        constexpr uint32_t kSamples = Pattern<kInto>::kCount;
        const float* const grid = target_.frame.scene.map_grid;
        const auto on_grid = [&](uint32_t texel, size_t axis) {
            return kInto == Into::kMap ? (texel + static_cast<uint32_t>(grid[axis])) & 65535u : texel;
        };
        for (uint32_t i = 0; i < count_; ++i) {
            uint32_t covered = 0;
            for (uint32_t sample = 0; sample < kSamples; ++sample)
                if (covers(of_lanes[i], on_grid(x_[i], 0), on_grid(y_[i], 1), sample, kSamples, draw_.layer))
                    covered |= 1u << sample;
            samples_[i] &= covered;
        }
    }

    const Draw& draw_;
    const Target<kInto> target_;
    uint32_t count_ = 0;
    alignas(64) uint32_t x_[Lanes::kCount], y_[Lanes::kCount], triangles_[Lanes::kCount];
    uint32_t samples_[Lanes::kCount];
    Plane<float> planes_[Lanes::kCount];
};

}  // namespace
}  // namespace throng::raster
