// Scattered changes of instances, which are uploaded together, against the same changes uploaded one by one.
#include "tests/contents.h"
#include "tests/kinds.h"
#include "tests/subset.h"

#include <gtest/gtest.h>

#include <set>

namespace throng::test {
namespace {

const InSubset kChangeInSubsets({Subset::kGpuAssisted, Subset::kNative}, {"Changes.*"}),
    kChangeOnOtherDrivers({Subset::kOtherDriver}, {"-Changes.CombinedUploadsEqualSeparateOnes",
                                                   "-Changes.CombinedUploadsOfSpawnsEqualSeparateOnes"});

constexpr uint32_t kEach = 60;  // instances per group; every other one changes, which counts as many

// Groups of all kinds with several looks, and a group of carried instances.
class ChangingCrowd {
public:
    ChangingCrowd() : settings_(kinds_.settings(UpdatePath::kDevice)) {
        settings_.watch_capacity = 0;
        for (CrowdGroup& group : settings_.groups) group.pose_capacity = 0;
        settings_.groups.push_back({.character = &kinds_.character, .is_carried = true});
        for (CrowdGroup& group : settings_.groups) {
            group.instance_count = kEach;
            group.capacity = kEach;
            group.outfits.resize(3);
        }
    }

    Crowd make() const {
        Crowd crowd = Crowd::create(test_device(), settings_).expect();
        for (uint32_t group = 0; group < settings_.groups.size(); ++group) set_as_before(crowd, group);
        EXPECT_TRUE(crowd.update(0));
        return crowd;
    }

    static std::vector<InstanceHandle> of_group(const Crowd& crowd, uint32_t group, uint32_t step) {
        std::vector<InstanceHandle> some;
        for (uint32_t i = 0; i < kEach; i += step)
            some.push_back(crowd.handle(crowd.instances(group)->number(i)).value());
        return some;
    }

    // With `all`, the instances between are also set, to their current values, so that the changes are contiguous.
    void change(Crowd& crowd, bool all) const {
        for (uint32_t group = 0; group < settings_.groups.size(); ++group) {
            if (all) set_as_before(crowd, group);
            set(crowd, group, 2, [](const InstanceHandle& one) { return 1 + one.instance; });
        }
    }

    // With `all`, all are replaced, otherwise every other one. Those with springs stay, since their swinging has to go
    // on.
    void replace(Crowd& crowd, bool all) const {
        constexpr std::array kReplaced{0u, 1u, 2u, 4u};
        std::set<uint32_t> gone;
        for (const uint32_t group : kReplaced) {
            const std::vector<InstanceHandle> some = of_group(crowd, group, all ? 1 : 2);
            EXPECT_TRUE(crowd.despawn(some));
            for (const InstanceHandle& one : some) gone.insert(one.instance);
        }
        EXPECT_TRUE(crowd.update(0));
        const std::vector<DrawnInstance> drawn = crowd.read_drawn().value();
        EXPECT_EQ(drawn.size(), crowd.instance_count() - gone.size());
        for (const DrawnInstance& one : drawn) EXPECT_FALSE(gone.contains(one.instance)) << one.instance;
        for (const uint32_t group : kReplaced) {
            std::vector<Affine> places(all ? kEach : kEach / 2);
            for (uint32_t i = 0; i < places.size(); ++i) places[i] = place_of(all && i % 2 == 1 ? 0 : 1);
            EXPECT_TRUE(crowd.spawn(group, places));
            if (!plays_clips(group)) continue;
            EXPECT_TRUE(crowd.set_playback(of_group(crowd, group, 1), Playback{}));
        }
    }

private:
    static constexpr uint32_t kCarriers = 2, kCarried = 5;
    static bool plays_clips(uint32_t group) { return group == 0 || group > 2; }  // else it has a controller

    // Number 0 is the initial placement.
    static Affine place_of(uint32_t number) { return number == 0 ? Affine{} : plot(number); }

