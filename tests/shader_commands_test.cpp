// Commands written by an application's shaders have the same effect as the calls of the same names.
#include "crowd/crowd_state.h"
#include "tests/contents.h"
#include "tests/draw_path.h"
#include "tests/kinds.h"
#include "tests/recorder.h"
#include "tests/subset.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <limits>

namespace throng::test {
namespace {

const InSubset kShaderCommandsInSubsets({Subset::kGpuAssisted}, {"ShaderCommands.RandomBitsDoNoHarm",
                                                                 "ShaderCommands/*.HaveTheEffectOfCalls/Device"}),
    kShaderCommandsOnOtherDrivers({Subset::kOtherDriver}, {"-ShaderCommands/*"}),
    kShaderCommandsNatively({Subset::kNative}, {"*ShaderCommands*"});

constexpr uint32_t kGroups = 6, kDirect = 5, kCommandCapacity = 200;
constexpr uint32_t kHeadWords = sizeof(CommandHead) / sizeof(uint32_t);

// Commands per block, as shaders would write them.
using Commands = std::vector<std::vector<InstanceCommand>>;

void write(const Crowd& crowd, uint32_t block_index, std::span<const InstanceCommand> commands) {
    const OutputBlock& block = crowd.outputs()[block_index];
    const std::array<uint32_t, 1> count{static_cast<uint32_t>(commands.size())};
    commands = commands.first(std::min<size_t>(commands.size(), block.command_capacity));
    const BufferRange range = output_range(block, &OutputBlock::command, 0, block.command.size_bytes);
    const Gpu& gpu = *crowd.state().gpu;
    crowd.state().finish_uploads();  // before the first update
    gpu.submit_and_wait([&](VkCommandBuffer recorded) {
        record_update(gpu, recorded, range, 0, std::span<const uint32_t>(count));
        record_update(gpu, recorded, range, 1, commands);
    });
}

// Writes an entry that shaders may change without a command.
template <class T>
void write(const Crowd& crowd, uint32_t block_index, BufferView OutputBlock::*member, uint32_t entry, const T& value) {
    const OutputBlock& block = crowd.outputs()[block_index];
    const BufferRange range = output_range(block, member, entry * sizeof value, sizeof value);
    const Gpu& gpu = *crowd.state().gpu;
    gpu.submit_and_wait(
        [&](VkCommandBuffer recorded) { record_update(gpu, recorded, range, 0, std::span<const T>(&value, 1)); });
}

CommandHead head_of(const Crowd& crowd, uint32_t block) {
    const auto words = output<uint32_t>(crowd.outputs()[block], &OutputBlock::command, kHeadWords, crowd.state().gpu);
    return {.count = words[0], .lost = words[1], .ignored = words[2]};
}

// Two crowds with groups of all kinds: the CPU calls one, and shaders command the other.
class CommandedPair {
public:
    explicit CommandedPair(UpdatePath path) {
        CrowdSettings settings = kinds_.settings(path);
        settings.groups[0].pose_capacity = 0;
        settings.groups[0].outfits = {{}, {}, {}};
        settings.groups.push_back({.character = &kinds_.character, .controller = &direct_});
        for (CrowdGroup& group : settings.groups) group.capacity = kGroupCapacity;
        called = create(settings);
        for (CrowdGroup& group : settings.groups) {
            group.shader_commands = throng::ShaderCommands{.capacity = kCommandCapacity, .populate = true};
        }
        commanded = create(settings);
        commands.resize(kGroups);
    }

    void live(Random& random) {
        despawn(random);
        for (const InstanceHandle& one : alive_) lead(random, one);
        spawn(random);
        for (const InstanceHandle& one : alive_) change(random, one);
    }

