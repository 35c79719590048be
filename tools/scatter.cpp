#include "tools/scatter.h"

#include "tools/creature_math.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace throng::tools {
namespace {

using creature::Random;

uint32_t below(Random& random, size_t count) { return static_cast<uint32_t>(random.unit() * static_cast<double>(count)); }

ClipPlayback random_clip(const Character& character, Random& random) {
    if (character.clips.empty()) return {};
    const uint32_t clip = below(random, character.clips.size());
    return {clip, random.unit() * character.clips[clip].duration_s, static_cast<float>(random.between(0.8, 1.2)), true};
}

Affine placed(const Character& character, double scale, double x, double z, double turn_rad) {
    const double base_y = character.bounds_min.y;
    const AffineT<double> world_from_scaled = to_affine(Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, turn_rad), {x, -base_y * scale, z}, {scale, scale, scale}});
    const double center_x = (double{character.bounds_min.x} + character.bounds_max.x) / 2, center_z = (double{character.bounds_min.z} + character.bounds_max.z) / 2;
    return (world_from_scaled * to_affine(Trs<double>{.translation = {-center_x, 0, -center_z}})).as<float>();
}

double footprint(const Character& character) {
    const Vec3<float> extent = character.bounds_max - character.bounds_min;
    return std::max({double{extent.x}, double{extent.z}, 0.3 * extent.y, 1e-6});
}

}  // namespace

Scatter scatter(std::span<const Character> characters, uint32_t count, uint64_t seed) {
    Random random(seed);
    Scatter out;
    double largest = 0, spacing = 0;
    for (const Character& character : characters) largest = std::max(largest, double{character.size});
    const auto scale_of = [&](const Character& character) { return characters.size() > 1 && character.size > 0 ? largest / character.size : 1.0; };
    for (const Character& character : characters) spacing = std::max(spacing, footprint(character) * scale_of(character));

    // Cells in random order, so that the kinds mix.
    std::vector<uint32_t> cells(count);
    std::iota(cells.begin(), cells.end(), 0u);
    if (characters.size() > 1)
        for (uint32_t i = count; i > 1; --i) std::swap(cells[i - 1], cells[below(random, i)]);

    const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(double(count))));
    const double jitter = count > 1 ? 0.25 : 0, turn_rad = count > 1 ? 0.8 : 0;
    for (uint32_t kind = 0; kind < characters.size(); ++kind) {
        const auto first = static_cast<uint32_t>(uint64_t{count} * kind / characters.size()), end = static_cast<uint32_t>(uint64_t{count} * (kind + 1) / characters.size());
        const Character& character = characters[kind];
        out.groups.push_back({&character, end - first});
        for (uint32_t i = first; i < end; ++i) {
            Playback playback{random_clip(character, random), random_clip(character, random), static_cast<float>(random.unit())};
            out.playback.push_back(playback);
            const double column = cells[i] % side, row = cells[i] / side;
            const double center = (side - 1) / 2.0;
            out.placement.push_back(placed(character, scale_of(character), (column - center + random.between(-jitter, jitter)) * spacing,
                                           (row - center + random.between(-jitter, jitter)) * spacing, random.between(-turn_rad, turn_rad)));
        }
    }
    return out;
}

}  // namespace throng::tools
