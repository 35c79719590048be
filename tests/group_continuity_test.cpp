// Groups that are added to a crowd and removed from it: remaining groups go on unaffected, and added ones as if they
// had always been there, bit for bit.
#include "tests/group_contents.h"
#include "tests/kinds.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <numeric>

namespace throng::test {
namespace {

const InSubset kGroupContinuityNatively({Subset::kNative}, {"*GroupContinuity*"});

constexpr uint32_t kGroupContinuityKinds = 7, kCarriers = 2, kCarried = 6;

// Five kinds of groups whose instances are spawned and despawned, some with poses from outside and outfits, some
// attached to others.
struct Groups {
    explicit Groups(UpdatePath path) : settings(kinds.settings(path)) {
        settings.pose_request_capacity = 4;
        for (CrowdGroup& group : settings.groups) {
            group.instance_count = 4;
            group.capacity = 10;
        }
        settings.groups.push_back(
            {.character = &kinds.character, .instance_count = 3, .pose_capacity = 2, .outfits = {{}, {}}});
        settings.groups.push_back(
            {.character = &kinds.character, .instance_count = 4, .sockets = {1}, .is_carried = true});
    }

    // A crowd of `count` kinds, starting with kind `first`.
    Crowd make(uint32_t first = 0, uint32_t count = kGroupContinuityKinds) const {
        CrowdSettings of = settings;
        of.groups = {settings.groups.begin() + first, settings.groups.begin() + first + count};
        return create(of);
    }

    Kinds kinds;
    CrowdSettings settings;
};

std::vector<GroupIndex> numbers(uint32_t first, uint32_t count = kGroupContinuityKinds) {
    std::vector<GroupIndex> all(count);
    std::iota(all.begin(), all.end(), first);
    return all;
}

// Makes random calls as an application does: the same calls for all crowds in the same state. `groups` are the numbers
// that the kinds from `first_kind` on have in the crowd. From the first update on, instances stand on plots from
// `first_plot` on.
class RandomCaller {
public:
    RandomCaller(const Groups& of, std::vector<GroupIndex> groups, uint32_t first_plot, uint32_t first_kind = 0)
        : of_(of), groups_(std::move(groups)), first_plot_(first_plot), first_kind_(first_kind) {}

    void place(Crowd& crowd) const {
        for (size_t i = 0; i < groups_.size(); ++i) {
            uint32_t plot_number = first_plot_ + kPlots * (first_kind_ + static_cast<uint32_t>(i));
            for (const InstanceHandle& one : alive_in(crowd, groups_[i]))
                EXPECT_TRUE(crowd.set_placement(one, plot(plot_number++)));
        }
    }

    void play(Crowd& crowd, uint32_t update) const {
        Random random(update);
        for (size_t i = 0; i < groups_.size(); ++i) {
            const uint32_t kind = first_kind_ + static_cast<uint32_t>(i), group = groups_[i];
            for (const InstanceHandle& one : alive_in(crowd, group)) {
                if (random.chance(0.5)) change(crowd, one, kind, random);
                if (kind < 5 && random.chance(0.1)) {
                    EXPECT_TRUE(crowd.despawn(std::array{one}));
                }
            }
            if (kind < 5 && *crowd.alive_count(group) < 10) {
                EXPECT_TRUE(crowd.spawn(group, std::array{plot(first_plot_ + kPlots * kind + 10 + update)}));
            }
            if (kind == kCarried && first_kind_ <= kCarriers) attach_at_random(crowd, random);
        }
    }

private:
    static constexpr uint32_t kPlots = 200;  // per kind: no instance is spawned where another stands

    void attach_at_random(Crowd& crowd, Random& random) const {
        const std::vector<InstanceHandle> carriers = alive_in(crowd, groups_[kCarriers - first_kind_]);
        const std::vector<InstanceHandle> things = alive_in(crowd, groups_[kCarried - first_kind_]);
        for (uint32_t i = 0; i < things.size(); ++i) {
            if (random.chance(0.5) || carriers.empty()) continue;
            const bool is_second = i > 0 && random.chance(0.4);
            const InstanceHandle carrier = is_second ? things[random.below(i)]
                                                     : carriers[random.below(static_cast<uint32_t>(carriers.size()))];
            const uint32_t socket = random.below(is_second ? 1 : 2);
            EXPECT_TRUE(crowd.attach(things[i], Attachment{.carrier = carrier, .socket = socket}));
        }
    }