    void update(float step_s) {
        ASSERT_TRUE(called.update(step_s));
        for (uint32_t block = 0; block < kGroups; ++block) {
            write(commanded, block, commands[block]);
            command_count += commands[block].size();
            commands[block].clear();
        }
        ASSERT_TRUE(commanded.update(step_s));
        const Contents wanted = contents_of(called.outputs());
        expect_same(wanted, contents_of(commanded.outputs()), "update " + std::to_string(update_count++));
        for (const auto& [what, bytes] : wanted) compared_bytes += bytes.size();
        for (uint32_t block = 0; block < kGroups; ++block) {
            const CommandHead head = head_of(commanded, block);
            EXPECT_EQ(head.count, 0u);
            EXPECT_EQ(head.lost, 0u);
            EXPECT_EQ(head.ignored, 0u) << group_of(block);
        }
    }

    Crowd called{nullptr}, commanded{nullptr};
    Commands commands;
    uint64_t update_count = 0, command_count = 0, compared_bytes = 0;

private:
    static std::string group_of(uint32_t group) { return group == kDirect ? "direct layers" : group_name(group); }
    uint32_t in_block(const InstanceHandle& of) const { return of.instance % kGroupCapacity; }
    void ask(const InstanceHandle& of, const InstanceCommand& command) {
        commands[of.instance / kGroupCapacity].push_back(command);
    }

    void spawn(Random& random) {
        for (uint32_t group = 0; group < kGroups; ++group) {
            const uint32_t room = kGroupCapacity - *called.alive_count(group), count = std::min(room, random.below(8));
            std::vector<Affine> places;
            for (uint32_t i = 0; i < count; ++i) places.push_back(plot(plot_count_++));
            const auto spawned = called.spawn(group, places);
            ASSERT_TRUE(spawned) << refusal(spawned);
            for (uint32_t i = 0; i < count; ++i) {
                ask((*spawned)[i], InstanceCommand::spawn(in_block((*spawned)[i]), places[i]));
                alive_.push_back((*spawned)[i]);
            }
        }
    }

    // Some of these slots are reused at once: the last command counts.
    void despawn(Random& random) {
        std::vector<InstanceHandle> despawned;
        std::erase_if(alive_, [&](const InstanceHandle& one) {
            const bool goes = random.chance(0.2);
            if (goes) despawned.push_back(one);
            return goes;
        });
        ASSERT_TRUE(called.despawn(despawned));
        for (const InstanceHandle& one : despawned) ask(one, InstanceCommand::despawn(in_block(one)));
    }

    // Sets agents' destinations and targets, but not for instances spawned in this update, which begin without.
    void lead(Random& random, const InstanceHandle& one) {
        const uint32_t group = one.instance / kGroupCapacity;
        const Vec3<float> place = random.vector(50).as<float>();
        const std::array<float, 4> row{place.x, place.y, place.z, 1};
        if (group == 4) {
            EXPECT_TRUE(called.set_destination(one, place));
            write(commanded, group, &OutputBlock::destination, in_block(one), row);
        }
        if (group == 3) {
            EXPECT_TRUE(called.set_target(one, 0, {place, 1}));
            write(commanded, group, &OutputBlock::target, in_block(one), row);
        }
    }

    // Times and fades for which device and CPU compute the same numbers.
    ClipPlayback clip(Random& random) const {
        const uint32_t clip = random.below(static_cast<uint32_t>(kinds_.character.clips.size()));
        return {.clip = random.chance(0.2) ? kNone : clip,
                .time_s = 0.5 * random.below(3) * double{kinds_.character.clips[clip].duration_s},
                .speed = static_cast<float>(random.between(-2, 2)),
                .loop = random.chance(0.5)};
    }
    static float fade(Random& random) { return std::array{0.0f, 0.125f, 0.5f}[random.below(3)]; }

