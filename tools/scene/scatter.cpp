#include "tools/scene/scatter.h"

#include "tools/cli/command.h"

#include <algorithm>
#include <cmath>

namespace throng::tools {
namespace {

using creature::Random;

ClipPlayback random_clip(const Character& character, Random& random) {
    if (character.clips.empty()) return {};
    const auto clip = static_cast<uint32_t>(random.unit() * static_cast<double>(character.clips.size()));
    return {clip, random.unit() * character.clips[clip].duration_s, static_cast<float>(random.between(0.8, 1.2)), true};
}

Affine placed(const Character& character, double scale, double x, double z, double turn_rad) {
    const double base_y = character.bounds_min.y;
    const AffineT<double> world_from_scaled = to_affine(
        Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, turn_rad), {x, -base_y * scale, z}, {scale, scale, scale}});
    const double center_x = (double{character.bounds_min.x} + character.bounds_max.x) / 2,
                 center_z = (double{character.bounds_min.z} + character.bounds_max.z) / 2;
    return (world_from_scaled * to_affine(Trs<double>{.translation = {-center_x, 0, -center_z}})).as<float>();
}

Vec3<double> extent_of(const Character& character) {
    return character.bounds_max.as<double>() - character.bounds_min.as<double>();
}

// How much larger the characters are than in their files.
std::vector<double> scales(std::span<const Character> characters, const std::vector<double>& heights) {
    double largest = 0;
    for (const Character& character : characters) largest = std::max(largest, double{character.size});
    std::vector<double> scales;
    for (size_t k = 0; k < characters.size(); ++k) {
        const double height = extent_of(characters[k]).y;
        if (!heights.empty())
            scales.push_back(height > 0 ? heights[k] / height : 1);
        else
            scales.push_back(characters.size() > 1 && characters[k].size > 0 ? largest / characters[k].size : 1);
    }
    return scales;
}

// Throws if there would be too many places: those for the smallest characters are generated on all of the ground, which
// grows with the large ones.
void check_room(std::span<const PlacementKind> kinds) {
    constexpr double kMaxPlaces = 40'000'000;
    double area = 0, least = kinds[0].pitch;
    for (const PlacementKind& kind : kinds) {
        area += kind.count * kind.pitch * kind.pitch;
        least = std::min(least, kind.pitch);
    }
    if (!(area / (least * least) <= kMaxPlaces))
        throw CommandError(
            "--sizes: the ground of all characters has more than 40,000,000 places for the smallest; give fewer large "
            "ones, or sizes that differ less");
}

}  // namespace

double footprint(const Character& character) {
    const Vec3<double> extent = extent_of(character);
    return std::max({extent.x, extent.z, 0.3 * extent.y, 1e-6});
}

std::vector<uint32_t> deal_out(uint32_t count, size_t parts) {
    std::vector<uint32_t> counts;
    for (size_t k = 0; k < parts; ++k)
        counts.push_back(static_cast<uint32_t>(uint64_t{count} * (k + 1) / parts - uint64_t{count} * k / parts));
    return counts;
}

Scatter scatter(std::span<const Character> characters, const ScatterSettings& settings) {
    const std::vector<double> scale = scales(characters, settings.heights);
    std::vector<PlacementKind> kinds;
    for (size_t k = 0; k < characters.size(); ++k)
        kinds.push_back({settings.counts[k], footprint(characters[k]) * scale[k] * settings.spacing});
    if (settings.heights.empty()) {
        const double widest = std::ranges::max(kinds, {}, &PlacementKind::pitch).pitch;
        for (PlacementKind& kind : kinds) kind.pitch = widest;
    }
    check_room(kinds);

    Random random(settings.seed);
    const uint64_t first_stream = Random(settings.seed).number();
    const std::vector<Place> places = place(settings.formation, kinds, random);
    const Freedom free = places.size() > 1 ? freedom(settings.formation) : Freedom();
    Scatter out{.scales = scale};
    for (size_t k = 0, next = 0; k < characters.size(); ++k) {
        out.groups.push_back({&characters[k], kinds[k].count});
        const double shift = free.shift * kinds[k].pitch;
        for (uint32_t i = 0; i < kinds[k].count; ++i) {
            const Place& at = places[next++];
            Random own(first_stream + (uint64_t{k} << 32) + i);  // so that it plays the same, however many there are
            out.playback.push_back(
                {random_clip(characters[k], own), random_clip(characters[k], own), static_cast<float>(own.unit())});
            const double turn_rad = at.heading_turns * 2 * std::numbers::pi +
                                    own.between(-free.turn_rad, free.turn_rad);
            const double z = at.z + own.between(-shift, shift), x = at.x + own.between(-shift, shift);
            out.placement.push_back(placed(characters[k], scale[k], x, z, turn_rad));
        }
    }
    return out;
}

Bounds reached_bounds(const Bounds& bounds, const Scatter& field) {
    Bounds all = bounds;
    const auto add = [&](const Clip& clip, const Affine& world_from_model) {
        for (unsigned corner = 0; corner < 8; ++corner) {
            const auto end = [&](unsigned axis) {
                return (corner >> axis & 1) != 0 ? clip.bounds_max : clip.bounds_min;
            };
            const Vec3<float> place = transform_point(world_from_model, Vec3<float>{end(0).x, end(1).y, end(2).z});
            all.min = {std::min(all.min.x, place.x), std::min(all.min.y, place.y), std::min(all.min.z, place.z)};
            all.max = {std::max(all.max.x, place.x), std::max(all.max.y, place.y), std::max(all.max.z, place.z)};
        }
    };
    size_t instance = 0;
    for (const CrowdGroup& group : field.groups)
        for (uint32_t i = 0; i < group.instance_count; ++i, ++instance) {
            const auto& [first, second, weight] = field.playback[instance];
            if (group.controller) continue;
            if (first.clip != kNone && weight > 0) add(group.character->clips[first.clip], field.placement[instance]);
            if (second.clip != kNone && weight < 1) add(group.character->clips[second.clip], field.placement[instance]);
        }
    return all;
}

}  // namespace throng::tools
