// Instances that hang on others: each is where its carrier's socket is in the same update.
#include "attach/attach_reference.h"
#include "crowd/crowd_state.h"
#include "tests/crowd_cases.h"
#include "tests/kernel_runner.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

namespace throng::test {
namespace {

const InSubset kInSubsets({Subset::kGpuAssisted}, {"*Attach.*"}), kNatively({Subset::kNative}, {"*Attach.*"});

constexpr uint32_t kBodies = 40, kThings = 30;

class Attach : public testing::TestWithParam<UpdatePath> {
protected:
    // Agents with two sockets, and what they may carry.
    Crowd crowd_of(bool culls = true, const Device& device = test_device()) const {
        CrowdSettings settings{.groups = {{.character = &body_,
                                           .instance_count = kBodies,
                                           .sockets = {body_.rig.joint_count() - 1, 3},
                                           .steering = Steering{.radius = 0.1f, .speed = 2}},
                                          {.character = &thing_, .instance_count = kThings, .is_carried = true}},
                               .path = GetParam()};
        if (culls) {
            settings.culling.emplace();
            settings.groups[0].capacity = kBodies + 5;
            settings.groups[1].capacity = kThings + 5;
        }
        Crowd crowd = Crowd::create(device, settings).expect();
        Random random(7);
        for (const InstanceHandle& body : bodies(crowd)) {
            Trs<double> place = random.trs(1, 0.2);
            place.translation = random.vector(20);
            EXPECT_TRUE(crowd.set_placement(body, to_affine(place).as<float>()));
            EXPECT_TRUE(crowd.set_playback(body, {.first = {.clip = 0, .time_s = random.between(0, 2)}}));
            EXPECT_TRUE(crowd.set_destination(body, random.vector(20).as<float>()));
        }
        return crowd;
    }
    static std::vector<InstanceHandle> bodies(const Crowd& crowd) { return handles(crowd, 0, kBodies); }
    static std::vector<InstanceHandle> things(const Crowd& crowd) { return handles(crowd, 1, kThings); }
    static std::vector<InstanceHandle> handles(const Crowd& crowd, uint32_t group, uint32_t count) {
        std::vector<InstanceHandle> all;
        const uint32_t first = crowd.instances(group)->first();
        for (uint32_t i = 0; i < count; ++i) all.push_back(crowd.handle(first + i).value());
        return all;
    }
    static std::vector<Attachment> random_attachments(const Crowd& crowd, uint64_t seed) {
        Random random(seed);
        std::vector<Attachment> all;
        for (uint32_t i = 0; i < kThings; ++i)
            all.push_back({.carrier = bodies(crowd)[random.below(kBodies)],
                           .socket = static_cast<uint32_t>(random.below(2)),
                           .socket_from_model = to_affine(random.trs(1, 0.5)).as<float>()});
        return all;
    }
    static Affine placement(const Crowd& crowd, const InstanceHandle& of) {
        return read<Affine>(crowd, of, &OutputBlock::placement, 1, 0);
    }
    static Affine socket(const Crowd& crowd, const InstanceHandle& of, uint32_t number) {
        return read<Affine>(crowd, of, &OutputBlock::socket, 2, number);
    }
    template <class T>
    static T read(const Crowd& crowd, const InstanceHandle& of, BufferView OutputBlock::*view, uint32_t stride,
                  uint32_t at) {
        for (const OutputBlock& block : crowd.outputs()) {
            const uint32_t i = of.instance - block.first_instance;
            if (of.instance < block.first_instance || i >= block.instance_count) continue;
            return output<T>(block, view, size_t{block.instance_count} * stride, crowd.state().gpu)[i * stride + at];
        }
        return {};
    }
    void expect_there(const Crowd& crowd, const InstanceHandle& thing, const Attachment& attachment) const {
        const Affine is = placement(crowd, thing);
        const AffineT<double> wanted = placement_on_socket(
            socket(crowd, attachment.carrier, attachment.socket).as<double>(),
            attachment.socket_from_model.as<double>());
        for (size_t row = 0; row < 3; ++row)
            for (size_t column = 0; column < 4; ++column)
                EXPECT_NEAR(double{is.row[row][column]}, wanted.row[row][column], 1e-5) << thing.instance;
    }