    void change(Random& random, const InstanceHandle& one) {
        const uint32_t group = one.instance / kGroupCapacity, i = in_block(one);
        Result<void> done;
        const auto call_and_command = [&](Result<void> result, const InstanceCommand& command) {
            EXPECT_TRUE(result) << refusal(result);
            ask(one, command);
        };
        if (random.chance(0.2)) {
            const Affine place = plot(plot_count_++);
            call_and_command(called.set_placement(one, place), InstanceCommand::set_placement(i, place));
        }
        if (random.chance(0.5)) return;
        if (group == 0) {
            const InstanceLook look{.tint = {0.5f, 0.25f, static_cast<float>(random.unit())},
                                    .outfit = random.below(3)};
            call_and_command(called.set_look(one, look), InstanceCommand::set_look(i, look));
        }
        if (group == 1 || group == 2) {
            const auto [parameter, value] = random_change(random, group == 1 ? kinds_.walker : kinds_.dragon);
            call_and_command(called.set_parameter(one, parameter, value),
                             InstanceCommand::set_parameter(i, parameter, value));
        } else if (group == kDirect) {
            const uint32_t layer = random.below(2);
            const LayerPlayback play{.clip = clip(random),
                                     .fade_s = fade(random),
                                     .fade = layer == 1 && random.chance(0.5) ? FadeKind::kInertial : FadeKind::kCross};
            call_and_command(called.play(one, layer, play), InstanceCommand::play(i, layer, play));
            const LayerBlend blend{.weight = static_cast<float>(random.unit()),
                                   .fade_s = fade(random),
                                   .mode = random.chance(0.5) ? LayerMode::kAdditive : LayerMode::kOverride,
                                   .mask = random.chance(0.5) ? kNone : 0};
            call_and_command(called.set_layer(one, layer, blend), InstanceCommand::set_layer(i, layer, blend));
        } else {
            const Playback playback{
                .first = clip(random), .second = clip(random), .weight = static_cast<float>(random.unit())};
            call_and_command(called.set_playback(one, playback), InstanceCommand::set_playback(i, playback));
        }
    }

    Kinds kinds_;
    Controller direct_ = direct_layers(2, {{.name = "tail", .items = {{.joint = kinds_.character.rig.names[1]}}}},
                                       true);
    std::vector<InstanceHandle> alive_;
    uint32_t plot_count_ = 0;
};

class ShaderCommandsOnPath : public testing::TestWithParam<UpdatePath> {};

TEST_P(ShaderCommandsOnPath, HaveTheEffectOfCalls) {
    CommandedPair pair(GetParam());
    Random random(3);
    for (int update = 0; update < 12; ++update) {
        pair.live(random);
        pair.update(static_cast<float>(random.between(0, 0.1)));
    }
    EXPECT_GT(pair.command_count, 1000u);
    EXPECT_GT(pair.compared_bytes, 1'000'000u);
}

INSTANTIATE_TEST_SUITE_P(ShaderCommands, ShaderCommandsOnPath,
                         testing::Values(UpdatePath::kAuto, UpdatePath::kDevice, UpdatePath::kStaged), path_name);

class ShaderCommands : public testing::Test {
protected:
    CrowdSettings settings(bool shaders_populate = true) const {
        CrowdSettings settings{.groups = {{.character = &character_,
                                           .instance_count = shaders_populate ? 0 : 4u,
                                           .capacity = 8,
                                           .shader_commands = throng::ShaderCommands{6, shaders_populate}}}};
        return settings;
    }
    static Affine at(float x) { return to_affine(Trs<float>{.translation = {x, 0, 0}}); }
    static std::vector<uint32_t> alive_instances(Crowd& crowd) {
        std::vector<uint32_t> numbers;
        for (const DrawnInstance& one : drawn_of(crowd)) numbers.push_back(one.instance);
        return numbers;
    }
    static Affine placement(const Crowd& crowd, uint32_t instance) {
        return output<Affine>(crowd.outputs()[0], &OutputBlock::placement, 8, crowd.state().gpu)[instance];
    }

