#include "tools/scene/placement.h"

#include "tools/cli/command.h"

#include <array>
#include <functional>
#include <numeric>
#include <unordered_map>

namespace throng::tools {
namespace {

using creature::cosine;
using creature::Random;
using creature::sine;

double distance_squared(const Place& a, const Place& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.z - b.z) * (a.z - b.z);
}

// The least whole number that is not below `x`, except for rounding errors.
uint32_t ceiling(double x) { return static_cast<uint32_t>(std::ceil(x * (1 - 1e-12))); }

// grid(), disc(), path() and scattered() return places one pitch apart that cover `area`. If all characters have the
// same pitch, those at the end are left out.

std::vector<Place> grid(double area, double pitch) {
    const uint32_t side = ceiling(std::sqrt(area) / pitch);
    const double centre = (side - 1) / 2.0;
    std::vector<Place> places;
    for (uint32_t row = 0; row < side; ++row)
        for (uint32_t column = 0; column < side; ++column)
            places.push_back({(column - centre) * pitch, (row - centre) * pitch, 0});
    return places;
}

// H. Vogel, A better way to construct the sunflower head, Mathematical Biosciences 44, 1979.
std::vector<Place> disc(double area, double pitch) {
    constexpr double kGolden_turns = 0.38196601125010515;  // 1 - 1 / golden ratio
    constexpr double kScale = 0.647;                       // pitches: the nearest two seeds are then 1 apart
    std::vector<Place> places(ceiling(area / (pitch * pitch)));
    for (size_t i = 0; i < places.size(); ++i) {
        const double radius = kScale * pitch * std::sqrt(static_cast<double>(i) + 0.5),
                     turns = kGolden_turns * static_cast<double>(i);
        places[i] = {radius * sine(turns), radius * cosine(turns), turns - std::floor(turns)};
    }
    return places;
}

// A point of a closed curve that does not cross itself, or one `side` to the curve's left. The radius is about 1, that
// of the narrowest bend at least 0.42.
Place curve_at(double turns, double side) {
    const double radius = 1 + 0.25 * cosine(2 * turns) + 0.08 * sine(3 * turns);
    const double slope = 2 * std::numbers::pi * (-0.5 * sine(2 * turns) + 0.24 * cosine(3 * turns));
    const double s = sine(turns), c = cosine(turns), round = 2 * std::numbers::pi * radius;
    const double dx = slope * s + round * c, dz = slope * c - round * s, length = std::sqrt(dx * dx + dz * dz);
    return {radius * s + side * dz / length, radius * c - side * dx / length,
            std::atan2(dx, dz) / (2 * std::numbers::pi)};
}

std::vector<Place> path(double area, double pitch) {
    constexpr double kLength = 6.7;    // of the curve, in its radii
    constexpr double kWidth = 0.25;    // of the road, in radii: half of it is less than the narrowest bend's
    constexpr uint32_t kSteps = 4096;  // into which the curve is cut, to measure it
    constexpr double kApart = 1.05;    // pitches, along the curve
    // In pitches: on the narrowest bend of such a curve, places kApart along it are one pitch apart in a straight line
    constexpr double kMinRadius = 2.5;
    const double radius = std::max(std::sqrt(area / (kLength * kWidth)), kMinRadius * pitch);
    const auto lane_count = static_cast<uint32_t>(std::max(1.0, std::floor(kWidth * radius / pitch)));
    struct Marked {
        double along;
        Place place;
    };
    std::vector<Marked> marked;
    for (uint32_t lane = 0; lane < lane_count; ++lane) {
        const double side = (lane - (lane_count - 1) / 2.0) * pitch / radius;
        std::array<double, kSteps + 1> way{};
        for (uint32_t step = 0; step < kSteps; ++step)
            way[step + 1] = way[step] + std::sqrt(distance_squared(curve_at(double(step) / kSteps, side),
                                                                   curve_at(double(step + 1) / kSteps, side)));
        const auto count = static_cast<uint32_t>(way.back() * radius / (pitch * kApart));
        for (uint32_t i = 0; i < count; ++i) {
            const double sought = way.back() * (i + 0.5 * (lane % 2)) / count;
            const auto after = static_cast<uint32_t>(std::upper_bound(way.begin(), way.end(), sought) - way.begin());
            const double turns = (after - 1 + (sought - way[after - 1]) / (way[after] - way[after - 1])) / kSteps;
            const Place at = curve_at(turns, side);
            marked.push_back({turns, {at.x * radius, at.z * radius, at.heading_turns}});
        }
    }
    // Along the road, so that leaving out the last ones leaves a gap between its end and its beginning.
    std::stable_sort(marked.begin(), marked.end(), [](const Marked& a, const Marked& b) { return a.along < b.along; });
    std::vector<Place> places;
    for (const Marked& one : marked) places.push_back(one.place);
    return places;
}

// R. Bridson, Fast Poisson Disk Sampling in Arbitrary Dimensions, SIGGRAPH 2007 sketches. Difference: new places are
// sought around the oldest first, so that they grow outwards as a disc, and there is no border.
std::vector<Place> scattered(double area, double pitch, Random& random) {
    constexpr int kTries = 30;
    const uint32_t count = ceiling(area / (pitch * pitch));
    // A cell's diagonal is one pitch, so it holds at most one place. There are about twice as many cells as a run
    // needs; outside of them there are no places.
    const double cell = pitch / std::numbers::sqrt2, reach = pitch * (std::sqrt(double(count)) + 4);
    const auto side = static_cast<int64_t>(2 * reach / cell) + 1;
    constexpr uint32_t kEmpty = ~0u;
    std::vector<uint32_t> cells(static_cast<size_t>(side * side), kEmpty);
    const auto cell_of = [&](double x) { return static_cast<int64_t>(std::floor((x + reach) / cell)); };
    std::vector<Place> places;
    const auto is_free = [&](const Place& place) {
        const int64_t column = cell_of(place.x), row = cell_of(place.z);
        if (column < 2 || row < 2 || column >= side - 2 || row >= side - 2) return false;
        for (int64_t z = row - 2; z <= row + 2; ++z)
            for (int64_t x = column - 2; x <= column + 2; ++x) {
                const uint32_t other = cells[static_cast<size_t>(z * side + x)];
                if (other != kEmpty && distance_squared(places[other], place) < pitch * pitch) return false;
            }
        return true;
    };
    const auto add = [&](const Place& place) {
        cells[static_cast<size_t>(cell_of(place.z) * side + cell_of(place.x))] = static_cast<uint32_t>(places.size());
        places.push_back(place);
    };
    add({0, 0, random.unit()});
    for (size_t oldest = 0; oldest < places.size() && places.size() < count; ++oldest)
        for (int i = 0; i < kTries && places.size() < count; ++i) {
            const double distance = pitch * std::sqrt(random.between(1, 4)), turns = random.unit();
            const Place tried{places[oldest].x + distance * sine(turns), places[oldest].z + distance * cosine(turns),
                              0};
            if (is_free(tried)) add({tried.x, tried.z, random.unit()});
        }
    return places;
}

std::vector<Place> cover(Formation formation, double area, double pitch, Random& random) {
    if (formation == Formation::kGrid) return grid(area, pitch);
    if (formation == Formation::kDisc) return disc(area, pitch);
    if (formation == Formation::kPath) return path(area, pitch);
    return scattered(area, pitch, random);
}

// Circles of ground that are taken, looked up by the square they are in. No circle is wider than a square.
class OccupiedGround {
public:
    explicit OccupiedGround(double widest) : square_(widest) {}

