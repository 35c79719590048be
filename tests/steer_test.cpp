// Agents: each step against the reference, the same bytes in any instance order, and that crowds reach their
// destinations.
#include "control/root_motion_reference.h"
#include "crowd/crowd_state.h"
#include "steer/steer_reference.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/subset.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace throng::test {
namespace {

const InSubset kSteerInSubsets({Subset::kGpuAssisted, Subset::kSubgroups}, {"Steer.CrossingCrowdsPassEachOther"});
const InSubset kSteerNatively({Subset::kNative}, {"Steer.*"});

constexpr float kWalk = 1.3f;  // units a second, of the clip

// A small character, whose first clip walks ahead if `walks`.
Character body(bool walks) {
    Character character = make_character({.name = "body", .joint_count = 2});
    if (!walks) return character;
    character.root_rows = {{0, 0, 1, 0}, {0, kWalk * character.clips[0].duration_s, 1, 0}};
    character.clips[0].first_root_row = 0;
    character.clips[0].root_row_count = 2;
    return character;
}

// A controller whose parameter sets the walking speed.
Controller walker(const Character& character) {
    return {.name = "walker",
            .parameters = {{.name = "alert"}, {.name = "speed"}},
            .layers = {{.name = "body",
                        .states = {{.name = "walk",
                                    .points = {{.clip = character.clips[0].name}},
                                    .speed = 1 / kWalk,
                                    .speed_parameter = "speed"}}}}};
}
constexpr uint32_t kSpeed = 1;

template <class T>
std::vector<T> all_of(Crowd& crowd, BufferView OutputBlock::*member, uint32_t per_instance = 1) {
    std::vector<T> all;
    for (const OutputBlock& block : crowd.outputs()) {
        const uint32_t count = block.instance_count * per_instance;
        const std::vector<T> part = has_output(block, member) ? output<T>(block, member, count, crowd.state().gpu)
                                                              : std::vector<T>(count);
        all.insert(all.end(), part.begin(), part.end());
    }
    return all;
}
std::vector<Affine> placements_of(Crowd& crowd) { return all_of<Affine>(crowd, &OutputBlock::placement); }

Affine turned_at(double x, double z, double yaw = 0, double scale = 1) {
    return to_affine(Trs<double>{axis_angle(Vec3<double>{0, 1, 0}, yaw), {x, 0, z}, {scale, scale, scale}}).as<float>();
}

double apart(const Affine& a, const Affine& b) {
    return std::hypot(double{a.row[0][3]} - b.row[0][3], double{a.row[2][3]} - b.row[2][3]);
}

void send(Crowd& crowd, const std::vector<std::optional<Vec3<float>>>& destinations) {
    for (uint32_t i = 0; i < destinations.size(); ++i) {
        if (!destinations[i]) continue;
        EXPECT_TRUE(crowd.set_destination(InstanceHandle{i}, *destinations[i]));
    }
}

// A crowd, and the reference's result for each of its updates.
class Followed {
public:
    Followed(const CrowdSettings& settings, const std::vector<Affine>& places,
             const std::vector<std::optional<Vec3<float>>>& destinations)
        : crowd_(create(settings)), destinations_(destinations) {
        EXPECT_TRUE(crowd_.set_placement(crowd_.instances(), places));
        send(crowd_, destinations);
        for (const CrowdGroup& group : settings.groups) groups_.insert(groups_.end(), group.instance_count, group);
        before_ = places;
        states_.assign(places.size(), {.speed = 0, .patience = 1, .stands = 0});
    }