    const Character character_ = creature(20, 8);
};

TEST_F(ShaderCommands, TheLastCommandForAPropertyWins) {
    Crowd crowd = create(settings());
    write(crowd, 0,
          std::array{InstanceCommand::set_placement(3, at(5)), InstanceCommand::spawn(3, at(1)),
                     InstanceCommand::spawn(4, at(2)), InstanceCommand::despawn(4),
                     InstanceCommand::set_placement(3, at(6)), InstanceCommand::despawn(5)});
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(alive_instances(crowd), std::vector{3u});
    EXPECT_EQ(placement(crowd, 3), at(6));
    EXPECT_EQ(head_of(crowd, 0).ignored, 0u);
    // Nothing is left over from that.
    write(crowd, 0, std::array{InstanceCommand::spawn(4, at(7)), InstanceCommand::set_placement(3, at(8))});
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(alive_instances(crowd), (std::vector{3u, 4u}));
    EXPECT_EQ(placement(crowd, 3), at(8));
    EXPECT_EQ(placement(crowd, 4), at(7));
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(alive_instances(crowd), (std::vector{3u, 4u}));
}

TEST_F(ShaderCommands, CommandsForInstancesNotAliveAreIgnored) {
    Crowd crowd = create(settings());
    write(crowd, 0, std::array{InstanceCommand::set_placement(2, at(9)), InstanceCommand::set_playback(2, {})});
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_TRUE(alive_instances(crowd).empty());
    write(crowd, 0, std::array{InstanceCommand::spawn(2, at(1))});
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(placement(crowd, 2), at(1));
}

TEST_F(ShaderCommands, CommandsBeyondTheCapacityAreCounted) {
    Crowd crowd = create(settings());
    std::vector<InstanceCommand> many;
    for (uint32_t i = 0; i < 8; ++i) many.push_back(InstanceCommand::spawn(i, at(0)));
    write(crowd, 0, many);
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(head_of(crowd, 0).lost, 2u);
    EXPECT_EQ(alive_instances(crowd).size(), 6u);
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(head_of(crowd, 0).lost, 0u);
}

// Each impossible command is ignored and counted.
TEST_F(ShaderCommands, ImpossibleCommandsAreIgnoredAndCounted) {
    const float infinite = std::numeric_limits<float>::infinity();
    const Controller direct = direct_layers(2), walker = example("walker");
    CrowdSettings of = settings();
    of.groups.push_back(of.groups[0]);
    of.groups.push_back(of.groups[0]);
    of.groups[0].outfits = {{}, {}};
    of.groups[1].controller = &direct;
    of.groups[2].controller = &walker;
    Crowd crowd = create(of);
    for (uint32_t block = 0; block < 3; ++block) write(crowd, block, std::array{InstanceCommand::spawn(1, at(0))});
    ASSERT_TRUE(crowd.update(0.1f));
    const Contents before = contents_of(crowd.outputs());
    const auto clip_count = static_cast<uint32_t>(character_.clips.size());
    InstanceCommand unknown = InstanceCommand::despawn(1), additive = InstanceCommand::set_layer(1, 0, {});
    unknown.kind = static_cast<CommandKind>(99);
    additive.data[1] = 2;
    Affine no_place = at(0);
    no_place.row[2][1] = -infinite;
    const LayerPlayback inertial{.clip = {.clip = 0}, .fade = FadeKind::kInertial};
    const std::vector<std::vector<InstanceCommand>> impossible{
        {unknown, InstanceCommand::despawn(8), InstanceCommand::despawn(kNone), InstanceCommand::spawn(1, no_place),
         InstanceCommand::set_placement(1, no_place), InstanceCommand::set_parameter(1, 0, 1)},
        {InstanceCommand::set_playback(1, {.first = {.clip = clip_count}}),
         InstanceCommand::set_playback(1, {.second = {.clip = 0, .time_s = infinite}}),
         InstanceCommand::set_playback(1, {.second = {.clip = 0, .speed = infinite}}),
         InstanceCommand::set_playback(1, {.weight = 1.5f}), InstanceCommand::set_look(1, {.outfit = 2}),
         InstanceCommand::set_look(1, {.tint = {0, 0, -1}})},
        {InstanceCommand::play(1, 2, {}), InstanceCommand::play(1, 0, {.clip = {.clip = clip_count}}),
         InstanceCommand::play(1, 0, {.fade_s = -1}), InstanceCommand::play(1, 0, inertial), additive,
         InstanceCommand::set_look(1, {})},
        {InstanceCommand::set_layer(1, 0, {.weight = -0.1f}), InstanceCommand::set_layer(1, 0, {.fade_s = infinite}),
         InstanceCommand::set_layer(1, 0, {.mask = 0}), InstanceCommand::set_layer(1, kNone, {}),
         InstanceCommand::set_playback(1, {}), InstanceCommand::set_parameter(1, 0, 1)},
        {InstanceCommand::play(1, 0, {}), InstanceCommand::set_layer(1, 0, {}),
         InstanceCommand::set_parameter(1, static_cast<uint32_t>(walker.parameters.size()), 1),
         InstanceCommand::set_parameter(1, 0, infinite), InstanceCommand::set_playback(1, {}),
         InstanceCommand::set_parameter(8, 0, 1)}};
    const std::array<uint32_t, 5> block_of{0, 0, 1, 1, 2};
    for (size_t i = 0; i < impossible.size(); ++i) {
        write(crowd, block_of[i], impossible[i]);
        ASSERT_TRUE(crowd.update(0));
        EXPECT_EQ(head_of(crowd, block_of[i]).ignored, impossible[i].size()) << i;
        expect_same(contents_of(crowd.outputs()), before, std::to_string(i));
    }
}

// Shaders may write arbitrary bits.
TEST_F(ShaderCommands, RandomBitsDoNoHarm) {
    Kinds kinds;
    CrowdSettings of = kinds.settings(UpdatePath::kAuto);
    for (CrowdGroup& group : of.groups) {
        group.pose_capacity = 0;
        group.capacity = 8;
        group.shader_commands = throng::ShaderCommands{.capacity = kCommandCapacity, .populate = true};
        group.outfits = {{}};
    }
    Crowd crowd = create(of);
    Random random(11);
    uint64_t ignored = 0;
    for (int update = 0; update < 20; ++update) {
        for (uint32_t block = 0; block < crowd.outputs().size(); ++block) {
            std::vector<InstanceCommand> commands(kCommandCapacity);
            for (InstanceCommand& command : commands) {
                command.instance = random.below(10);
                command.kind = static_cast<CommandKind>(random.below(10));
                command.target = random.below(4);
                for (uint32_t& word : command.data)
                    word = random.chance(0.5) ? random.below(4) : random.below(UINT32_MAX);
            }
            write(crowd, block, commands);
        }
        ASSERT_TRUE(crowd.update(0.05f));
        for (uint32_t block = 0; block < crowd.outputs().size(); ++block) ignored += head_of(crowd, block).ignored;
    }
    EXPECT_GT(ignored, 1000u);
    EXPECT_LT(ignored, 20u * 5 * kCommandCapacity);
}

// Instances whose population the CPU controls may be commanded, but not spawned or despawned.
TEST_F(ShaderCommands, CanCommandInstancesThatTheCpuSpawned) {
    Crowd crowd = create(settings(false));
    write(crowd, 0,
          std::array{InstanceCommand::set_placement(1, at(3)), InstanceCommand::spawn(6, at(1)),
                     InstanceCommand::despawn(2)});
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(head_of(crowd, 0).ignored, 2u);
    EXPECT_EQ(alive_instances(crowd), (std::vector{0u, 1u, 2u, 3u}));
    EXPECT_EQ(placement(crowd, 1), at(3));
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{2}, at(4)));
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_EQ(placement(crowd, 1), at(3));
    EXPECT_EQ(placement(crowd, 2), at(4));
    // The slot is empty. The command must not affect an instance that is spawned there later.
    write(crowd, 0, std::array{InstanceCommand::set_playback(4, {.first = {.clip = 0, .time_s = 0.2}})});
    ASSERT_TRUE(crowd.update(0.1f));
    ASSERT_TRUE(crowd.spawn(0, std::array{at(0)}));
    ASSERT_TRUE(crowd.update(0.1f));
    EXPECT_TRUE(same_bits(*crowd.read_skin_matrices(*crowd.handle(4)), *crowd.read_skin_matrices(InstanceHandle{3})));
}

