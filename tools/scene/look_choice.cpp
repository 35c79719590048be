#include "tools/scene/look_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace throng::tools {
namespace {

constexpr uint32_t kCandidates = 16;

// A section as it is seen: its colour, encoded by a square root, which is close to sRGB, and its material. Few bytes,
// since there is one for each section of each instance.
struct SeenSection {
    std::array<uint8_t, 3> color{};
    uint8_t material = 0;  // 0: hidden; else 1 + a number of the material, modulo 255
};

// How much of the character's surface each section has. [sections], in sum 1
std::vector<float> surface_shares(const Character& character) {
    std::vector<float> shares;
    float sum = 0;
    for (const MeshSection& section : character.sections) {
        float& share = shares.emplace_back();
        const auto position = [&](uint32_t index) {
            return character.vertices[section.first_vertex + character.indices[index]].position;
        };
        for (uint32_t i = section.first_index; i < section.first_index + section.index_count; i += 3)
            share += length(cross(position(i + 1) - position(i), position(i + 2) - position(i)));
        sum += share;
    }
    for (float& share : shares) share /= std::max(sum, std::numeric_limits<float>::min());
    return shares;
}

class SeenLooks {
public:
    SeenLooks(const Character& character, std::span<const Outfit> outfits) : shares_(surface_shares(character)) {
        for (const Outfit& outfit : outfits) {
            std::vector<SectionLook>& looks = looks_.emplace_back(shares_.size());
            for (const SectionLook& look : outfit.sections) looks[look.section] = look;
            for (size_t section = 0; section < looks.size(); ++section) {
                const uint32_t material = looks[section].material.value_or(character.sections[section].material);
                looks[section].material = material;
                for (size_t i = 0; i < 3 && material != kNone; ++i)
                    looks[section].color[i] *= character.materials[material].base_color[i];
            }
        }
    }

    size_t section_count() const { return shares_.size(); }

    void see(const InstanceLook& look, std::span<SeenSection> seen) const {
        for (size_t section = 0; section < seen.size(); ++section) {
            const SectionLook& of = looks_[look.outfit][section];
            seen[section] = {};
            if (!of.is_shown) continue;
            seen[section].material = static_cast<uint8_t>(1 + (*of.material + 1) % 255);
            for (size_t i = 0; i < 3; ++i) {
                const float linear = of.color[i] * (1 + of.tint * (look.tint[i] - 1));
                seen[section].color[i] = static_cast<uint8_t>(255 * std::sqrt(std::clamp(linear, 0.0f, 1.0f)));
            }
        }
    }

    // 0: alike; 1: one is black, the other white.
    float difference(std::span<const SeenSection> a, std::span<const SeenSection> b) const {
        constexpr int kOtherMaterial = 64;  // with the same colour, but perhaps another texture
        float sum = 0;
        for (size_t section = 0; section < a.size(); ++section) {
            int most = a[section].material == b[section].material ? 0 : kOtherMaterial;
            if ((a[section].material == 0) != (b[section].material == 0)) most = 255;
            for (size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(a[section].color[i] - b[section].color[i]));
            sum += shares_[section] * static_cast<float>(most) / 255;
        }
        return sum;
    }

private:
    std::vector<float> shares_;                    // [sections]
    std::vector<std::vector<SectionLook>> looks_;  // [outfits][sections], colours times those of materials
};

// Divides the ground into square cells, so that neighbours are found without looking at all instances.
class Ground {
public:
    explicit Ground(std::span<const Affine> world_from_model) {
        constexpr double kPlaces = 2;  // in a cell, along x and z
        double max_x = -std::numeric_limits<double>::infinity(), max_z = max_x;
        for (const Affine& place : world_from_model) {
            min_x_ = std::min(min_x_, double{place.row[0][3]}), max_x = std::max(max_x, double{place.row[0][3]});
            min_z_ = std::min(min_z_, double{place.row[2][3]}), max_z = std::max(max_z, double{place.row[2][3]});
        }
        const double width = max_x - min_x_, depth = max_z - min_z_,
                     count = static_cast<double>(world_from_model.size()),
                     pitch = std::max(std::sqrt(width * depth / count), std::max(width, depth) / count);
        cell_ = std::max(kPlaces * pitch, std::numeric_limits<double>::min());
        columns_ = index(width / cell_) + 1;
        rows_ = index(depth / cell_) + 1;
        cells_.resize(columns_ * rows_);
    }
    void add(uint32_t instance, const Affine& place) {
        const auto [column, row] = cell_of(place);
        cells_[row * columns_ + column].push_back(instance);
    }
    // Sets `near` to the instances added so far in this place's cell and in the eight cells around it.
    void find_near(const Affine& place, std::vector<uint32_t>& near) const {
        near.clear();
        const auto [column, row] = cell_of(place);
        for (size_t z = row - std::min<size_t>(row, 1); z <= std::min(row + 1, rows_ - 1); ++z)
            for (size_t x = column - std::min<size_t>(column, 1); x <= std::min(column + 1, columns_ - 1); ++x)
                near.insert(near.end(), cells_[z * columns_ + x].begin(), cells_[z * columns_ + x].end());
    }

private:
    static size_t index(double of) { return static_cast<size_t>(of); }
    std::pair<size_t, size_t> cell_of(const Affine& place) const {
        return {index((double{place.row[0][3]} - min_x_) / cell_), index((double{place.row[2][3]} - min_z_) / cell_)};
    }

    double min_x_ = std::numeric_limits<double>::infinity(), min_z_ = min_x_, cell_ = 1;
    size_t columns_ = 1, rows_ = 1;
    std::vector<std::vector<uint32_t>> cells_;
};

}  // namespace

std::vector<InstanceLook> looks_unlike_neighbours(const Character& character, std::span<const Outfit> outfits,
                                                  std::span<const Affine> world_from_model,
                                                  const std::function<InstanceLook()>& draw) {
    const SeenLooks looks(character, outfits);
    const size_t sections = looks.section_count();
    std::vector<InstanceLook> chosen(world_from_model.size());
    std::vector<SeenSection> seen(chosen.size() * sections), candidate(sections);
    const auto seen_of = [&](size_t instance) { return std::span(seen).subspan(instance * sections, sections); };
    if (chosen.empty()) return chosen;
    Ground ground(world_from_model);
    std::vector<uint32_t> near;
    for (uint32_t instance = 0; instance < chosen.size(); ++instance) {
        ground.find_near(world_from_model[instance], near);
        float largest = -1;
        for (uint32_t i = 0; i < kCandidates; ++i) {
            const InstanceLook look = draw();
            looks.see(look, candidate);
            float least = std::numeric_limits<float>::infinity();
            for (size_t n = 0; n < near.size() && least > largest; ++n)
                least = std::min(least, looks.difference(candidate, seen_of(near[n])));
            if (least <= largest) continue;
            largest = least;
            chosen[instance] = look;
            std::ranges::copy(candidate, seen_of(instance).begin());
        }
        ground.add(instance, world_from_model[instance]);
    }
    return chosen;
}

}  // namespace throng::tools