    void step(float time_step_s) {
        ASSERT_TRUE(crowd_.update(time_step_s));
        const std::vector<Affine> after = placements_of(crowd_);
        const std::vector<io::AgentState> states = states_now();
        const std::vector<io::vec4> roots = all_of<io::vec4>(crowd_, &OutputBlock::root,
                                                             sizeof(io::RootState) / sizeof(io::vec4));
        const std::vector<float> parameters = all_of<float>(crowd_, &OutputBlock::parameter, 2);
        std::vector<SteeredAgent> agents;
        std::vector<uint32_t> who;
        for (uint32_t i = 0; i < after.size(); ++i) {
            if (!groups_[i].steering) {
                EXPECT_EQ(after[i], before_[i]);
                continue;
            }
            SteeredAgent agent{.steering = *groups_[i].steering,
                               .is_carried = is_carried(i),
                               .world_from_model = is_carried(i) ? before_[i].as<double>() *
                                                                       move_of(roots[i * roots.size() / after.size()])
                                                                 : before_[i].as<double>(),
                               .destination = {},
                               .speed = double{states_[i].speed},
                               .patience = double{states_[i].patience},
                               .stands = states_[i].stands != 0};
            if (destinations_[i]) agent.destination = destinations_[i]->as<double>();
            agents.push_back(agent);
            who.push_back(i);
        }
        const std::vector<SteeredAgent> wanted = steer_reference(agents, double{time_step_s});
        for (size_t k = 0; k < who.size(); ++k) {
            const uint32_t i = who[k];
            SCOPED_TRACE("instance " + std::to_string(i));
            // Positions are stored as floats
            const double extent = std::max(std::abs(double{before_[i].row[0][3]}),
                                           std::abs(double{before_[i].row[2][3]}));
            const double scale = length(Vec3<double>{wanted[k].world_from_model.row[0][2],
                                                     wanted[k].world_from_model.row[1][2],
                                                     wanted[k].world_from_model.row[2][2]}),
                         speed = double{groups_[i].steering->speed};
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column) {
                    const double value = wanted[k].world_from_model.row[row][column];
                    EXPECT_NEAR(after[i].row[row][column], value,
                                column == 3 ? 1e-4 * speed * double{time_step_s} + 3e-7 * (extent + 10) : 1e-3 * scale)
                        << row << ", " << column;
                }
            EXPECT_NEAR(states[i].speed, wanted[k].speed, 1e-3 * speed);
            EXPECT_NEAR(states[i].patience, wanted[k].patience, 1e-5);
            EXPECT_EQ(states[i].stands != 0, wanted[k].stands);
            moved_ += apart(after[i], before_[i]);
            standing_ += wanted[k].stands;
            impatient_ += wanted[k].patience < 1;
            if (groups_[i].steering->speed_parameter == kNone || !destinations_[i]) continue;
            EXPECT_NEAR(parameters[2 * i + kSpeed], wanted[k].model_speed(), 1e-3 * speed / scale);
        }
        before_ = after;
        states_ = states;
    }

    double moved() const { return moved_; }
    uint64_t standing() const { return standing_; }
    uint64_t impatient() const { return impatient_; }

private:
    bool is_carried(uint32_t i) const {
        return groups_[i].controller && groups_[i].moves_placements && !groups_[i].character->root_rows.empty();
    }
    // The root motion of an update: the first of an instance's five rows.
    static AffineT<double> move_of(const io::vec4& m) {
        AffineT<double> move;
        move.row = {{{m.z, 0, m.w, m.x}, {0, 1, 0, 0}, {-m.w, 0, m.z, m.y}}};
        return move;
    }
    std::vector<io::AgentState> states_now() const {
        std::vector<io::AgentState> states;
        for (const Batch& batch : crowd_.state().batches) {
            const std::vector<io::AgentState> part = batch[io::kAgentsBuffer]
                                                         ? download<io::AgentState>(crowd_.state().gpu,
                                                                                    batch[io::kAgentsBuffer])
                                                         : std::vector<io::AgentState>(batch.instance_count);
            states.insert(states.end(), part.begin(), part.end());
        }
        return states;
    }

    Crowd crowd_;
    std::vector<CrowdGroup> groups_;  // [instances]
    std::vector<std::optional<Vec3<float>>> destinations_;
    std::vector<Affine> before_;
    std::vector<io::AgentState> states_;
    double moved_ = 0;
    uint64_t standing_ = 0, impatient_ = 0;
};

// Agents of several kinds and sizes, close together; some on the borders of cells, at the same place, at
// their destination or without one, mirrored or leaning.
struct Mixture {
    static constexpr uint32_t kCounts[] = {90, 5, 40, 60};
    Character still = body(false), walking = body(true);
    Controller controller = walker(walking);
    CrowdSettings settings{
        .groups = {{.character = &still, .instance_count = kCounts[0], .steering = Steering{}},
                   {.character = &still, .instance_count = kCounts[1]},
                   {.character = &walking,
                    .instance_count = kCounts[2],
                    .controller = &controller,
                    .steering = Steering{.radius = 0.5f, .speed = 2, .turn = 2, .speed_parameter = kSpeed}},
                   {.character = &walking,
                    .instance_count = kCounts[3],
                    .controller = &controller,
                    .moves_placements = false,
                    .steering = Steering{.radius = 0.2f, .speed = 0.9f, .turn = 5, .speed_parameter = kSpeed}}}};
    std::vector<Affine> places;
    std::vector<std::optional<Vec3<float>>> destinations;