TEST_F(ShaderCommands, CpuCallsAreRefusedIfShadersPopulate) {
    Crowd crowd = create(settings());
    write(crowd, 0, std::array{InstanceCommand::spawn(2, at(1))});
    ASSERT_TRUE(crowd.update(0.1f));
    const InstanceHandle one{2};
    EXPECT_FALSE(crowd.is_alive(one));
    for (const std::string& message :
         {refusal(crowd.spawn(0, std::array{at(0)})), refusal(crowd.despawn(std::array{one})),
          refusal(crowd.set_placement(one, at(0))), refusal(crowd.set_playback(crowd.instances(), Playback())),
          refusal(crowd.handle(2)), refusal(crowd.alive_count(0))})
        EXPECT_NE(message.find("only shaders spawn, despawn and control its instances"), std::string::npos) << message;
    EXPECT_TRUE(crowd.read_skin_matrices(one));
    EXPECT_FALSE(crowd.read_skin_matrices(InstanceHandle{8}));
}

TEST_F(ShaderCommands, IncompatibleSettingsAreRefused) {
    const auto message = [&](auto change) {
        CrowdSettings of = settings();
        change(of.groups[0]);
        return refusal(Crowd::create(test_device(), of));
    };
    EXPECT_NE(message([](CrowdGroup& group) { group.capacity = 0; }).find("CrowdGroup::capacity is 0"),
              std::string::npos);
    EXPECT_NE(message([](CrowdGroup& group) { group.shader_commands->capacity = 0; }).find("must be above 0"),
              std::string::npos);
    EXPECT_NE(message([](CrowdGroup& group) { group.instance_count = 1; }).find("instance_count must be 0"),
              std::string::npos);
    EXPECT_NE(message([](CrowdGroup& group) { group.pose_capacity = 1; }).find("pose_capacity"), std::string::npos);
    EXPECT_NE(message([](CrowdGroup& group) { group.is_carried = true; }).find("is_carried"), std::string::npos);
    EXPECT_NE(message([](CrowdGroup& group) { group.shader_commands->capacity = (1u << 20) + 1; }).find("1048576"),
              std::string::npos);
    EXPECT_TRUE(message([](CrowdGroup&) {}).empty());
}

