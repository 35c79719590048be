// Instances that are spawned behave as those of a crowd that was created when they were spawned.
#include "tests/kernel_runner.h"
#include "tests/kinds.h"
#include "tests/lively_crowd.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace throng::test {
namespace {

// A crowd, and for each cohort of instances spawned at the same time another crowd, created then, with no other
// instances.
class CrowdWithCohorts {
public:
    explicit CrowdWithCohorts(UpdatePath path) : path_(path) {
        CrowdSettings settings = kinds_.settings(path);
        for (CrowdGroup& group : settings.groups) group.capacity = kGroupCapacity;
        crowd_ = create(settings);
    }

    void spawn(Random& random) {
        CrowdSettings settings = kinds_.settings(path_);
        Cohort cohort{Crowd(nullptr), {}};
        std::vector<Affine> places;
        for (uint32_t group = 0; group < settings.groups.size(); ++group) {
            const uint32_t room = kGroupCapacity - *crowd_.alive_count(group),
                           count = std::min(room, 1 + random.below(8));
            std::vector<Affine> of_group;
            for (uint32_t i = 0; i < count; ++i) of_group.push_back(plot(plot_count_++));
            const Result<std::vector<InstanceHandle>> handles = crowd_.spawn(group, of_group);
            ASSERT_TRUE(handles) << refusal(handles);
            ASSERT_EQ(handles->size(), count);
            settings.groups[group].instance_count = count;
            for (const InstanceHandle& handle : *handles) {
                EXPECT_TRUE(numbers_.insert({handle.instance, handle.generation}).second) << "a handle of another";
                reused_count += handle.generation > 0;
                cohort.members.push_back({group, handle});
            }
            places.insert(places.end(), of_group.begin(), of_group.end());
        }
        cohort.crowd = create(settings);
        ASSERT_TRUE(cohort.crowd.set_placement(cohort.crowd.instances(), places));
        for (uint32_t i = 0; i < cohort.members.size(); ++i)
            if (random.chance(0.5)) change(random, cohort, i);  // the others have nothing of their predecessors
        cohorts_.push_back(std::move(cohort));
    }

    void despawn(Random& random) {
        std::vector<InstanceHandle> despawned;
        for (Cohort& cohort : cohorts_)
            for (Member& member : cohort.members)
                if (member.is_alive && random.chance(0.3)) {
                    member.is_alive = false;
                    despawned.push_back(member.handle);
                }
        const Result<void> done = crowd_.despawn(despawned);
        ASSERT_TRUE(done) << refusal(done);
        for (const InstanceHandle& handle : despawned) EXPECT_FALSE(crowd_.is_alive(handle));
    }

    void change(Random& random) {
        for (Cohort& cohort : cohorts_)
            for (uint32_t i = 0; i < cohort.members.size(); ++i)
                if (cohort.members[i].is_alive && random.chance(0.3)) change(random, cohort, i);
    }

    void update(float step_s) {
        watch();
        const Result<void> updated = crowd_.update(step_s);
        ASSERT_TRUE(updated) << refusal(updated);
        const Feedback feedback = feedback_of(crowd_);
        std::map<uint32_t, const WatchedInstance*> watched;
        for (const WatchedInstance& one : feedback.watched) watched[one.instance.instance] = &one;
        std::multiset<std::array<uint32_t, 5>> events, wanted_events;
        for (const CharacterEvent& event : feedback.events)
            events.insert({event.instance.instance, event.instance.generation, event.event, event.layer,
                           std::bit_cast<uint32_t>(event.time_s)});
        std::set<uint32_t> alive;
        for (Cohort& cohort : cohorts_) {
            ASSERT_TRUE(cohort.crowd.update(step_s));
            const Feedback wanted = feedback_of(cohort.crowd);
            for (const CharacterEvent& event : wanted.events) {
                const Member& member = cohort.members[event.instance.instance];
                if (member.is_alive)
                    wanted_events.insert({member.handle.instance, member.handle.generation, event.event, event.layer,
                                          std::bit_cast<uint32_t>(event.time_s)});
            }
            for (uint32_t i = 0; i < cohort.members.size(); ++i) {
                if (!cohort.members[i].is_alive) continue;
                alive.insert(cohort.members[i].handle.instance);
                expect_same(cohort, i);
            }
            for (const WatchedInstance& one : wanted.watched) {
                const Member& member = cohort.members[one.instance.instance];
                if (member.is_alive) expect_same(*watched.at(member.handle.instance), one, member);
            }
        }
        EXPECT_EQ(events, wanted_events);
        event_count += events.size();
        std::set<uint32_t> drawn;
        for (const DrawnInstance& one : drawn_of(crowd_)) drawn.insert(one.instance);
        EXPECT_EQ(drawn, alive);
    }