    Mixture(double x, double z, uint64_t seed) {
        constexpr double kExtent = 6, kCell = 2;  // four times the largest radius
        Random random(seed);
        for (const uint32_t count : kCounts)
            for (uint32_t i = 0; i < count; ++i) {
                const auto away = [&] {
                    return random.chance(0.1) ? kCell * (static_cast<double>(random.below(5)) - 2)
                                              : random.between(-kExtent, kExtent);
                };
                Trs<double> place{axis_angle(Vec3<double>{0, 1, 0}, random.between(-3, 3)),
                                  {x + away(), random.between(-1, 1), z + away()},
                                  {}};
                place.scale = Vec3<double>{1, 1, 1} * random.between(0.5, 2);
                if (random.chance(0.2)) place.scale.x = -place.scale.x;
                if (random.chance(0.2)) place.rotation = place.rotation * axis_angle(random.direction(), 0.4);
                places.push_back(random.chance(0.05) && !places.empty()
                                     ? places[random.below(static_cast<uint32_t>(places.size()))]
                                     : to_affine(place).as<float>());
                const Vec3<double> far{x + random.between(-20, 20), random.between(-1, 1), z + random.between(-20, 20)};
                const auto& row = places.back().row;
                if (random.chance(0.1))
                    destinations.push_back({});
                else
                    destinations.push_back(random.chance(0.2) ? Vec3<float>{row[0][3], 5, row[2][3]} : far.as<float>());
            }
        for (uint32_t i = kCounts[0]; i < kCounts[0] + kCounts[1]; ++i) destinations[i].reset();
    }
};

void follow_steering(double x, double z, uint64_t seed) {
    const Mixture mixture(x, z, seed);
    Followed followed(mixture.settings, mixture.places, mixture.destinations);
    for (int update = 0; update < 14 && !::testing::Test::HasFailure(); ++update) {
        SCOPED_TRACE("update " + std::to_string(update));
        followed.step(update == 9 ? 1.5f : 0.1f);
    }
    EXPECT_GT(followed.moved(), 50);
    EXPECT_GT(followed.standing(), 50u);
    EXPECT_GT(followed.impatient(), 50u);
}

TEST(Steer, FollowsTheReference) { follow_steering(0, 0, 1); }
TEST(Steer, FollowsTheReferenceFarFromTheOrigin) { follow_steering(400, -1000, 2); }

// With a few large agents near and far, the small ones avoid each other as without them.
TEST(Steer, SmallAgentsAvoidEachOtherBesideLargeOnes) {
    constexpr uint32_t kSmall = 400, kLarge = 3;
    constexpr float kRadius = 0.1f;
    const Character character = body(false);
    const CrowdSettings settings{
        .groups = {
            {.character = &character, .instance_count = kSmall, .steering = Steering{.radius = kRadius, .speed = 0.7f}},
            {.character = &character, .instance_count = kLarge, .steering = Steering{.radius = 4, .speed = 2}}}};
    std::vector<Affine> places;
    std::vector<std::optional<Vec3<float>>> destinations;
    for (uint32_t i = 0; i < kSmall; ++i) {
        const double x = 0.5 * (i % 20) - 5, z = 0.5 * (i / 20) - 5, toward = i % 2 == 0 ? 1 : -1;
        places.push_back(turned_at(x, z, toward * 1.57));
        destinations.push_back(Vec3<double>{x + 4 * toward, 0, z}.as<float>());
    }
    for (const double x : {-9.0, 9.5, 130.0}) {
        places.push_back(turned_at(x, 0));
        destinations.push_back(x < 0 ? std::optional(Vec3<float>{20, 0, 0}) : std::nullopt);
    }
    Followed followed(settings, places, destinations);
    for (int update = 0; update < 12 && !::testing::Test::HasFailure(); ++update) followed.step(0.1f);
    Crowd crowd = create(settings);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    send(crowd, destinations);
    double nearest = 1;
    for (int update = 0; update < 100; ++update) {
        ASSERT_TRUE(crowd.update(0.05f));
        const std::vector<Affine> now = placements_of(crowd);
        for (uint32_t i = 0; i < kSmall; ++i)
            for (uint32_t k = 0; k < i; ++k) nearest = std::min(nearest, apart(now[i], now[k]) / (2 * double{kRadius}));
    }
    EXPECT_GT(nearest, 0.74);
}

