// Looks of a crowd: neighbours differ where anybody would see it, and the same seed gives the same looks.
#include "tools/creatures/creature.h"
#include "tools/scene/looks.h"
#include "tools/scene/scatter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace throng::tools {
namespace {

constexpr uint32_t kCount = 2000;

class LooksOfWalkers : public testing::Test {
protected:
    // How much the colours of two walkers differ, sRGB, as the mean over their triangles: 0 to 1.
    double difference(const InstanceLook& a, const InstanceLook& b) const {
        double sum = 0;
        for (uint32_t section = 0; section < walker_.sections.size(); ++section) {
            double most = 0;
            for (size_t i = 0; i < 3; ++i)
                most = std::max(most, std::abs(encoded(a, section, i) - encoded(b, section, i)));
            sum += most * walker_.sections[section].index_count;
        }
        return sum / static_cast<double>(walker_.indices.size());
    }
    // The least difference of two walkers who stand within one and a half places of each other.
    double least_difference(const std::vector<InstanceLook>& looks) const {
        const double near = 1.5 * footprint(walker_);
        double least = 1;
        uint32_t pairs = 0;
        for (uint32_t i = 0; i < kCount; ++i)
            for (uint32_t j = 0; j < i; ++j) {
                const auto &a = field_.placement[i].row, &b = field_.placement[j].row;
                if (std::hypot(double{a[0][3]} - double{b[0][3]}, double{a[2][3]} - double{b[2][3]}) > near) continue;
                least = std::min(least, difference(looks[i], looks[j]));
                ++pairs;
            }
        EXPECT_GT(pairs, 2 * kCount);
        return least;
    }

    const Character walker_ =
        compile_character(make_creature(creature_settings(CreatureKind::kWalker)).value(), {.lods = false}).value();
    const Looks looks_{THRONG_SOURCE_DIR "/examples/looks/walker.json", walker_};
    const Scatter field_ = scatter(std::span(&walker_, 1), {.counts = {kCount}, .formation = Formation::kDisc});

private:
    double encoded(const InstanceLook& look, uint32_t section, size_t channel) const {
        const SectionLook& of = looks_.outfits()[look.outfit].sections[section];
        const double base = double{walker_.materials[walker_.sections[section].material].base_color[channel]},
                     linear = base * double{of.color[channel]} *
                              (1 - double{of.tint} + double{of.tint} * double{look.tint[channel]});
        return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    }
};

TEST_F(LooksOfWalkers, NeighboursDiffer) {
    for (const uint64_t seed : {1, 2, 3}) {
        EXPECT_GE(least_difference(looks_.of_instances(walker_, field_.placement, seed)), 0.12) << seed;
        // Looks that were chosen for other places are as random ones here: some neighbours are nearly alike
        const Scatter elsewhere = scatter(std::span(&walker_, 1),
                                          {.counts = {kCount}, .formation = Formation::kRandom, .seed = seed});
        EXPECT_LT(least_difference(looks_.of_instances(walker_, elsewhere.placement, seed)), 0.05) << seed;
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
