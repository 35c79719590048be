// Instances attached to others: each is at its carrier's socket in the same update.
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

const InSubset kAttachInSubsets({Subset::kGpuAssisted}, {"*Attach*.*/Staged", "*Attach*.*/Fused"}),
    kAttachOnOtherDrivers({Subset::kOtherDriver}, {"-*Attach*.BatchesChangeNothing/*", "-*Attach*.*/Fused"}),
    kAttachNatively({Subset::kNative}, {"*Attach.*", "*AttachInRows.*"});

constexpr uint32_t kBodies = 40, kThings = 30;

class Attach : public testing::TestWithParam<UpdatePath> {
protected:
    // Agents with two sockets, and things that they may carry.
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
    void expect_at_socket(const Crowd& crowd, const InstanceHandle& thing, const Attachment& attachment) const {
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

TEST_P(Attach, AttachedInstancesFollowTheirSocket) {
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
            for (uint32_t i = 0; i < kThings; ++i) expect_at_socket(crowd, things(crowd)[i], attachments[i]);
        }
        // Once detached, an instance stays where it was, or goes where it is placed.
        const InstanceHandle stays = things(crowd)[4], is_put = things(crowd)[5];
        const Affine was = placement(crowd, stays), place = to_affine(Trs<float>{.translation = {1, 2, 3}});
        ASSERT_TRUE(crowd.detach(std::array{stays, is_put}));
        ASSERT_TRUE(crowd.set_placement(is_put, place));
        ASSERT_TRUE(crowd.update(0.1f));
        EXPECT_EQ(placement(crowd, stays), was);
        EXPECT_EQ(placement(crowd, is_put), place);
        expect_at_socket(crowd, things(crowd)[6], attachments[6]);
    }
}