TEST(Steer, EachGridHoldsAgentsOfSimilarSize) {
    const std::vector<AgentGrid> grids = agent_grids({0.3f, 4, 0.2f, 0.3f, 2.1f, 2, 0.15f});
    std::vector<float> largest;
    for (const AgentGrid& grid : grids) largest.push_back(grid.largest);
    EXPECT_EQ(largest, (std::vector{4.0f, 2.0f, 0.3f, 0.15f}));
    EXPECT_EQ(grid_of(grids, 2.1f), 0u);
    EXPECT_EQ(grid_of(grids, 2), 1u);
    EXPECT_EQ(grid_of(grids, 0.2f), 2u);
    EXPECT_EQ(grid_of(grids, 0.15f), 3u);
    std::vector<float> many;
    for (float radius = 1000; radius > 0.01f; radius /= 2) many.push_back(radius);
    const std::vector<AgentGrid> of_many = agent_grids(many);
    EXPECT_EQ(of_many.size(), io::kAgentGridLimit);
    EXPECT_EQ(grid_of(of_many, many.back()), io::kAgentGridLimit - 1) << "with all that are smaller";
}

TEST(Steer, FastAgentsArrive) {
    const Character character = body(false);
    for (const float speed : {1.4f, 8.0f, 60.0f, 1000.0f}) {
        Crowd crowd = create({.groups = {{.character = &character,
                                          .instance_count = 1,
                                          .steering = Steering{.radius = 0.3f, .speed = speed, .turn = 6}}}});
        ASSERT_TRUE(crowd.set_placement(crowd.instances(), std::vector{turned_at(0, 0, 1)}));
        ASSERT_TRUE(crowd.set_destination(crowd.instances(), std::vector{Vec3<float>{5, 0, 0}}));
        for (int update = 0; update < 300; ++update) ASSERT_TRUE(crowd.update(0.05f));
        EXPECT_LT(std::abs(placements_of(crowd)[0].row[0][3] - 5), 0.3f) << speed;
    }
}

TEST(Steer, EveryRunAndBatchSizeGivesTheSameBytes) {
    const Mixture mixture(-3, 7, 3);
    Crowd whole = create(mixture.settings), again = create(mixture.settings);
    Result<Crowd> parts = Crowd::create(device_of_workgroups(13), mixture.settings);
    ASSERT_TRUE(parts) << parts.error().text();
    EXPECT_GT(parts->outputs().size(), 10u);
    for (Crowd* crowd : {&whole, &again, &*parts}) {
        ASSERT_TRUE(crowd->set_placement(crowd->instances(), mixture.places));
        send(*crowd, mixture.destinations);
        for (int update = 0; update < 20; ++update) ASSERT_TRUE(crowd->update(0.1f));
    }
    EXPECT_TRUE(same_bits(placements_of(whole), placements_of(again)));
    EXPECT_TRUE(same_bits(placements_of(whole), placements_of(*parts)));
}

// Agents of a bucket are visited in another order. Numbers matter only between agents at the same place.
TEST(Steer, InstanceOrderDoesNotChangeResults) {
    constexpr uint32_t kCount = 100;
    const Character character = body(false);
    Random random(6);
    std::vector<Affine> places;
    std::vector<Vec3<float>> destinations;
    for (uint32_t i = 0; i < kCount; ++i) {
        places.push_back(turned_at(random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)));
        destinations.push_back(Vec3<double>{random.between(-9, 9), 0, random.between(-9, 9)}.as<float>());
    }
    const auto walked = [&] {
        Crowd crowd = create({.groups = {{.character = &character, .instance_count = kCount, .steering = Steering{}}}});
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places) &&
                    crowd.set_destination(crowd.instances(), destinations));
        for (int update = 0; update < 40; ++update) EXPECT_TRUE(crowd.update(0.05f));
        return placements_of(crowd);
    };
    const std::vector<Affine> forwards = walked();
    std::ranges::reverse(places);
    std::ranges::reverse(destinations);
    std::vector<Affine> backwards = walked();
    std::ranges::reverse(backwards);
    EXPECT_TRUE(same_bits(forwards, backwards));
}