    size_t event_count = 0, compared_count = 0, watched_count = 0, reused_count = 0;

private:
    struct Member {
        uint32_t group = 0;
        InstanceHandle handle;
        bool is_alive = true;
    };
    struct Cohort {
        Crowd crowd;
        std::vector<Member> members;
    };

    void watch() {
        std::vector<InstanceHandle> some;
        for (Cohort& cohort : cohorts_) {
            for (const Member& member : cohort.members)
                if (member.is_alive) some.push_back(member.handle);
            EXPECT_TRUE(cohort.crowd.watch(cohort.crowd.instances()));
        }
        EXPECT_TRUE(crowd_.watch(some));
    }

    // Makes the same change in both crowds.
    void change(Random& random, Cohort& cohort, uint32_t number) {
        const Member& member = cohort.members[number];
        const Playback playback = random_playback(random, kinds_.character);
        const std::vector<Trs<float>> pose(kinds_.character.rig.rest);
        const auto fade_s = static_cast<float>(random.between(0, 0.3));
        const auto [walk, walked] = random_change(random, kinds_.walker);
        const auto [fly, flown] = random_change(random, kinds_.dragon);
        const Vec3<float> aside = random.vector(20).as<float>();
        const bool clears = random.chance(0.3);
        for (const auto& [crowd, one] :
             {std::pair(&crowd_, member.handle), std::pair(&cohort.crowd, InstanceHandle{number})}) {
            Result<void> done;
            const Affine place = plot(member.handle.instance);
            const Vec3<float> goal{place.row[0][3] + aside.x, 0, place.row[2][3] + aside.z};
            switch (member.group) {
                case 0:
                    done = crowd->set_playback(one, playback);
                    if (done) done = clears ? crowd->clear_pose(one, fade_s) : crowd->set_pose(one, pose, fade_s);
                    break;
                case 1: done = crowd->set_parameter(one, walk, walked); break;
                case 2: done = crowd->set_parameter(one, fly, flown); break;
                case 3:
                    done = crowd->set_playback(one, playback);
                    if (done) done = crowd->set_target(one, 0, {goal, 0.5f});
                    break;
                default: done = clears ? crowd->clear_destination(one) : crowd->set_destination(one, goal);
            }
            EXPECT_TRUE(done) << refusal(done);
        }
    }

    void expect_same(Cohort& cohort, uint32_t number) {
        const Member& member = cohort.members[number];
        const Result<std::vector<Affine>> got = crowd_.read_skin_matrices(member.handle);
        ASSERT_TRUE(got) << refusal(got);
        EXPECT_TRUE(same_bits(*got, *cohort.crowd.read_skin_matrices({number})))
            << group_name(member.group) << ", instance " << member.handle.instance << " of generation "
            << member.handle.generation;
        ++compared_count;
    }

    void expect_same(const WatchedInstance& got, const WatchedInstance& wanted, const Member& member) {
        const std::string where = group_name(member.group) + ", instance " + std::to_string(member.handle.instance);
        EXPECT_EQ(got.instance, member.handle) << where;
        EXPECT_EQ(got.world_from_model.row, wanted.world_from_model.row) << where;
        EXPECT_EQ(copy_of(got.parameters), copy_of(wanted.parameters)) << where;
        EXPECT_EQ(copy_of(got.layers), copy_of(wanted.layers)) << where;
        EXPECT_TRUE(same_bits(got.sockets, wanted.sockets)) << where;
        ++watched_count;
    }

    UpdatePath path_;
    Kinds kinds_;
    Crowd crowd_;
    std::vector<Cohort> cohorts_;
    uint32_t plot_count_ = 0;
    std::set<std::pair<uint32_t, uint32_t>> numbers_;
};

class PopulationOnPath : public testing::TestWithParam<UpdatePath> {};

TEST_P(PopulationOnPath, SpawnedInstancesMatchThoseOfANewCrowd) {
    CrowdWithCohorts crowds(GetParam());
    Random random(3);
    for (int update = 0; update < 24; ++update) {
        if (update % 4 == 1 || update == 14) crowds.despawn(random);  // some despawn and spawn between two updates
        if (update % 4 < 2 && update < 18) crowds.spawn(random);
        crowds.change(random);
        crowds.update(update % 7 == 3 ? 0 : static_cast<float>(random.between(0, 0.1)));
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(crowds.event_count, 5u);
    EXPECT_GT(crowds.compared_count, 500u);
    EXPECT_GT(crowds.watched_count, 300u);
    EXPECT_GT(crowds.reused_count, 30u);
}

INSTANTIATE_TEST_SUITE_P(Population, PopulationOnPath,
                         testing::Values(UpdatePath::kAuto, UpdatePath::kDevice, UpdatePath::kStaged), path_name);

}  // namespace
}  // namespace throng::test