TEST_P(Attach, AttachmentsDoNotPassToACarriersSuccessor) {
    Crowd crowd = crowd_of();
    const std::vector<InstanceHandle> all = things(crowd);
    const InstanceHandle carrier = bodies(crowd)[3];
    ASSERT_TRUE(crowd.attach(all[0], Attachment{.carrier = carrier}));
    ASSERT_TRUE(crowd.attach(all[1], Attachment{.carrier = bodies(crowd)[4]}));  // a carrier that stays
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
    // A new instance attached to a new carrier, in the first update of both.
    const Attachment attachment{.carrier = next[0], .socket = 1};
    ASSERT_TRUE(crowd.attach(thing, attachment));
    ASSERT_TRUE(crowd.update(0.1f));
    expect_at_socket(crowd, thing[0], attachment);
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

TEST_P(Attach, AttachmentsAreSaved) {
    Crowd crowd = crowd_of(), other = crowd_of();
    ASSERT_TRUE(crowd.attach(things(crowd), random_attachments(crowd, 1)));
    ASSERT_TRUE(crowd.update(0.1f));
    ASSERT_TRUE(crowd.attach(things(crowd)[0], random_attachments(crowd, 2)[0]));
    ASSERT_TRUE(other.restore_state(crowd.save_state().value()));
    ASSERT_TRUE(crowd.update(0.1f) && other.update(0.1f));
    for (const InstanceHandle& thing : things(crowd)) EXPECT_EQ(placement(crowd, thing), placement(other, thing));
    expect_at_socket(other, things(other)[0], random_attachments(other, 2)[0]);
}

TEST_P(Attach, ADiscardedUpdateKeepsPendingAttachments) {
    if (test_gpu()->is_native()) GTEST_SKIP() << "it has no command buffers";
    Crowd crowd = crowd_of();
    ASSERT_TRUE(crowd.update(0.1f));
    const std::vector<Attachment> attachments = random_attachments(crowd, 4);
    ASSERT_TRUE(crowd.attach(things(crowd), attachments));
    Recorder recorder;
    recorder.record([&](VkCommandBuffer commands) { ASSERT_TRUE(crowd.record(commands, 0.1f)); });
    ASSERT_TRUE(crowd.discard_last_record());
    ASSERT_TRUE(crowd.update(0.1f));
    for (uint32_t i = 0; i < kThings; ++i) expect_at_socket(crowd, things(crowd)[i], attachments[i]);
}

TEST_P(Attach, InvalidAttachmentsAreRefused) {
    Crowd crowd = crowd_of();
    const InstanceHandle thing = things(crowd)[0], body = bodies(crowd)[0];
    const auto says = [&](const auto& result, const char* what) {
        EXPECT_NE(refusal(result).find(what), std::string::npos) << refusal(result);
    };
    Attachment attachment{.carrier = body};
    says(crowd.attach(body, attachment), "its group does not have CrowdGroup::is_carried set");
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
    says(made({.steering = Steering{}}), "not together with steering");
    Crowd in_model = create(
        {.groups = {{.character = &body_, .instance_count = 1, .sockets = {0}, .socket_space = SocketSpace::kModel},
                    {.character = &thing_, .instance_count = 1, .is_carried = true}}});
    says(in_model.attach(InstanceHandle{1}, Attachment{.carrier = {0}}), "in model space");
    Crowd none = create({.groups = {{.character = &body_, .instance_count = 2}}});
    says(none.attach(InstanceHandle{1}, Attachment{.carrier = {0}}), "no group has CrowdGroup::is_carried set");
    EXPECT_TRUE(none.detach(InstanceHandle{1}));
}

constexpr uint32_t kRiders = 12;

// Riders are attached to beasts and to each other, and things to both.
class AttachInRows : public Attach {
protected:
    struct AttachedInstance {
        InstanceHandle thing;
        Attachment attachment;
    };

    Crowd crowd_in_rows(bool varies = true, const Device& device = test_device()) const {
        CrowdSettings settings{
            .groups = {{.character = &body_, .instance_count = kBodies, .sockets = {body_.rig.joint_count() - 1, 3}},
                       {.character = &thing_, .instance_count = kThings, .is_carried = true},
                       {.character = &rider_, .instance_count = kRiders, .sockets = {4, 1}, .is_carried = true}},
            .path = GetParam()};
        if (varies) {
            settings.culling.emplace();
            settings.groups[2].capacity = kRiders + 3;
        }
        Crowd crowd = Crowd::create(device, settings).expect();
        play(crowd, 0, kBodies, 1);
        play(crowd, 2, kRiders, 2);
        return crowd;
    }
    static std::vector<InstanceHandle> riders(const Crowd& crowd) { return handles(crowd, 2, kRiders); }
    // Random placements, at random times of a clip.
    static void play(Crowd& crowd, uint32_t group, uint32_t count, uint64_t seed) {
        Random random(seed);
        for (const InstanceHandle& one : handles(crowd, group, count)) {
            EXPECT_TRUE(crowd.set_placement(one, to_affine(random.trs(20, 0.2)).as<float>()));
            EXPECT_TRUE(crowd.set_playback(one, {.first = {.clip = 0, .time_s = random.between(0, 2)}}));
        }
    }
    // The first rider is attached to nothing, the others to a body or an earlier rider, and things to either.
    static std::vector<AttachedInstance> random_rows(const Crowd& crowd, uint64_t seed) {
        Random random(seed);
        const std::vector<InstanceHandle> beasts = bodies(crowd), all = riders(crowd);
        std::vector<AttachedInstance> rows;
        const auto add_row = [&](const InstanceHandle& thing, uint32_t rider_count) {
            const bool on_rider = rider_count > 0 && random.chance(0.7);
            rows.push_back({thing,
                            {.carrier = on_rider ? all[random.below(rider_count)] : beasts[random.below(kBodies)],
                             .socket = random.below(2),
                             .socket_from_model = to_affine(random.trs(1, 0.5)).as<float>()}});
        };
        for (const InstanceHandle& thing : things(crowd)) add_row(thing, kRiders);
        for (uint32_t i = 1; i < kRiders; ++i) add_row(all[i], i);
        return rows;
    }
    static void attach_rows(Crowd& crowd, std::span<const AttachedInstance> rows) {
        for (const auto& [thing, attachment] : rows) {
            const Result<void> done = crowd.attach(thing, attachment);
            ASSERT_TRUE(done) << refusal(done);
        }
    }
    void expect_all_at_sockets(const Crowd& crowd, std::span<const AttachedInstance> rows) const {
        for (const auto& [thing, attachment] : rows) expect_at_socket(crowd, thing, attachment);
    }
    // Compares with riders that stand where these have been carried and play the same.
    void expect_sockets_of_riders(const Crowd& crowd, uint32_t update_count) const {
        Crowd alone = Crowd::create(test_device(),
                                    {.groups = {{.character = &rider_, .instance_count = kRiders, .sockets = {4, 1}}},
                                     .path = GetParam()})
                          .expect();
        play(alone, 0, kRiders, 2);
        const std::vector<InstanceHandle> standing = handles(alone, 0, kRiders), carried = riders(crowd);
        for (uint32_t i = 0; i < kRiders; ++i)
            ASSERT_TRUE(alone.set_placement(standing[i], placement(crowd, carried[i])));
        for (uint32_t update = 0; update < update_count; ++update) ASSERT_TRUE(alone.update(0.1f));
        for (uint32_t i = 0; i < kRiders; ++i)
            for (uint32_t number = 0; number < 2; ++number) {
                const Affine wanted = socket(alone, standing[i], number), is = socket(crowd, carried[i], number);
                for (size_t row = 0; row < 3; ++row)
                    for (size_t column = 0; column < 4; ++column)
                        EXPECT_NEAR(is.row[row][column], wanted.row[row][column], 1e-5)
                            << "rider " << i << ", socket " << number;
            }
    }

    const Character rider_ = creature(20, 6);
};

TEST_P(AttachInRows, EachInstanceFollowsTheSocketOfItsCarrier) {
    for (const bool varies : {true, false}) {
        Crowd crowd = crowd_in_rows(varies);
        std::vector<AttachedInstance> rows = random_rows(crowd, 1);
        attach_rows(crowd, rows);
        for (uint32_t update = 0; update < 4; ++update) {
            if (update == 2) {
                ASSERT_TRUE(crowd.detach(riders(crowd)));
                rows = random_rows(crowd, 2);
                attach_rows(crowd, rows);
            }
            ASSERT_TRUE(crowd.update(0.1f));
            expect_all_at_sockets(crowd, rows);
            expect_sockets_of_riders(crowd, update + 1);
        }
    }
}

TEST_P(AttachInRows, DetachedInstancesStayAndStillCarry) {
    Crowd crowd = crowd_in_rows();
    const std::vector<InstanceHandle> all = riders(crowd);
    const std::vector<AttachedInstance> rows{{all[0], {.carrier = bodies(crowd)[0]}},
                                             {all[1], {.carrier = all[0], .socket = 1}},
                                             {all[2], {.carrier = all[1]}},
                                             {things(crowd)[0], {.carrier = all[2]}}};
    attach_rows(crowd, rows);
    ASSERT_TRUE(crowd.update(0.1f));
    const Affine was = placement(crowd, all[1]);
    ASSERT_TRUE(crowd.detach(all[1]));
    for (int update = 0; update < 2; ++update) {
        ASSERT_TRUE(crowd.update(0.1f));
        EXPECT_EQ(placement(crowd, all[1]), was);
        for (const size_t i : {0u, 2u, 3u}) expect_at_socket(crowd, rows[i].thing, rows[i].attachment);
    }
    // After its carrier is despawned, the next one also stays where it is.
    const Affine next_was = placement(crowd, all[2]);
    ASSERT_TRUE(crowd.despawn(std::array{all[1]}));
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(placement(crowd, all[2]), next_was);
    for (const size_t i : {0u, 3u}) expect_at_socket(crowd, rows[i].thing, rows[i].attachment);
}

TEST_P(AttachInRows, BatchesChangeNothing) {
    Crowd whole = crowd_in_rows(), parts = crowd_in_rows(true, device_of_workgroups(5));
    ASSERT_GT(parts.outputs().size(), 10u);
    for (Crowd* crowd : {&whole, &parts}) {
        attach_rows(*crowd, random_rows(*crowd, 3));
        ASSERT_TRUE(crowd->update(0.1f));
    }
    for (const auto& [thing, attachment] : random_rows(whole, 3))
        EXPECT_EQ(placement(whole, thing), placement(parts, thing));
}

TEST_P(AttachInRows, RowsAreSaved) {
    const Device device = device_of_workgroups(5);  // riders in several batches
    Crowd crowd = crowd_in_rows(true, device), other = crowd_in_rows(true, device);
    const std::vector<InstanceHandle> all = riders(crowd);
    std::vector<AttachedInstance> rows{{things(crowd)[0], {.carrier = all[0]}}};
    for (uint32_t i = 0; i + 1 < kRiders; ++i) rows.push_back({all[i], {.carrier = all[i + 1], .socket = 1}});
    attach_rows(crowd, rows);
    // The other crowd is attached in the opposite order. Restoring only the first batch's riders would form cycles.
    for (uint32_t i = 1; i < kRiders; ++i)
        attach_rows(other, std::array{AttachedInstance{all[i], {.carrier = all[i - 1]}}});
    ASSERT_TRUE(other.update(0.1f));
    ASSERT_TRUE(other.restore_state(crowd.save_state().value()));
    ASSERT_TRUE(crowd.update(0.1f) && other.update(0.1f));
    for (const AttachedInstance& one : rows) EXPECT_EQ(placement(crowd, one.thing), placement(other, one.thing));
    expect_all_at_sockets(other, rows);
    // The saved bytes show what is attached to what, not the order of the calls that led there.
    ASSERT_TRUE(crowd.detach(all[5]));
    const std::vector<std::byte> saved = crowd.save_state().value();
    ASSERT_TRUE(crowd.restore_state(saved));
    EXPECT_TRUE(crowd.save_state().value() == saved);
}

TEST_P(AttachInRows, CyclesAreRefused) {
    Crowd crowd = crowd_in_rows();
    const std::vector<InstanceHandle> all = riders(crowd);
    const std::vector<AttachedInstance> rows{{all[0], {.carrier = bodies(crowd)[0]}}, {all[1], {.carrier = all[0]}}};
    attach_rows(crowd, rows);
    ASSERT_TRUE(crowd.update(0.1f));
    const auto says = [&](const auto& result) {
        EXPECT_NE(refusal(result).find("would be attached to itself"), std::string::npos) << refusal(result);
    };
    says(crowd.attach(all[0], Attachment{.carrier = all[0]}));
    says(crowd.attach(all[0], Attachment{.carrier = all[1]}));
    says(crowd.attach(
        std::array{all[2], all[0], all[3]},
        std::array{Attachment{.carrier = all[1]}, Attachment{.carrier = all[3]}, Attachment{.carrier = all[2]}}));
    const Affine stands = placement(crowd, all[2]);
    ASSERT_TRUE(crowd.update(0.1f));
    expect_all_at_sockets(crowd, rows);
    EXPECT_EQ(placement(crowd, all[2]), stands);
}

TEST_P(AttachInRows, TooLongRowsAreRefused) {
    constexpr uint32_t kMaximum = 64;
    Crowd crowd =
        Crowd::create(
            test_device(),
            {.groups = {{.character = &rider_, .instance_count = kMaximum + 2, .sockets = {4, 1}, .is_carried = true}},
             .path = GetParam()})
            .expect();
    const std::vector<InstanceHandle> all = handles(crowd, 0, kMaximum + 2);
    std::vector<AttachedInstance> rows;
    for (uint32_t i = 1; i <= kMaximum; ++i) rows.push_back({all[i], {.carrier = all[i - 1]}});
    attach_rows(crowd, rows);
    EXPECT_NE(refusal(crowd.attach(all[0], Attachment{.carrier = all[kMaximum + 1]})).find("more than 64 carriers"),
              std::string::npos);
    ASSERT_TRUE(crowd.update(0.1f));
    expect_all_at_sockets(crowd, rows);
}

const auto kAttachPaths = testing::Values(UpdatePath::kAuto, UpdatePath::kFused, UpdatePath::kStaged);
INSTANTIATE_TEST_SUITE_P(OnPaths, Attach, kAttachPaths, path_name);
INSTANTIATE_TEST_SUITE_P(OnPaths, AttachInRows, kAttachPaths, path_name);

}  // namespace
}  // namespace throng::test