    void set_as_before(Crowd& crowd, uint32_t group) const {
        set(crowd, group, 1, [](const InstanceHandle&) { return 0u; });
    }
    template <class NumberOf>
    void set(Crowd& crowd, uint32_t group, uint32_t step, const NumberOf& number_of) const {
        for (const InstanceHandle& one : of_group(crowd, group, step)) {
            const uint32_t number = number_of(one);
            const float x = static_cast<float>(number);
            Result<void> done = crowd.set_look(one, {.tint = {1 / (1 + x), 1, 1}, .outfit = number % 3});
            EXPECT_TRUE(done) << refusal(done);
            if (group == kCarried) {
                const Attachment hung{
                    .carrier = crowd.handle(crowd.instances(kCarriers)->number(number % kEach)).value(),
                    .socket = number % 2};
                done = number == 0 ? crowd.detach(one) : crowd.attach(one, hung);
                EXPECT_TRUE(done) << refusal(done);
                continue;
            }
            EXPECT_TRUE(crowd.set_placement(one, place_of(number)));
            if (plays_clips(group))
                done = crowd.set_playback(one, {.first = {.clip = 0, .time_s = number * 0.01, .speed = 0.5f + x}});
            EXPECT_TRUE(done) << refusal(done);
            if (group == 3) done = crowd.set_target(one, 0, {{x, 1, 2}, number == 0 ? 0.0f : 0.5f});
            if (group == 4) done = number == 0 ? crowd.clear_destination(one) : crowd.set_destination(one, {x, 0, 2});
            EXPECT_TRUE(done) << refusal(done);
        }
    }

    mutable Kinds kinds_;
    CrowdSettings settings_;
};

void expect_same_outputs(Crowd& a, Crowd& b, const char* where) {
    for (const float time_step_s : {0.0f, 0.05f}) {
        EXPECT_TRUE(a.update(time_step_s));
        EXPECT_TRUE(b.update(time_step_s));
        expect_same(contents_of(a.outputs()), contents_of(b.outputs()), where);
    }
}

TEST(Changes, CombinedUploadsEqualSeparateOnes) {
    const ChangingCrowd changing;
    Crowd apart = changing.make(), together = changing.make();
    const Contents before = contents_of(apart.outputs());
    changing.change(apart, false);
    changing.change(together, true);
    expect_same_outputs(apart, together, "set");
    const Contents after = contents_of(apart.outputs());
    for (const char* name : {"0: skin", "0: placement", "0: look", "3: skin", "4: placement", "5: placement"})
        EXPECT_NE(before.at(name), after.at(name)) << name;
}

TEST(Changes, CombinedUploadsOfSpawnsEqualSeparateOnes) {
    const ChangingCrowd changing;
    Crowd apart = changing.make(), together = changing.make();
    changing.replace(apart, false);
    changing.replace(together, true);
    expect_same_outputs(apart, together, "there");
}

// More changes than one upload holds, among them ranges of one instance and a long one.
TEST(Changes, MayExceedOneUpload) {
    const Character character = creature(2, 2);
    constexpr uint32_t kInstances = 12'000;
    Crowd crowd = Crowd::create(test_device(), {.groups = {{.character = &character, .instance_count = kInstances}},
                                                .path = UpdatePath::kDevice})
                      .expect();
    EXPECT_TRUE(crowd.update(0));
    const auto changes = [](uint32_t instance) { return instance % 2 == 0 || instance < 200; };
    const auto place_of = [&](uint32_t instance) { return plot(changes(instance) ? instance : 0); };
    for (uint32_t i = 0; i < kInstances; ++i) {
        if (!changes(i)) continue;
        EXPECT_TRUE(crowd.set_placement(*crowd.handle(i), place_of(i)));
    }
    EXPECT_TRUE(crowd.update(0));
    for (const OutputBlock& block : crowd.outputs()) {
        const auto placements = output<Affine>(block, &OutputBlock::placement, block.instance_count);
        for (uint32_t i = 0; i < block.instance_count; ++i)
            ASSERT_EQ(placements[i].row, place_of(block.first_instance + i).row) << i;
    }
}

}  // namespace
}  // namespace throng::test