// Runs until all agents stand at their destinations or `seconds` have passed. Returns how far any two came closer than
// the sum of their radii, as a fraction of it.
double walk_home(Crowd& crowd, std::span<const Vec3<float>> destinations, float radius, double seconds,
                 bool begins_apart = true) {
    double worst = 0;
    for (double passed_s = 0; passed_s < seconds; passed_s += 0.05) {
        EXPECT_TRUE(crowd.update(0.05f));
        const std::vector<Affine> places = placements_of(crowd);
        bool is_home = true;
        for (size_t i = 0; i < places.size(); ++i) {
            is_home = is_home && std::hypot(places[i].row[0][3] - destinations[i].x,
                                            places[i].row[2][3] - destinations[i].z) <= 2 * radius;
            for (size_t k = 0; begins_apart && k < i; ++k)
                worst = std::max(worst, 1 - apart(places[i], places[k]) / (2 * double{radius}));
        }
        if (is_home) return worst;
    }
    ADD_FAILURE() << "not all have arrived";
    return worst;
}

TEST(Steer, CrossingCrowdsPassEachOther) {
    const Character character = body(false);
    constexpr float kRadius = 0.3f;
    std::vector<Affine> places;
    std::vector<Vec3<float>> destinations;
    Random random(4);
    for (int column = 0; column < 5; ++column)
        for (int row = 0; row < 4; ++row)
            for (const bool north : {false, true}) {  // two groups, one towards +z, the other towards +x
                const double along = 4 + 1.4 * row + random.between(-0.2, 0.2),
                             across = 1.4 * column - 2.8 + random.between(-0.2, 0.2);
                places.push_back(north ? turned_at(across, -along) : turned_at(-along, across));
                destinations.push_back(
                    Vec3<double>{north ? across : 12 - along, 0, north ? 12 - along : across}.as<float>());
            }
    const auto count = static_cast<uint32_t>(places.size());
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = count, .steering = Steering{.radius = kRadius}}}});
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places) &&
                crowd.set_destination(crowd.instances(), destinations));
    EXPECT_LE(walk_home(crowd, destinations, kRadius, 60), 0.25 + 1e-4);
}

TEST(Steer, AgentsAtOnePlaceSeparateAndArrive) {
    const Character character = body(false);
    constexpr uint32_t kCount = 24;
    constexpr float kRadius = 0.3f;
    std::vector<Vec3<float>> destinations;
    for (uint32_t i = 0; i < kCount; ++i)
        destinations.push_back(Vec3<double>{5 * std::cos(0.26 * i), 0, 5 * std::sin(0.26 * i)}.as<float>());
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = kCount, .steering = Steering{.radius = kRadius}}}});
    ASSERT_TRUE(crowd.set_destination(crowd.instances(), destinations));
    walk_home(crowd, destinations, kRadius, 60, false);
    const std::vector<Affine> places = placements_of(crowd);
    for (uint32_t i = 0; i < kCount; ++i)
        for (uint32_t k = 0; k < i; ++k) EXPECT_GT(apart(places[i], places[k]), 0.75 * 2 * kRadius);
}

TEST(Steer, RootMotionMovesAgentsThatHaveIt) {
    const Character character = body(true);
    const Controller controller = walker(character);
    const std::vector<Affine> places{turned_at(0, 0, 3), turned_at(5, 0, 1, 2)};
    const std::vector<Vec3<float>> destinations{{0.2f, 0, 6}, {-1, 0, 0.3f}};  // each in the other's way
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = 2,
                                      .controller = &controller,
                                      .steering = Steering{.speed_parameter = kSpeed}}}});
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places) &&
                crowd.set_destination(crowd.instances(), destinations));
    double walked = 0;
    Affine last = places[0];
    for (int update = 0; update < 120; ++update) {
        ASSERT_TRUE(crowd.update(0.1f));
        const Affine now = placements_of(crowd)[0];
        walked += apart(now, last);
        EXPECT_LE(apart(now, last), 0.1 * 1.4 * 1.001);
        last = now;
    }
    const std::vector<Affine> arrived = placements_of(crowd);
    for (uint32_t i = 0; i < 2; ++i)
        EXPECT_LE(std::hypot(arrived[i].row[0][3] - destinations[i].x, arrived[i].row[2][3] - destinations[i].z), 0.3);
    EXPECT_LT(walked, 8);
    EXPECT_EQ(all_of<float>(crowd, &OutputBlock::parameter, 2)[kSpeed], 0);
}

