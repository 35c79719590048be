// Properties that hold for any controller and any time steps.
#include "tests/controller_instance.h"
#include "tests/random_controllers.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace throng {
namespace {

using namespace test;
using EventCounts = std::map<std::pair<uint32_t, uint32_t>, size_t>;  // of (event, layer)
void count(EventCounts& counts, const Instance& instance) {
    for (const ControllerEventAt& event : instance.last.events) {
        EXPECT_GE(event.time_s, 0);
        ++counts[{event.event, event.layer}];
    }
}

TEST(AnyController, TimeStepsDoNotChangeEvents) {
    Random random(4);
    size_t total = 0, active_clips = 0;
    for (int round = 0; round < 300; ++round) {
        const Exact exact = random_controller(random);
        Instance whole(exact.controller, exact.durations_s), divided(exact.controller, exact.durations_s);
        for (Instance* instance : {&whole, &divided}) {
            instance->set("x", static_cast<float>(round % 5) / 4);
            instance->set("y", static_cast<float>(round % 9) / 8);
        }
        EventCounts of_whole, of_divided;
        for (int step = 0; step < 20; ++step) {
            const float long_s = static_cast<float>(random.below(1024)) / 64 * (round % 4 == 3 ? -1.0f : 1.0f);
            const float first_s = std::trunc(long_s * static_cast<float>(random.unit()) * 64) / 64;
            whole.update(long_s);
            count(of_whole, whole);
            for (const float part_s : {first_s, long_s - first_s}) {
                divided.update(part_s);
                count(of_divided, divided);
            }
            for (uint32_t layer = 0; layer < exact.controller.layers.size(); ++layer)
                ASSERT_EQ(whole.leading(layer).phase, divided.leading(layer).phase);
            active_clips = std::max(active_clips, whole.last.active_clips.size());
        }
        ASSERT_EQ(of_whole, of_divided) << "round " << round;
        for (const auto& [event, times] : of_whole) total += times;
    }
    EXPECT_GT(total, 50'000u);
    std::printf("  300 controllers, %zu events, at most %zu active clips\n", total, active_clips);
}

TEST(AnyController, EventCountsEqualLoopCounts) {
    Random random(5);
    for (int round = 0; round < 100; ++round) {
        std::vector<ControllerEvent> events;
        for (int i = 0; i < 8; ++i) events.push_back({std::to_string(i), "a", random.unit() * 2});
        Controller controller{.name = "test", .events = events};
        controller.layers = {
            {.name = "base",
             .states = {{.name = "only", .points = {{"a"}}, .speed = random.chance(0.5) ? 1.0f : -1.0f}}}};
        Instance instance(controller, {2});
        EventCounts counts;
        const uint32_t loops = 1 + random.below(50);
        for (uint32_t left = loops * 128; left > 0;) {  // 64ths of a second
            const uint32_t step = std::min(left, 1 + random.below(300));
            left -= step;
            instance.update(static_cast<float>(step) / 64);
            count(counts, instance);
        }
        ASSERT_EQ(counts.size(), 8u);
        for (const auto& [event, times] : counts) EXPECT_EQ(times, loops);
    }
}

// For any controller and steps: a layer's weights sum to 1 unless it plays nothing, there are no more active clips than
// the tables allow, and the state is valid.
TEST(AnyController, LayerWeightsAndStatesStayValid) {
    Random random(6);
    size_t most = 0, taken = 0;
    for (int round = 0; round < 100; ++round) {
        Exact exact = random_controller(random);
        add_random_transitions(random, exact.controller);
        Instance instance(exact.controller, exact.durations_s);
        const uint32_t limit = make_controller_tables(instance.controller, instance.character).active_clip_limit;
        for (int step = 0; step < 200; ++step) {
            instance.set(random.chance(0.5) ? "x" : "y", static_cast<float>(random.between(-0.5, 1.5)));
            instance.update(static_cast<float>(random.between(-0.01, 0.1)));
            ASSERT_LE(instance.last.active_clips.size(), limit);
            most = std::max(most, instance.last.active_clips.size());
            for (uint32_t layer = 0; layer < exact.controller.layers.size(); ++layer) {
                double sum = 0;
                for (const ControllerActiveClip& active_clip : instance.last.active_clips)
                    if (active_clip.layer == layer) {
                        ASSERT_GT(active_clip.weight, 0);
                        sum += active_clip.weight;
                    }
                const io::LayerState& state = instance.reference.layers[layer];
                bool shows_clips = false;
                for (uint32_t k = 0; k < state.play_count; ++k)
                    shows_clips |= (state.plays[k].fade > 0 || k + 1 == state.play_count) &&
                                   !exact.controller.layers[layer].states[state.plays[k].motion].points.empty();
                ASSERT_NEAR(sum, shows_clips ? 1 : 0, 1e-4);
                taken += state.taken != kNone;
                for (uint32_t k = 0; k < state.play_count; ++k) {
                    ASSERT_LE(state.plays[k].fade, 1);
                    ASSERT_TRUE(k == 0 || exact.controller.layers[layer].states[state.plays[k].motion].sync.empty() ||
                                exact.controller.layers[layer].states[state.plays[0].motion].sync.empty() ||
                                state.plays[k].phase == state.plays[0].phase);
                }
            }
        }
    }
    EXPECT_GT(taken, 5'000u);
    std::printf("  at most %zu active clips, %zu transitions\n", most, taken);
}

}  // namespace
}  // namespace throng