    void change(Crowd& crowd, const InstanceHandle& one, uint32_t kind, Random& random) const {
        const Vec3<float> near{static_cast<float>(random.between(0, 9)), 1, static_cast<float>(random.between(0, 9))};
        const std::vector<Trs<float>> pose(of_.kinds.character.rig.rest);
        const float fade_s = static_cast<float>(random.between(0, 0.3f));
        Result<void> done;
        if (kind == 1 || kind == 2) {
            const auto [parameter, value] = random_change(random, kind == 1 ? of_.kinds.walker : of_.kinds.dragon);
            done = crowd.set_parameter(one, parameter, value);
        } else {
            done = crowd.set_playback(one, random_playback(random, of_.kinds.character));
        }
        EXPECT_TRUE(done) << refusal(done);
        if (kind == 0) done = random.chance(0.6) ? crowd.set_pose(one, pose, fade_s) : crowd.clear_pose(one, fade_s);
        if (kind == 3) done = crowd.set_target(one, 0, {near, 0.5f});
        if (kind == 4) done = crowd.set_destination(one, near);
        if (kind == 5) done = crowd.set_look(one, {.outfit = random.below(2)});
        EXPECT_TRUE(done) << refusal(done);
    }

    const Groups& of_;
    std::vector<GroupIndex> groups_;
    uint32_t first_plot_, first_kind_;
};

void update(Crowd& crowd, uint32_t number) {
    Random random(1000 + number);
    CrowdView view = view_of_box({static_cast<float>(random.between(0, 9000)), 0, 0}, 30'000);
    const auto step_s = static_cast<float>(random.between(0, 0.1f));
    const Result<void> updated = crowd.update(step_s, number % 3 == 0 ? nullptr : &view);
    ASSERT_TRUE(updated) << refusal(updated);
}

// Events and watched instances of those with numbers below `end`.
std::vector<std::byte> told_of(Crowd& crowd, uint32_t end) {
    UpdateBits told;
    const Feedback feedback = feedback_of(crowd);
    for (const CharacterEvent& event : feedback.events)
        if (event.instance.instance < end) told.add(std::array{event});
    for (const WatchedInstance& one : feedback.watched) {
        told.add(std::array{one.instance});
        told.add(one.parameters);
        told.add(one.sockets);
        for (const auto& layer : one.layers) told.add(layer);
    }
    return told.all;
}

class GroupContinuity : public testing::TestWithParam<UpdatePath> {
protected:
    const Groups groups_{GetParam()};
};

TEST_P(GroupContinuity, GroupChangesDoNotAffectOtherGroups) {
    Crowd crowd = groups_.make(), undisturbed = groups_.make();
    const RandomCaller ours(groups_, numbers(0), 0);
    const uint32_t end = crowd.instance_count();
    std::vector<GroupIndex> others;
    for (Crowd* const one : {&crowd, &undisturbed}) {
        ours.place(*one);
        EXPECT_TRUE(one->set_wind({.velocity = {1, 0, 2}, .gust = 0.5f}));
    }
    size_t told_bytes = 0;
    for (uint32_t number = 0; number < 16; ++number) {
        for (Crowd* const one : {&crowd, &undisturbed}) {
            ours.play(*one, number);
            ASSERT_TRUE(one->watch(alive_in(*one, 2)));
            ASSERT_TRUE(one->request_poses(alive_in(*one, 0).front()));
        }
        if (number == 4) {
            Crowd other = groups_.make();
            const RandomCaller theirs(groups_, numbers(0), 2000);
            theirs.place(other);
            theirs.play(other, 77);
            others = crowd.add_groups(std::move(other)).value();
            EXPECT_EQ(others, numbers(kGroupContinuityKinds));
        }
        if (number == 7 || number == 9) {
            for (size_t i = number == 7 ? 0 : 2; i < (number == 7 ? 2 : others.size()); ++i)
                ASSERT_TRUE(crowd.remove_group(others[i]));
            EXPECT_EQ(crowd.instance_count() == end, number == 9);
        }
        for (Crowd* const one : {&crowd, &undisturbed}) update(*one, number);
        expect_same(contents_of_groups(undisturbed, numbers(0)), contents_of_groups(crowd, numbers(0)),
                    "update " + std::to_string(number));
        const std::vector<std::byte> told = told_of(undisturbed, end);
        told_bytes += told.size();
        EXPECT_EQ(told, told_of(crowd, end)) << number;
    }
    EXPECT_GT(told_bytes, 1000u);
    EXPECT_EQ(crowd.outputs().size(), undisturbed.outputs().size());
}

// Groups are added to a running crowd, and into the gap that removed ones have left.
TEST_P(GroupContinuity, AddedGroupsMatchASeparateCrowd) {
    Crowd crowd = groups_.make();
    const RandomCaller ours(groups_, numbers(0), 0), own(groups_, numbers(0), 2000);
    ours.place(crowd);
    for (uint32_t number = 0; number < 3; ++number) update(crowd, number);
    for (uint32_t time = 0; time < 2; ++time) {
        const auto make_other = [&] {
            Crowd other = groups_.make();
            own.place(other);
            own.play(other, 77);
            return other;
        };
        Crowd alone = make_other();
        const std::vector<GroupIndex> numbers_here = crowd.add_groups(make_other()).value();
        EXPECT_EQ(numbers_here, numbers(kGroupContinuityKinds));
        const RandomCaller theirs(groups_, numbers_here, 2000);
        for (uint32_t number = 10 * time; number < 10 * time + 8; ++number) {
            ours.play(crowd, number);
            theirs.play(crowd, number + 100);
            own.play(alone, number + 100);
            for (Crowd* const one : {&crowd, &alone}) update(*one, number);
            expect_same(contents_of_groups(alone, numbers(0)), contents_of_groups(crowd, numbers_here),
                        "update " + std::to_string(number));
        }
        for (const uint32_t group : numbers_here) ASSERT_TRUE(crowd.remove_group(group));
    }
}

// With agents that meet, and things attached to sockets of the crowd that the groups join.
TEST_P(GroupContinuity, GroupsAddedBeforeTheFirstUpdateMatchOneCrowd) {
    Crowd whole = groups_.make(), crowd = groups_.make(0, 5);
    EXPECT_EQ(crowd.add_groups(groups_.make(5, 2)).value(), numbers(5, 2));
    const RandomCaller caller(groups_, numbers(0), 0);
    for (Crowd* const one : {&whole, &crowd}) {
        caller.place(*one);
        const std::vector<InstanceHandle> agents = alive_in(*one, 4);
        for (size_t i = 0; i < agents.size(); ++i) {
            const float x = 3 * static_cast<float>(i);
            EXPECT_TRUE(one->set_placement(agents[i], to_affine(Trs<float>{.translation = {x, 0, 0}})));
            EXPECT_TRUE(one->set_destination(agents[i], {9 - x, 0, 0}));
        }
    }
    EXPECT_EQ(whole.instance_count(), crowd.instance_count());
    for (uint32_t number = 0; number < 8; ++number) {
        if (number > 0)
            for (Crowd* const one : {&whole, &crowd}) caller.play(*one, number);
        for (Crowd* const one : {&whole, &crowd}) update(*one, number);
        expect_same(contents_of(whole.outputs()), contents_of(crowd.outputs()), "update " + std::to_string(number));
    }
}

// Restored in a crowd whose groups are in the same places, but were there from the beginning.
TEST_P(GroupContinuity, SavedStatesWorkAfterGroupChanges) {
    const auto grown = [&](bool goes_on) {
        Crowd crowd = groups_.make(0, 3);
        if (goes_on) update(crowd, 0);
        EXPECT_TRUE(crowd.add_groups(groups_.make(3, 2)));
        if (goes_on) update(crowd, 1);
        EXPECT_TRUE(crowd.remove_group(1));
        EXPECT_TRUE(crowd.add_groups(groups_.make(5, 2)));
        return crowd;
    };
    Crowd crowd = grown(true), other = grown(false);
    for (uint32_t number = 2; number < 5; ++number) update(crowd, number);
    const std::vector<std::byte> saved = crowd.save_state().value();
    ASSERT_TRUE(other.restore_state(saved));
    EXPECT_TRUE(other.save_state().value() == saved);
    for (uint32_t number = 5; number < 9; ++number) {
        for (Crowd* const one : {&crowd, &other}) update(*one, number);
        expect_same(contents_of(crowd.outputs()), contents_of(other.outputs()), "update " + std::to_string(number));
    }
    EXPECT_FALSE(groups_.make().restore_state(saved));
}

INSTANTIATE_TEST_SUITE_P(OnPath, GroupContinuity,
                         testing::Values(UpdatePath::kAuto, UpdatePath::kDevice, UpdatePath::kStaged),
                         [](const testing::TestParamInfo<UpdatePath>& of) {
                             return of.param == UpdatePath::kAuto     ? "Auto"
                                    : of.param == UpdatePath::kDevice ? "Device"
                                                                      : "Staged";
                         });

}  // namespace
}  // namespace throng::test
