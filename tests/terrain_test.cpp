// Instances stand on the terrain: compared with a scalar implementation in double precision.
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/subset.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace throng::test {
namespace {

const InSubset kTerrainInSubsets({Subset::kGpuAssisted}, {"Terrain.*"});
const InSubset kTerrainNatively({Subset::kNative}, {"Terrain.*"});

float between(Random& random, double least, double most) {
    return static_cast<float>(least + (most - least) * random.unit());
}

double height_reference(const Terrain& terrain, double x, double z) {
    const auto split = [&](double place, double first, uint32_t count) {
        const double at = std::clamp((place - first) / double{terrain.spacing}, 0.0, count - 1.0);
        const auto low = static_cast<uint32_t>(at);
        return std::tuple{low, std::min(low + 1, count - 1), at - low};
    };
    const auto [left, right, along_x] = split(x, terrain.x, terrain.columns);
    const auto [near, far, along_z] = split(z, terrain.z, terrain.rows);
    const auto height = [&](uint32_t row, uint32_t column) {
        return double{terrain.heights[row * terrain.columns + column]};
    };
    return (1 - along_z) * ((1 - along_x) * height(near, left) + along_x * height(near, right)) +
           along_z * ((1 - along_x) * height(far, left) + along_x * height(far, right));
}

Terrain make_terrain(uint32_t columns, uint32_t rows, Random& random) {
    Terrain terrain{.x = -30, .z = 12, .spacing = 2.5f, .columns = columns, .rows = rows};
    for (uint32_t i = 0; i < columns * rows; ++i) terrain.heights.push_back(between(random, 0, 20));
    return terrain;
}

TEST(Terrain, InstancesStandOnTheTerrain) {
    const Character character = make_character({.joint_count = 5});
    Random random(7);
    const auto expect_standing = [&](uint32_t columns, uint32_t rows, UpdatePath path) {
        const Terrain terrain = make_terrain(columns, rows, random), other = make_terrain(3, 5, random);
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = 200, .terrain = &terrain},
                                         {.character = &character, .instance_count = 3},
                                         {.character = &character, .instance_count = 50, .terrain = &other}},
                              .path = path});
        std::vector<Affine> placements(253);
        for (Affine& placement : placements)
            for (size_t row = 0; row < 3; ++row) placement.row[row][3] = between(random, -60, 60);
        ASSERT_TRUE(crowd.set_placement(crowd.instances(), placements));
        ASSERT_TRUE(crowd.update(0.1f));
        std::vector<Affine> placed;
        for (const Batch& batch : crowd.state().batches) {
            const auto some = download<Affine>(test_device().gpu(), batch[io::kPlacementsBuffer]);
            placed.insert(placed.end(), some.begin(), some.begin() + batch.instance_count);
        }
        ASSERT_EQ(placed.size(), placements.size());
        for (size_t i = 0; i < placed.size(); ++i) {
            const auto& row = placements[i].row;
            const double wanted = i < 200   ? height_reference(terrain, row[0][3], row[2][3])
                                  : i < 203 ? double{row[1][3]}
                                            : height_reference(other, row[0][3], row[2][3]);
            EXPECT_NEAR(placed[i].row[1][3], wanted, 2e-4) << i << " of " << columns << " x " << rows;
            placed[i].row[1][3] = placements[i].row[1][3];
            EXPECT_EQ(placed[i].row, placements[i].row) << "nothing else moves";
        }
    };
    for (const auto& [columns, rows] : {std::pair{30u, 20u}, {1u, 9u}, {4u, 1u}, {1u, 1u}})
        for (const UpdatePath path : {UpdatePath::kAuto, UpdatePath::kDevice}) expect_standing(columns, rows, path);
}

// The crowd that they join had no terrain.
TEST(Terrain, GroupsBringTheirOwn) {
    const Character character = make_character({.joint_count = 2});
    const Terrain hill{.columns = 1, .rows = 1, .heights = {7}};
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 1}}});
    ASSERT_TRUE(crowd.update(0.1f));
    Crowd streamed = create({.groups = {{.character = &character, .instance_count = 1, .terrain = &hill}}});
    ASSERT_TRUE(crowd.add_groups(std::move(streamed)));
    ASSERT_TRUE(crowd.update(0.1f));
    const auto height = [&](uint32_t block) {
        return output<Affine>(crowd.outputs()[block], &OutputBlock::placement, 1)[0].row[1][3];
    };
    EXPECT_EQ(height(0), 0);
    EXPECT_EQ(height(1), 7);
}

TEST(Terrain, InvalidTerrainsAreRefused) {
    const Character character = make_character({.joint_count = 2});
    Terrain terrain{.columns = 2, .rows = 2, .heights = {1, 2, 3}};
    const CrowdSettings settings{.groups = {{.character = &character, .instance_count = 1, .terrain = &terrain}}};
    const auto message = [&] {
        const auto crowd = Crowd::create(test_device(), settings);
        return crowd ? std::string() : crowd.error().text();
    };
    EXPECT_NE(message().find("3 heights for 2 columns and 2 rows"), std::string::npos) << message();
    terrain.heights.push_back(4);
    EXPECT_EQ(message(), "");
    for (const float spacing : {0.0f, -1.0f, NAN, INFINITY, 1e-40f}) {
        terrain.spacing = spacing;
        EXPECT_NE(message().find("spacing"), std::string::npos) << spacing;
    }
    terrain.spacing = 1;
    terrain.heights[2] = NAN;
    EXPECT_NE(message().find("a height is not finite"), std::string::npos) << message();
    terrain = Terrain{.columns = 5, .rows = 0};
    EXPECT_NE(message().find("0 heights for 5 columns and 0 rows"), std::string::npos) << message();
    terrain = Terrain{};
    EXPECT_NE(message().find("0 heights for 0 columns"), std::string::npos) << message();
}

}  // namespace
}  // namespace throng::test
