#include "draw/crowd_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace throng {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Bounds kNothing{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}},
    kEverywhere{kNothing.max, kNothing.min};

Vec3<float> least(const Vec3<float>& a, const Vec3<float>& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3<float> most(const Vec3<float>& a, const Vec3<float>& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

Vec3<float> place_of(const Affine& placement) {
    return {placement.row[0][3], placement.row[1][3], placement.row[2][3]};
}

bool holds(const Bounds& bounds, const Vec3<float>& p) {
    return p.x >= bounds.min.x && p.x <= bounds.max.x && p.y >= bounds.min.y && p.y <= bounds.max.y &&
           p.z >= bounds.min.z && p.z <= bounds.max.z;
}

// Where the middle half of the values begins and ends.
std::pair<float, float> middle_half(std::vector<float>& values) {
    const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4),
               rest = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 4);
    std::nth_element(values.begin(), quarter, values.end());
    const float low = *quarter;
    std::nth_element(values.begin(), rest, values.end());
    return {low, *rest};
}

// Only outside of this box can an instance be an outlier (bounds_of() decides). It is the middle half of a sample of
// the placements along each axis, extended on all sides by four times the width of the widest of the three (at least a
// character's size); unlimited for fewer than kFewest samples. (J. W. Tukey's fences, Exploratory Data Analysis, 1977,
// with a wider margin.)
Bounds fence_of(Crowds crowds) {
    constexpr uint32_t kSample = 1024, kFewest = 5;
    constexpr float kWidths = 4;
    uint32_t count = 0;
    for (const CrowdState* crowd : crowds) count += crowd->instance_count;
    const uint32_t step = std::max(count / kSample, 1u);
    std::array<std::vector<float>, 3> along;
    for (const CrowdState* crowd : crowds) {
        const std::vector<Affine>& placements = crowd->placements->known();
        for (uint32_t i = 0; i < crowd->instance_count; i += step)
            for (size_t axis = 0; axis < 3 && crowd->has_instance(i); ++axis)
                along[axis].push_back(placements[i].row[axis][3]);
    }
    if (along[0].size() < kFewest) return kEverywhere;
    std::array<std::pair<float, float>, 3> middle;
    float width = character_size(crowds);
    for (size_t axis = 0; axis < 3; ++axis) {
        middle[axis] = middle_half(along[axis]);
        width = std::max(width, middle[axis].second - middle[axis].first);
    }
    const float margin = kWidths * width;
    const auto [x, y, z] = middle;
    return {{x.first - margin, y.first - margin, z.first - margin},
            {x.second + margin, y.second + margin, z.second + margin}};
}

// Bounds that grow instance by instance.
struct Growing {
    uint32_t count = 0;
    Bounds rest = kNothing, posed = kNothing;
    float ground = kInfinity;

    void add(const Group& group, const Affine& placement) {
        ++count;
        const Bounds near = near_box(group), at_rest = placed(placement, group.shown_min, group.shown_max),
                     in_poses = placed(placement, most(group.posed_min, near.min), least(group.posed_max, near.max));
        rest = {least(rest.min, at_rest.min), most(rest.max, at_rest.max)};
        posed = {least(posed.min, in_poses.min), most(posed.max, in_poses.max)};
        const float floating = group.shown_min.y, height = group.shown_max.y - group.shown_min.y;
        ground = std::min(ground, at_rest.min.y);
        if (floating > 0 && floating <= 0.25f * height) ground = std::min(ground, placement.row[1][3]);
    }
    void add(const Growing& other) {
        count += other.count;
        rest = {least(rest.min, other.rest.min), most(rest.max, other.rest.max)};
        posed = {least(posed.min, other.posed.min), most(posed.max, other.posed.max)};
        ground = std::min(ground, other.ground);
    }

private:
    // A limit for the posed box to which shadows are fitted, since games hide things by moving them far away in a clip.
    static Bounds near_box(const Group& group) {
        constexpr float kSizes = 4;
        const float reach = kSizes * size_at_rest(group);
        return {group.shown_min - Vec3<float>{reach, reach, reach}, group.shown_max + Vec3<float>{reach, reach, reach}};
    }
    // The box around a placed box, found without transforming its eight corners.
    static Bounds placed(const Affine& placement, const Vec3<float>& min, const Vec3<float>& max) {
        const Vec3<float> half = (max - min) * 0.5f, middle = transform_point(placement, (min + max) * 0.5f);
        const auto reach_along = [&](size_t r) {
            const auto& row = placement.row[r];
            return std::abs(row[0]) * half.x + std::abs(row[1]) * half.y + std::abs(row[2]) * half.z;
        };
        const Vec3<float> reach{reach_along(0), reach_along(1), reach_along(2)};
        return {middle - reach, middle + reach};
    }
};

bool is_any_there(const CrowdState& crowd, const Batch& batch) {
    if (!crowd.groups[batch.group].varies) return true;
    for (uint32_t i = 0; i < batch.instance_count; ++i)
        if (crowd.has_instance(batch.first_instance + i)) return true;
    return false;
}

Bounds bounds_at_rest(std::span<const Crowd* const> crowds, Outliers outliers) {
    std::vector<CrowdState*> states;
    for (const Crowd* crowd : crowds)
        if (crowd->instance_count() > 0) states.push_back(&crowd->state());
    return bounds_of(states, outliers).rest;
}

}  // namespace

float size_at_rest(const Group& group) { return length(group.shown_max - group.shown_min); }

float placed_size(float size_at_rest, const Affine& placement) {
    return std::max(size_at_rest * std::cbrt(std::abs(determinant(placement))), 1e-6f);
}

float character_size(Crowds crowds) {
    float of_all = 0, of_those_there = 0;
    for (const CrowdState* crowd : crowds)
        for (const Batch& batch : crowd->batches) {
            const float size = placed_size(size_at_rest(crowd->groups[batch.group]),
                                           crowd->placements->known()[batch.first_instance]);
            of_all = std::max(of_all, size);
            if (is_any_there(*crowd, batch)) of_those_there = std::max(of_those_there, size);
        }
    return of_those_there > 0 ? of_those_there : std::max(of_all, 1e-6f);
}

CrowdBounds bounds_of(Crowds crowds, Outliers outliers) {
    const Bounds fence = outliers == Outliers::kIncluded ? kEverywhere : fence_of(crowds);
    Growing within, beyond;
    for (const CrowdState* crowd : crowds) {
        const std::vector<Affine>& placements = crowd->placements->known();
        for (const Batch& batch : crowd->batches) {
            const Group& group = crowd->groups[batch.group];
            for (uint32_t i = batch.first_instance; i < batch.first_instance + batch.instance_count; ++i)
                if (!group.varies || crowd->has_instance(i))
                    (holds(fence, place_of(placements[i])) ? within : beyond).add(group, placements[i]);
        }
    }
    if (beyond.count > std::max((within.count + beyond.count) / 100, 1u)) within.add(beyond);
    CrowdBounds bounds{.size = character_size(crowds)};
    if (within.count > 0) bounds.rest = within.rest, bounds.posed = within.posed, bounds.ground = within.ground;
    return bounds;
}

Bounds world_bounds(const Crowd& crowd) { return bounds_at_rest(std::array{&crowd}, Outliers::kIncluded); }
Bounds main_bounds(const Crowd& crowd) { return main_bounds(std::array{&crowd}); }
Bounds main_bounds(std::span<const Crowd* const> crowds) { return bounds_at_rest(crowds, Outliers::kLeftOut); }

}  // namespace throng
