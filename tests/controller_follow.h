// Controller kernels against the reference, on any device: all that decides a state must match bit for bit.
#pragma once

#include "control/control_reference.h"
#include "control/controller_reference.h"
#include "gpu/upload.h"
#include "tests/shared.h"
#include "tests/test_rig.h"
#include "tools/creatures/creature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <tuple>

namespace throng::test {

inline constexpr uint32_t kEventCapacity = 8192;
inline constexpr uint32_t kCommandsEach = 3;  // at most, per instance and update

struct EventBlock {
    io::EventHead head{};
    std::vector<io::EventRecord> records;
};

inline std::vector<uint32_t> timeline_words(const Character& character) {
    std::vector<io::ClipTimeline> timelines;
    for (const Clip& clip : character.clips)
        timelines.push_back({clip.first_time, clip.row_count, clip.row_stride, clip.first_row, clip.duration_s});
    timelines.push_back({.first_time = 0, .row_count = 1, .row_stride = 0, .first_row = 0, .duration_s = 0});
    return as_words(timelines);
}

template <class T>
std::vector<T> repeated(const std::vector<T>& one, uint32_t count) {
    std::vector<T> all;
    for (uint32_t i = 0; i < count; ++i) all.insert(all.end(), one.begin(), one.end());
    return all;
}

inline std::vector<io::LayerState> layer_states_of(const std::vector<uint32_t>& words) {
    std::vector<io::LayerState> states(words.size() * sizeof(uint32_t) / sizeof(io::LayerState));
    std::memcpy(states.data(), words.data(), words.size() * sizeof(uint32_t));
    return states;
}

inline EventBlock event_block_of(const std::vector<uint32_t>& words) {
    EventBlock block;
    std::memcpy(&block.head, words.data(), sizeof block.head);
    block.records.resize(std::min(block.head.count, kEventCapacity));
    if (!block.records.empty())
        std::memcpy(block.records.data(), words.data() + sizeof block.head / 4,
                    block.records.size() * sizeof(io::EventRecord));
    return block;
}

inline Character controlled_creature() {
    const Result<Asset> asset = make_creature({.joint_count = 60, .level_count = 15});
    Result<Character> character = compile_character(*asset);
    EXPECT_TRUE(character);
    return std::move(*character);
}

// A new value for a parameter, as an application would set it; sometimes so small that a device may flush it to 0.
inline float random_value(Random& random, ParameterType type) {
    if (type != ParameterType::kFloat) return static_cast<float>(random.below(2));
    if (random.below(8) == 0) return random.below(2) == 0 ? 1e-40f : -1e-40f;
    return static_cast<float>(random.between(-3, 3));
}

// A few parameter changes and now and then a change of state, in the order of instances.
inline std::vector<io::ControlCommand> random_commands(Random& random, const Controller& controller, uint32_t count) {
    std::vector<io::ControlCommand> commands;
    if (controller.parameters.empty()) return commands;
    for (uint32_t instance = 0; instance < count; ++instance)
        while (random.below(24) == 0 && commands.size() < count * size_t{kCommandsEach}) {
            const uint32_t parameter = random.below(static_cast<uint32_t>(controller.parameters.size()));
            commands.push_back({.instance = instance,
                                .kind = io::kCommandParameter,
                                .target = parameter,
                                .value = random_value(random, controller.parameters[parameter].type)});
        }
    for (uint32_t instance = 0; instance < count; ++instance) {
        const uint32_t layer = random.below(static_cast<uint32_t>(controller.layers.size()));
        const auto state_count = static_cast<uint32_t>(controller.layers[layer].states.size());
        if (state_count == 0 || random.below(500) > 0 || commands.size() >= count * size_t{kCommandsEach}) continue;
        commands.push_back({.instance = instance,
                            .kind = io::kCommandState,
                            .target = layer,
                            .motion = random.below(state_count),
                            .phase = random.below(UINT32_MAX),
                            .loop = random.below(3),
                            .fade_rate = random.below(2) == 0 ? 0 : static_cast<float>(random.between(0.5, 20))});
    }
    std::ranges::stable_sort(commands, {}, &io::ControlCommand::instance);
    return commands;
}

inline void expect_layers(std::span<const io::LayerState> device, std::span<const io::LayerState> reference) {
    for (size_t i = 0; i < reference.size(); ++i) {
        ASSERT_EQ(device[i].play_count, reference[i].play_count) << "layer " << i;
        EXPECT_EQ(device[i].taken, reference[i].taken);
        EXPECT_EQ(device[i].weight, reference[i].weight);
        EXPECT_EQ(device[i].mode, reference[i].mode);
        EXPECT_EQ(device[i].mask, reference[i].mask);
        for (uint32_t k = 0; k < reference[i].play_count; ++k)
            ASSERT_EQ(std::memcmp(&device[i].plays[k], &reference[i].plays[k], sizeof(io::LayerPlay)), 0)
                << "layer " << i << ", play " << k << ": state " << device[i].plays[k].motion << ", phase "
                << device[i].plays[k].phase << " and state " << reference[i].plays[k].motion << ", phase "
                << reference[i].plays[k].phase;
    }
}

// A time on a key may be rounded to either side of it.
inline void expect_rows(const io::ActiveClip& device, const io::ActiveClip& wanted) {
    constexpr float kTolerance = 1e-3f;  // of a thirtieth of a second
    if (device.earlier == wanted.earlier) {
        EXPECT_EQ(device.later, wanted.later);
        EXPECT_NEAR(device.fraction, wanted.fraction, kTolerance);
        return;
    }
    const auto [before, after] = std::minmax(
        device, wanted, [](const io::ActiveClip& a, const io::ActiveClip& b) { return a.earlier < b.earlier; });
    ASSERT_EQ(before.later, after.earlier);
    EXPECT_GE(before.fraction, 1 - kTolerance);
    EXPECT_LE(after.fraction, kTolerance);
}

inline void expect_active_clips(std::span<const io::ActiveClip> device, std::span<const ControllerActiveClip> reference,
                                const Character& character, bool divides_weights) {
    const std::vector<io::ActiveClip> wanted = to_io(reference, character);
    for (size_t i = 0; i < wanted.size(); ++i) {
        ASSERT_EQ(device[i].first_track, wanted[i].first_track) << "active clip " << i;
        ASSERT_EQ(device[i].flags, wanted[i].flags) << "active clip " << i;
        if (divides_weights)
            EXPECT_FLOAT_EQ(device[i].weight, wanted[i].weight);  // SPIR-V allows an error of 2.5 ulp
        else
            EXPECT_EQ(device[i].weight, wanted[i].weight);
        EXPECT_EQ(device[i].layer_weight, wanted[i].layer_weight);
        EXPECT_EQ(device[i].reference_row, wanted[i].reference_row);
        expect_rows(device[i], wanted[i]);
    }
}

using EventKey = std::tuple<uint32_t, uint32_t, uint32_t>;  // instance, layer, event

inline void expect_events(const EventBlock& device, const std::map<EventKey, std::vector<double>>& reference) {
    std::map<EventKey, std::vector<double>> seen;
    for (const io::EventRecord& record : device.records)
        seen[{record.instance, record.layer, record.event}].push_back(record.time_s);
    ASSERT_EQ(seen.size(), reference.size());
    for (const auto& [key, times_s] : reference) {
        ASSERT_TRUE(seen.contains(key));
        std::vector<double>& device_times_s = seen[key];
        std::sort(device_times_s.begin(), device_times_s.end());
        ASSERT_EQ(device_times_s.size(), times_s.size());
        for (size_t i = 0; i < times_s.size(); ++i) EXPECT_NEAR(device_times_s[i], times_s[i], 1e-5);
    }
}

struct Followed {
    size_t event_count = 0, transition_count = 0;
};

// Compares all instances in every update.
template <class Kernels>
Followed follow(const Controller& controller, const Character& character, uint32_t instance_count,
                uint32_t update_count, const auto& commands_of) {
    Kernels kernels(controller, character, instance_count);
    std::vector<ControllerReference> references(instance_count, ControllerReference(controller, character));
    Random random(7);
    Followed followed;
    const auto layer_count = kernels.made().layout.layer_count;
    const size_t parameter_count = controller.parameters.size();
    const bool divides_weights = std::ranges::any_of(controller.layers, [](const ControllerLayer& layer) {
        return std::ranges::any_of(layer.states, [](const ControllerState& state) { return state.points.empty(); });
    });
    for (uint32_t update = 0; update < update_count && !::testing::Test::HasFailure(); ++update) {
        const float time_step_s = random.below(50) == 0 ? static_cast<float>(random.between(-0.5, 3))
                                                        : static_cast<float>(random.between(0, 0.05));
        const std::vector<io::ControlCommand> commands = commands_of(random);
        kernels.update(commands, time_step_s);
        for (const io::ControlCommand& command : commands) references[command.instance].apply(command);
        const std::vector<io::LayerState> layers = kernels.layers();
        const std::vector<float> parameters = kernels.parameters();
        const std::vector<io::ActiveClip> active_clips = kernels.active_clips();
        const std::vector<float> active_clip_times = kernels.active_clip_times();
        const EventBlock events = kernels.events();
        std::map<EventKey, std::vector<double>> wanted_events;
        for (uint32_t i = 0; i < instance_count && !::testing::Test::HasFailure(); ++i) {
            const ControllerUpdate wanted = references[i].update(time_step_s);
            expect_layers(std::span(layers).subspan(i * layer_count, layer_count), references[i].layers);
            EXPECT_TRUE(std::equal(references[i].parameters.begin(), references[i].parameters.end(),
                                   parameters.begin() + static_cast<ptrdiff_t>(i * parameter_count)));
            expect_active_clips(
                std::span(active_clips)
                    .subspan(i * size_t{kernels.made().active_clip_limit}, kernels.made().active_clip_limit),
                wanted.active_clips, character, divides_weights);
            for (size_t k = 0; k < wanted.active_clips.size(); ++k)
                EXPECT_NEAR(active_clip_times[i * size_t{kernels.made().active_clip_limit} + k],
                            wanted.active_clips[k].time_s, 1e-5)
                    << "of active clip " << k;
            for (const ControllerEventAt& event : wanted.events)
                wanted_events[{1000 + i, event.layer, event.event}].push_back(event.time_s);
            for (const io::LayerState& state : references[i].layers) followed.transition_count += state.taken != kNone;
            if (::testing::Test::HasFailure())
                ADD_FAILURE() << "instance " << i << ", update " << update << " by " << time_step_s << " s";
        }
        for (auto& [key, times_s] : wanted_events) {
            std::sort(times_s.begin(), times_s.end());
            followed.event_count += times_s.size();
        }
        EXPECT_LE(events.head.count, kEventCapacity);
        expect_events(events, wanted_events);
    }
    return followed;
}

template <class Kernels>
void follow_example(const char* name, uint32_t instance_count = 1000, uint32_t update_count = 2000) {
    const Result<Controller> controller = load_controller(
        source_file(std::string("examples/controllers/") + name + ".json"));
    ASSERT_TRUE(controller) << controller.error().text();
    const Followed followed = follow<Kernels>(
        *controller, controlled_creature(), instance_count, update_count,
        [&](Random& random) { return random_commands(random, *controller, instance_count); });
    EXPECT_TRUE(controller->events.empty() || followed.event_count > update_count) << followed.event_count;
    EXPECT_GT(followed.transition_count, instance_count);
}

// Layers without states, which commands tell what to play.
template <class Kernels>
void follow_direct_layers() {
    const Controller controller = direct_layers(3, {{.name = "all", .items = {}}});
    constexpr uint32_t kInstances = 300;
    const Character character = controlled_creature();
    follow<Kernels>(controller, character, kInstances, 300, [&](Random& random) {
        std::vector<io::ControlCommand> commands;
        for (uint32_t instance = 0; instance < kInstances; ++instance) {
            const float fade_rate = random.below(4) == 0 ? 0 : static_cast<float>(random.between(0.5, 20));
            for (uint32_t first = random.below(12); first < 2; ++first)  // seldom two
                commands.push_back({instance, random.below(8) == 0 ? io::kCommandPlayInertial : io::kCommandPlay,
                                    random.below(3), random.below(static_cast<uint32_t>(character.clips.size()) + 1),
                                    random.below(UINT32_MAX), random.below(2),
                                    static_cast<float>(random.between(-2, 2)), fade_rate});
            if (random.below(12) == 0)
                commands.push_back({instance, io::kCommandLayer, random.below(3), random.below(2) == 0 ? kNone : 0,
                                    random.below(2), 0, static_cast<float>(random.below(5)) / 4, fade_rate});
        }
        return commands;
    });
}

}  // namespace throng::test
