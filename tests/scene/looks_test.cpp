// Looks of a crowd: neighbours differ where anybody would see it, and the same seed gives the same looks.
#include "tools/creatures/creature.h"
#include "tools/scene/looks.h"
#include "tools/scene/scatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace throng::tools {
namespace {

constexpr uint32_t kCount = 10'000;

// Creatures of a kind, and the looks that the demo gives them.
class Dressed {
public:
    Dressed(CreatureKind kind, const std::string& looks_file)
        : character(compile_character(make_creature(creature_settings(kind)).value(), {.lods = false}).value()),
          looks(THRONG_SOURCE_DIR "/examples/looks/" + looks_file, character) {}

    struct Comparison {
        double least_difference = 1;  // between the looks of two neighbours
        uint64_t pairs = 0;           // of neighbours
    };
    // Compares the looks of all neighbours: creatures whose places are less than one and a half times their width
    // apart. Creature i stands at places[i], `scale` times as large as in its file, and wears worn[i].
    Comparison compare_neighbours(std::span<const Affine> places, std::span<const InstanceLook> worn,
                                  double scale) const {
        const double near = 1.5 * scale * footprint(character);
        Comparison found;
        for (size_t i = 0; i < places.size(); ++i)
            for (size_t j = 0; j < i; ++j) {
                const double x = double{places[i].row[0][3]} - double{places[j].row[0][3]},
                             z = double{places[i].row[2][3]} - double{places[j].row[2][3]};
                if (x * x + z * z > near * near) continue;
                found.least_difference = std::min(found.least_difference, difference(worn[i], worn[j]));
                ++found.pairs;
            }
        return found;
    }

    const Character character;
    const Looks looks;

private:
    // How much the colours of two differ, sRGB, as the mean over their triangles: 0 to 1.
    double difference(const InstanceLook& a, const InstanceLook& b) const {
        double sum = 0;
        for (uint32_t section = 0; section < character.sections.size(); ++section) {
            double most = 0;
            for (size_t i = 0; i < 3; ++i)
                most = std::max(most, std::abs(encoded(a, section, i) - encoded(b, section, i)));
            sum += most * character.sections[section].index_count;
        }
        return sum / static_cast<double>(character.indices.size());
    }
    double encoded(const InstanceLook& look, uint32_t section, size_t channel) const {
        const SectionLook& of = looks.outfits()[look.outfit].sections[section];
        const double base = double{character.materials[character.sections[section].material].base_color[channel]},
                     linear = base * double{of.color[channel]} *
                              (1 - double{of.tint} + double{of.tint} * double{look.tint[channel]});
        return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    }
};

// The field of `./run demo`.
TEST(LooksOfTheDemo, NeighboursDiffer) {
    const std::array kinds{Dressed(CreatureKind::kDragon, "dragon.json"), Dressed(CreatureKind::kWillow, "willow.json"),
                           Dressed(CreatureKind::kWalker, "walker.json")};
    constexpr std::array kWanted{0.07, 0.08, 0.11};  // dragons and willows are of one piece
    const std::array characters{kinds[0].character, kinds[1].character, kinds[2].character};
    const Scatter field = scatter(
        characters, {.counts = {300, 120, 9580}, .heights = {5, 9, 1.8}, .formation = Formation::kDisc, .seed = 1});
    size_t first = 0;
    for (size_t k = 0; k < kinds.size(); ++k) {
        const std::span places = std::span(field.placement).subspan(first, field.groups[k].instance_count);
        first += places.size();
        const auto worn = kinds[k].looks.of_instances(kinds[k].character, places, 1 + k);
        const Dressed::Comparison found = kinds[k].compare_neighbours(places, worn, field.scales[k]);
        EXPECT_GE(found.least_difference, kWanted[k]) << k;
        EXPECT_GT(found.pairs, places.size() / 10) << k;
    }
}

class LooksOfWalkers : public testing::Test {
protected:
    Dressed::Comparison compare_neighbours(const std::vector<InstanceLook>& worn) const {
        return walkers_.compare_neighbours(field_.placement, worn, 1);
    }

    const Dressed walkers_{CreatureKind::kWalker, "walker.json"};
    const Character& walker_ = walkers_.character;
    const Looks& looks_ = walkers_.looks;
    const Scatter field_ = scatter(std::span(&walker_, 1), {.counts = {kCount}, .formation = Formation::kDisc});
};

TEST_F(LooksOfWalkers, NeighboursDiffer) {
    for (const uint64_t seed : {1, 2, 3}) {
        const Dressed::Comparison found = compare_neighbours(looks_.of_instances(walker_, field_.placement, seed));
        EXPECT_GE(found.least_difference, 0.12) << seed;
        EXPECT_GT(found.pairs, 2 * kCount) << seed;
        // Looks that were chosen for other places are as random ones here: some neighbours are nearly alike
        const Scatter elsewhere = scatter(std::span(&walker_, 1),
                                          {.counts = {kCount}, .formation = Formation::kRandom, .seed = seed});
        EXPECT_LT(compare_neighbours(looks_.of_instances(walker_, elsewhere.placement, seed)).least_difference, 0.05)
            << seed;
    }
}

TEST_F(LooksOfWalkers, TheSameSeedGivesTheSameLooks) {
    const auto same = [](const InstanceLook& a, const InstanceLook& b) {
        return a.tint == b.tint && a.outfit == b.outfit;
    };
    const std::vector<InstanceLook> looks = looks_.of_instances(walker_, field_.placement, 1);
    EXPECT_TRUE(std::ranges::equal(looks, looks_.of_instances(walker_, field_.placement, 1), same));
    EXPECT_FALSE(std::ranges::equal(looks, looks_.of_instances(walker_, field_.placement, 2), same));
}

TEST_F(LooksOfWalkers, AnyPlacesWillDo) {
    EXPECT_TRUE(looks_.of_instances(walker_, {}, 1).empty());
    EXPECT_EQ(looks_.of_instances(walker_, std::vector(3, Affine()), 1).size(), 3u);
    std::vector<Affine> line(100);
    for (size_t i = 0; i < line.size(); ++i) line[i].row[2][3] = 1e30f * static_cast<float>(i);
    EXPECT_EQ(looks_.of_instances(walker_, line, 1).size(), line.size());
}

}  // namespace
}  // namespace throng::tools