// As if on a slope.
TEST(Steer, LeaningAgentsWalkOverTheGround) {
    const Character character = body(false);
    std::vector<Affine> places;
    for (const double lean : {0.0, -0.5, 0.5, -1.4})
        places.push_back(to_affine(Trs<double>{.rotation = axis_angle(Vec3<double>{1, 0, 0}, lean),
                                               .translation = {10.0 * double(places.size()), 0.25, 0}})
                             .as<float>());
    const auto count = static_cast<uint32_t>(places.size());
    std::vector<std::optional<Vec3<float>>> destinations;
    for (uint32_t i = 0; i < count; ++i) destinations.push_back(Vec3<float>{10.0f * static_cast<float>(i), 0, 40});
    const CrowdSettings settings{
        .groups = {
            {.character = &character, .instance_count = count, .steering = Steering{.radius = 0.4f, .speed = 1.5f}}}};
    Followed followed(settings, places, destinations);
    for (int update = 0; update < 10; ++update) followed.step(0.1f);
    Crowd crowd = create(settings);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    send(crowd, destinations);
    for (int update = 0; update < 40; ++update) ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<Affine> after = placements_of(crowd);
    EXPECT_GT(after[0].row[2][3], 5);
    for (uint32_t i = 0; i < count; ++i) {
        EXPECT_EQ(after[i].row[1][3], 0.25f) << i;
        EXPECT_NEAR(after[i].row[2][3], after[0].row[2][3], 1e-3) << i;
    }
}

TEST(Steer, AgentsWithoutDestinationOrTimeStepDoNotMove) {
    const Mixture mixture(0, 0, 5);
    Crowd crowd = create(mixture.settings);
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), mixture.places));
    for (int update = 0; update < 3; ++update) ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_TRUE(same_bits(placements_of(crowd), mixture.places));
    send(crowd, mixture.destinations);
    for (const float step_s : {0.0f, -0.1f}) ASSERT_TRUE(crowd.update(step_s));
    EXPECT_TRUE(same_bits(placements_of(crowd), mixture.places));
    ASSERT_TRUE(crowd.update(0.1f) && crowd.update(0.1f));
    EXPECT_FALSE(same_bits(placements_of(crowd), mixture.places));
}

TEST(Steer, DestinationsCanBeClearedOrWrittenOnTheGpu) {
    const Character character = body(true);
    const Controller controller = walker(character);
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = 2,
                                      .controller = &controller,
                                      .moves_placements = false,
                                      .steering = Steering{.speed_parameter = kSpeed}}}});
    const std::vector<Affine> places{turned_at(0, 0), turned_at(9, 0)};
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places) &&
                crowd.set_destination(InstanceHandle{0}, Vec3<float>{0, 0, 9}) &&
                crowd.update(0));  // placements can be read from now on
    const auto walk = [&] {
        const std::vector<Affine> before = placements_of(crowd);
        for (int update = 0; update < 10; ++update) EXPECT_TRUE(crowd.update(0.1f));
        const std::vector<Affine> after = placements_of(crowd);
        return std::array{apart(before[0], after[0]), apart(before[1], after[1])};
    };
    EXPECT_GT(walk()[0], 0.5);
    EXPECT_GT(all_of<float>(crowd, &OutputBlock::parameter, 2)[kSpeed], 1);
    ASSERT_TRUE(crowd.clear_destination(Instances::numbered(0, 2)));
    EXPECT_EQ(walk(), (std::array{0.0, 0.0}));
    EXPECT_EQ(all_of<float>(crowd, &OutputBlock::parameter, 2)[kSpeed], 0);
    run_on_gpu([&](VkCommandBuffer commands) {
        const std::array destination{io::vec4{9, 0, 9, 1}};
        record_update(*test_gpu(), commands,
                      output_range(crowd.outputs()[0], &OutputBlock::destination, 0, 2 * sizeof destination),
                      sizeof destination, std::as_bytes(std::span(destination)));
        memory_barrier(*test_gpu(), commands, kTransferWrite, kShaderRead);
    });
    const std::array moved = walk();
    EXPECT_EQ(moved[0], 0);
    EXPECT_GT(moved[1], 0.5);
}