// A saved state also contains commands that no update has applied yet.
TEST_F(ShaderCommands, PendingCommandsAreSaved) {
    Crowd crowd = create(settings()), other = create(settings());
    write(crowd, 0,
          std::array{InstanceCommand::spawn(5, at(1)), InstanceCommand::set_playback(5, {.first = {.clip = 0}})});
    ASSERT_TRUE(crowd.update(0.1f));
    write(crowd, 0, std::array{InstanceCommand::spawn(1, at(2))});
    write(other, 0, std::array{InstanceCommand::spawn(0, at(2)), InstanceCommand::spawn(2, at(2))});
    ASSERT_TRUE(other.update(0.3f));
    ASSERT_TRUE(other.restore_state(*crowd.save_state()));
    for (Crowd* const one : {&crowd, &other}) ASSERT_TRUE(one->update(0.1f));
    EXPECT_EQ(alive_instances(other), (std::vector{1u, 5u}));
    expect_same(contents_of(crowd.outputs()), contents_of(other.outputs()), "");
}

// Pictures are fitted to the current instances.
TEST_F(ShaderCommands, WorldBoundsFollowThemOnceDrawn) {
    if (const std::string reason = undrawable_reason(DrawPath::kAuto); !reason.empty()) GTEST_SKIP() << reason;
    Crowd crowd = create(settings());
    Renderer renderer = Renderer::create(test_device(), {.width = 64, .height = 64}).value();
    const auto picture = [&] { ASSERT_TRUE(renderer.render(crowd, Camera{.eye = {0, 1, 5}, .target = {}})); };
    write(crowd, 0, std::array{InstanceCommand::spawn(5, at(40)), InstanceCommand::spawn(1, at(-70))});
    ASSERT_TRUE(crowd.update(0.1f));
    picture();
    ASSERT_TRUE(crowd.update(0.1f));
    Bounds bounds = world_bounds(crowd);
    EXPECT_LT(bounds.min.x, -69);
    EXPECT_GT(bounds.max.x, 39);
    write(crowd, 0, std::array{InstanceCommand::despawn(1)});
    ASSERT_TRUE(crowd.update(0.1f));
    bounds = world_bounds(crowd);
    EXPECT_GT(bounds.min.x, 30);
}

}  // namespace
}  // namespace throng::test
