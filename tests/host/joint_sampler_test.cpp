// JointSampler: sampling chosen joints at any time.
#include "tests/test_rig.h"

#include <throng/joint_sampler.h>
#include <throng/reference.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace throng {
namespace {

using namespace test;

Playback some_playback(uint32_t i) {
    return {.first = {.clip = i % 2, .time_s = 0.13 * i},
            .second = {.clip = (i + 1) % 2, .time_s = 0.07 * i, .loop = false},
            .weight = static_cast<float>(i % 5) / 4};
}

TEST(JointSampler, MatchesTheReference) {
    const Character character = make_character({.joint_count = 120});
    const std::vector<uint32_t> joints{119, 0, 57, 3};
    const Result<JointSampler> sampler = JointSampler::create(character, joints);
    ASSERT_TRUE(sampler) << sampler.error().text();
    std::vector<Affine> model_from_joint(joints.size());
    for (uint32_t i = 0; i < 40; ++i) {
        const Playback playback = i == 0 ? Playback{} : some_playback(i);
        ASSERT_TRUE(sampler->sample(playback, model_from_joint));
        const Result<ReferencePose> wanted = reference_pose(character, playback);
        ASSERT_TRUE(wanted) << wanted.error().text();
        for (size_t k = 0; k < joints.size(); ++k)
            for (size_t row = 0; row < 3; ++row)
                for (size_t column = 0; column < 4; ++column)
                    ASSERT_NEAR(model_from_joint[k].row[row][column],
                                wanted->model_from_joint[joints[k]].row[row][column],
                                column < 3 ? 1e-4 : 1e-5 * character.size)
                        << "playback " << i << ", joint " << joints[k];
    }
}

TEST(JointSampler, ServesManyThreads) {
    const Character character = make_character({.joint_count = 70});
    const std::vector<uint32_t> joints{69, 12};
    const JointSampler sampler = *JointSampler::create(character, joints);
    const auto all = [&] {
        std::vector<Affine> sampled(100 * joints.size());
        for (uint32_t i = 0; i < 100; ++i)
            EXPECT_TRUE(sampler.sample(some_playback(i), std::span(sampled).subspan(i * joints.size(), joints.size())));
        return sampled;
    };
    const std::vector<Affine> wanted = all();
    std::vector<std::thread> threads;
    for (uint32_t t = 0; t < 4; ++t) threads.emplace_back([&] { EXPECT_EQ(all(), wanted); });
    for (std::thread& thread : threads) thread.join();
}

TEST(JointSampler, RefusesInvalidArguments) {
    const Character character = make_character({.joint_count = 9});
    const std::vector<uint32_t> beyond{3, 9}, none;
    EXPECT_EQ(JointSampler::create(character, beyond).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(JointSampler::create(character, none).error().code, ErrorCode::kInvalidArgument);
    const std::vector<uint32_t> one{8};
    const JointSampler sampler = *JointSampler::create(character, one);
    std::vector<Affine> out(1), two(2);
    EXPECT_FALSE(sampler.sample({}, two));
    EXPECT_FALSE(sampler.sample({.first = {.clip = 1000}}, out));
    EXPECT_FALSE(sampler.sample({.weight = 2}, out));
}

}  // namespace
}  // namespace throng