// Otherwise root motion would carry it away.
TEST(Steer, TheSpeedParameterIsZeroWithoutADestination) {
    const Character character = body(true);
    const Controller controller = walker(character);
    Crowd crowd = create({.groups = {{.character = &character,
                                      .instance_count = 2,
                                      .controller = &controller,
                                      .steering = Steering{.speed_parameter = kSpeed}}}});
    ASSERT_TRUE(crowd.set_parameter(crowd.instances(), kSpeed, 1.5f) && crowd.update(0.1f));
    EXPECT_EQ(all_of<float>(crowd, &OutputBlock::parameter, 2)[kSpeed], 0);
    const std::vector<Affine> before = placements_of(crowd);
    for (int update = 0; update < 10; ++update) ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_NEAR(apart(before[0], placements_of(crowd)[0]), 0, 1e-6);
}

// Agents that walk into view are drawn, and those that leave it are not.
TEST(Steer, CullingUsesCurrentPlacements) {
    const Character character = body(false);
    Crowd crowd = create(
        {.groups = {{.character = &character, .instance_count = 2, .steering = Steering{.radius = 2, .speed = 100}}},
         .culling = Culling{}});
    const std::vector<Affine> places{turned_at(0, -400), turned_at(0, 0)};
    ASSERT_TRUE(crowd.set_placement(crowd.instances(), places));
    ASSERT_TRUE(crowd.set_destination(crowd.instances(), std::array{Vec3<float>{0, 0, 0}, Vec3<float>{0, 0, 400}}));
    const CrowdView view = *view_of({.eye = {0, 60, 0.1f}, .target = {0, 0, 0}}, 64, 64, {});
    const auto drawn = [&] {
        std::vector<uint32_t> who;
        for (const DrawnInstance& one : drawn_of(crowd)) who.push_back(one.instance);
        return who;
    };
    ASSERT_TRUE(crowd.update(0.01f, &view));
    EXPECT_EQ(drawn(), std::vector{1u});
    for (int update = 0; update < 250; ++update) ASSERT_TRUE(crowd.update(0.02f, &view));
    EXPECT_EQ(drawn(), std::vector{0u});
}

TEST(Steer, ErrorsNameWhatIsWrong) {
    const Character character = body(false);
    const auto refused = [&](const Steering& steering) {
        return refusal(Crowd::create(
            test_device(), {.groups = {{.character = &character, .instance_count = 1, .steering = steering}}}));
    };
    EXPECT_NE(refused({.radius = 0}).find("radius 0.0"), std::string::npos);
    EXPECT_NE(refused({.radius = kNan}).find("radius"), std::string::npos);
    EXPECT_NE(refused({.speed = -1}).find("speed -1"), std::string::npos);
    EXPECT_NE(refused({.turn = std::numeric_limits<float>::infinity()}).find("turn"), std::string::npos);
    EXPECT_NE(refused({.speed_parameter = 0}).find("speed_parameter 0 is out of range: the group has 0 parameters"),
              std::string::npos);
    Crowd crowd = create({.groups = {{.character = &character, .instance_count = 2, .steering = Steering{}},
                                     {.character = &character, .instance_count = 1}}});
    EXPECT_NE(refusal(crowd.set_destination(Instances::numbered(1, 2), Vec3<float>())).find("instance 2"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.set_destination(Instances::numbered(2, 2), Vec3<float>()))
                  .find("out of range: this crowd's instance numbers are below 3"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.set_destination(InstanceHandle{1}, Vec3<float>{0, kNan, 0}))
                  .find("instance 1: a number is not finite"),
              std::string::npos);
    EXPECT_NE(refusal(crowd.clear_destination(Instances::numbered(0, 3))).find("has no steering"), std::string::npos);
    EXPECT_NE(refusal(crowd.clear_destination(Instances::numbered(1, 0xFFFFFFFF)))
                  .find("out of range: this crowd's instance numbers are below 3"),
              std::string::npos);
}

}  // namespace
}  // namespace throng::test