    void add(const Place& place, double pitch) {
        squares_[key(square_of(place.x), square_of(place.z))].push_back({place, pitch});
    }
    bool overlaps(const Place& place, double pitch) const {
        const int64_t column = square_of(place.x), row = square_of(place.z);
        for (int64_t z = row - 1; z <= row + 1; ++z)
            for (int64_t x = column - 1; x <= column + 1; ++x)
                if (const auto square = squares_.find(key(x, z)); square != squares_.end())
                    for (const Circle& circle : square->second) {
                        const double apart = (pitch + circle.pitch) / 2;
                        if (distance_squared(circle.centre, place) < apart * apart) return true;
                    }
        return false;
    }

private:
    struct Circle {
        Place centre;
        double pitch;
    };
    int64_t square_of(double x) const { return static_cast<int64_t>(std::floor(x / square_)); }
    static int64_t key(int64_t column, int64_t row) { return column * (int64_t{1} << 32) + row; }

    double square_;
    std::unordered_map<int64_t, std::vector<Circle>> squares_;
};

void shuffle(std::vector<Place>& places, Random& random) {
    for (size_t i = places.size(); i > 1; --i)
        std::swap(places[i - 1], places[static_cast<size_t>(random.unit() * static_cast<double>(i))]);
}

// The places of each kind, [kinds], or none if the area has too few.
std::vector<std::vector<Place>> place_within(Formation formation, double area, std::span<const PlacementKind> kinds,
                                             Random& random) {
    std::vector<double> pitches;
    for (const PlacementKind& kind : kinds) pitches.push_back(kind.pitch);
    std::sort(pitches.begin(), pitches.end(), std::greater());
    pitches.erase(std::unique(pitches.begin(), pitches.end()), pitches.end());

    std::vector<std::vector<Place>> placed(kinds.size());
    OccupiedGround occupied(pitches.front());
    for (const double pitch : pitches) {
        size_t needed = 0;
        for (const PlacementKind& kind : kinds) needed += kind.pitch == pitch ? kind.count : 0;
        std::vector<Place> places = cover(formation, area, pitch, random);
        if (pitches.size() > 1)
            std::erase_if(places, [&](const Place& place) { return occupied.overlaps(place, pitch); });
        if (places.size() < needed) return {};
        if (pitches.size() == 1) places.resize(needed);  // as compact as can be
        if (kinds.size() > 1) shuffle(places, random);
        auto next = places.begin();
        for (size_t k = 0; k < kinds.size(); ++k) {
            if (kinds[k].pitch != pitch) continue;
            placed[k].assign(next, next + kinds[k].count);
            next += kinds[k].count;
            if (pitch != pitches.back())
                for (const Place& place : placed[k]) occupied.add(place, pitch);
        }
    }
    return placed;
}

}  // namespace

std::vector<Place> place(Formation formation, std::span<const PlacementKind> kinds, Random& random) {
    double area = 0;
    for (const PlacementKind& kind : kinds) area += kind.count * kind.pitch * kind.pitch;
    if (!std::isfinite(area)) throw CommandError("the characters are too large to be placed");
    std::vector<std::vector<Place>> placed;
    for (; placed.empty() && area > 0; area *= 1.05) placed = place_within(formation, area, kinds, random);
    std::vector<Place> places;
    for (const std::vector<Place>& of_kind : placed) places.insert(places.end(), of_kind.begin(), of_kind.end());
    return places;
}

Freedom freedom(Formation formation) {
    if (formation == Formation::kGrid) return {0.25, 0.8};
    if (formation == Formation::kDisc) return {0.1, 0.6};
    if (formation == Formation::kPath) return {0.1, 0.1};
    return {};
}

}  // namespace throng::tools