    const Character body_ = creature(30, 8), thing_ = creature(10, 3);
};

TEST_P(Attach, WhatHangsIsWhereTheSocketIs) {
    for (const bool culls : {true, false}) {
        Crowd crowd = crowd_of(culls);
        std::vector<Attachment> attachments = random_attachments(crowd, 1);
        ASSERT_TRUE(crowd.attach(things(crowd), attachments));
        for (int update = 0; update < 4; ++update) {
            if (update == 2) {
                attachments = random_attachments(crowd, 2);
                ASSERT_TRUE(crowd.attach(things(crowd), attachments));
            }
            ASSERT_TRUE(crowd.update(0.1f));
            for (uint32_t i = 0; i < kThings; ++i) expect_there(crowd, things(crowd)[i], attachments[i]);
        }
        // Let go, one stays where it was, and another goes where it is put.
        const InstanceHandle stays = things(crowd)[4], is_put = things(crowd)[5];
        const Affine was = placement(crowd, stays), place = to_affine(Trs<float>{.translation = {1, 2, 3}});
        ASSERT_TRUE(crowd.detach(std::array{stays, is_put}));
        ASSERT_TRUE(crowd.set_placement(is_put, place));
        ASSERT_TRUE(crowd.update(0.1f));
        EXPECT_EQ(placement(crowd, stays), was);
        EXPECT_EQ(placement(crowd, is_put), place);
        expect_there(crowd, things(crowd)[6], attachments[6]);
    }
}

TEST_P(Attach, NothingHangsOnWhoeverComesAfterACarrier) {
    Crowd crowd = crowd_of();
    const std::vector<InstanceHandle> all = things(crowd);
    const InstanceHandle carrier = bodies(crowd)[3];
    ASSERT_TRUE(crowd.attach(all[0], Attachment{.carrier = carrier}));
    ASSERT_TRUE(crowd.attach(all[1], Attachment{.carrier = bodies(crowd)[4]}));  // who stays
    ASSERT_TRUE(crowd.update(0.1f));
    const Affine was = placement(crowd, all[0]);
    ASSERT_TRUE(crowd.despawn(std::array{carrier, all[1]}));
    const auto next = crowd.spawn(0, std::array{to_affine(Trs<float>{.translation = {90, 0, 0}})}).value();
    const auto thing = crowd.spawn(1, std::array{to_affine(Trs<float>{.translation = {0, 90, 0}})}).value();
    ASSERT_EQ(next[0].instance, carrier.instance);
    ASSERT_EQ(thing[0].instance, all[1].instance);
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(placement(crowd, all[0]), was);
    EXPECT_EQ(placement(crowd, thing[0]), to_affine(Trs<float>{.translation = {0, 90, 0}}));
    EXPECT_NE(refusal(crowd.attach(all[0], Attachment{.carrier = carrier})).find("its carrier"), std::string::npos);
    // A newborn that hangs on a newborn, in the update of both.
    const Attachment attachment{.carrier = next[0], .socket = 1};
    ASSERT_TRUE(crowd.attach(thing, attachment));
    ASSERT_TRUE(crowd.update(0.1f));
    expect_there(crowd, thing[0], attachment);
}

TEST_P(Attach, BatchesChangeNothing) {
    Crowd whole = crowd_of(), parts = crowd_of(true, device_of_workgroups(13));
    ASSERT_GT(parts.outputs().size(), 3u);
    for (Crowd* crowd : {&whole, &parts}) {
        ASSERT_TRUE(crowd->attach(things(*crowd), random_attachments(*crowd, 3)));
        ASSERT_TRUE(crowd->update(0.1f));
    }
    for (const InstanceHandle& thing : things(whole)) EXPECT_EQ(placement(whole, thing), placement(parts, thing));
}

TEST_P(Attach, IsSaved) {
    Crowd crowd = crowd_of(), other = crowd_of();
    ASSERT_TRUE(crowd.attach(things(crowd), random_attachments(crowd, 1)));
    ASSERT_TRUE(crowd.update(0.1f));
    ASSERT_TRUE(crowd.attach(things(crowd)[0], random_attachments(crowd, 2)[0]));
    ASSERT_TRUE(other.restore_state(crowd.save_state().value()));
    ASSERT_TRUE(crowd.update(0.1f) && other.update(0.1f));
    for (const InstanceHandle& thing : things(crowd)) EXPECT_EQ(placement(crowd, thing), placement(other, thing));
    expect_there(other, things(other)[0], random_attachments(other, 2)[0]);
}

TEST_P(Attach, ADiscardedUpdateHasNotTakenItUp) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Crowd crowd = crowd_of();
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<Attachment> attachments = random_attachments(crowd, 4);
    ASSERT_TRUE(crowd.attach(things(crowd), attachments));
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { ASSERT_TRUE(crowd.record(commands, 0.1f)); });
    ASSERT_TRUE(crowd.discard_last_record());
    ASSERT_TRUE(crowd.update(0.1f));
    for (uint32_t i = 0; i < kThings; ++i) expect_there(crowd, things(crowd)[i], attachments[i]);
}

TEST_P(Attach, MistakesAreNamed) {
    Crowd crowd = crowd_of();
    const InstanceHandle thing = things(crowd)[0], body = bodies(crowd)[0];
    const auto says = [&](const auto& result, const char* what) {
        EXPECT_NE(refusal(result).find(what), std::string::npos) << refusal(result);
    };
    Attachment attachment{.carrier = body};
    says(crowd.attach(body, attachment), "its group is not carried");
    says(crowd.attach(thing, Attachment{.carrier = thing}), "the carrier has 0 sockets");
    says(crowd.attach(thing, Attachment{.carrier = body, .socket = 2}), "there is no socket 2");
    says(crowd.attach(thing, Attachment{}), "its carrier");
    attachment.socket_from_model.row[1][2] = std::nanf("");
    says(crowd.attach(thing, attachment), "not finite");
    const auto made = [&](CrowdGroup group) {
        group.character = &thing_;
        group.instance_count = 1;
        group.is_carried = true;
        return Crowd::create(test_device(), {.groups = {group}});
    };
    says(made({.sockets = {0}}), "not together with sockets");
    says(made({.steering = Steering{}}), "not together with steering");
    Crowd in_model = create(
        {.groups = {{.character = &body_, .instance_count = 1, .sockets = {0}, .socket_space = SocketSpace::kModel},
                    {.character = &thing_, .instance_count = 1, .is_carried = true}}});
    says(in_model.attach(InstanceHandle{1}, Attachment{.carrier = {0}}), "in model space");
    Crowd none = create({.groups = {{.character = &body_, .instance_count = 2}}});
    says(none.attach(InstanceHandle{1}, Attachment{.carrier = {0}}), "no group is carried");
    EXPECT_TRUE(none.detach(InstanceHandle{1}));
}

INSTANTIATE_TEST_SUITE_P(OnPaths, Attach, testing::Values(UpdatePath::kAuto, UpdatePath::kFused, UpdatePath::kStaged),
                         [](const auto& of) {
                             return of.param == UpdatePath::kAuto    ? "Auto"
                                    : of.param == UpdatePath::kFused ? "Fused"
                                                                     : "Staged";
                         });

}  // namespace
}  // namespace throng::test
