// Crowds of all kinds on one native device, each updated by its own thread, and a joint sampler shared by all: the
// results equal those of one thread. ./run sanitize runs this under the thread sanitizer.
#include "crowd/crowd_state.h"
#include "tests/kernel_runner.h"
#include "tests/lively_crowd.h"
#include "tools/creatures/creature.h"

#include <throng/joint_sampler.h>

#include <functional>
#include <thread>

namespace throng::test {
namespace {

constexpr uint32_t kUpdateCount = 6;

Affine place_of(uint32_t i, float apart) {
    return to_affine(Trs<float>{.translation = Vec3<float>{float(i % 6), 0, float(i / 6)} * apart});
}

// Moves along x from update to update, so that other characters come into view.
CrowdView view_in(uint32_t update, float apart) {
    return view_of_box(Vec3<float>{static_cast<float>(update), 0, 1} * apart, 3 * apart);
}

// Two clips with poses from outside; a controller with layers, masks, inertial transitions and sockets; agents on
// terrain; procedural rules; morph targets.
struct ManyKinds {
    static constexpr uint32_t kEach = 12;
    Character character = creature(30, 10),
              morphing = compiled(make_asset({.joint_count = 9, .seed = 4, .morph_count = 6}));
    Controller dragon = example("dragon");
    ProceduralRules rules{.targets = {"there"},
                          .rules = {WindRule{.joint = character.rig.names[1]},
                                    LookAtRule{.joint = character.rig.names.back(), .target = "there"}}};
    Terrain terrain{.columns = 2, .rows = 2, .heights = {0, 1, 2, 3}};
    CrowdSettings settings{.groups = {{.character = &character, .instance_count = kEach, .pose_capacity = kEach / 2},
                                      {.character = &character,
                                       .instance_count = kEach,
                                       .controller = &dragon,
                                       .sockets = {3, 7},
                                       .pose_capacity = kEach},
                                      {.character = &character,
                                       .instance_count = kEach,
                                       .steering = Steering{.radius = 0.3f, .speed = 3},
                                       .terrain = &terrain},
                                      {.character = &character, .instance_count = kEach, .procedural = &rules},
                                      {.character = &morphing, .instance_count = kEach}},
                           .keep_previous_matrices = true,
                           .culling = Culling{.skips_updates = true},
                           .skins_once = true};

    ManyKinds() = default;
    ManyKinds(const ManyKinds&) = delete;

    void change(Crowd& crowd, Random& random) const {
        const std::vector<Playback> two = random_playbacks(random, character, 3),
                                    morphs = random_playbacks(random, morphing, 3);
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(random.below(kEach - 3), 3), two));
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(4 * kEach + random.below(kEach - 3), 3), morphs));
        for (uint32_t i = 0; i < kEach; ++i) {
            const auto [parameter, value] = random_change(random, dragon);
            EXPECT_TRUE(crowd.set_parameter(InstanceHandle{kEach + i}, parameter, value));
        }
        const Vec3<float> somewhere = random.vector(6).as<float>();
        EXPECT_TRUE(crowd.set_destination(InstanceHandle{2 * kEach + random.below(kEach)}, somewhere));
        EXPECT_TRUE(crowd.set_target(InstanceHandle{3 * kEach + random.below(kEach)}, 0, {somewhere, 1}));
        EXPECT_TRUE(crowd.set_wind({.velocity = somewhere}));
        const auto fade_s = static_cast<float>(random.between(0, 0.4));
        const uint32_t posed = kEach + random.below(kEach);
        EXPECT_TRUE(random.chance(0.6) ? crowd.set_pose(InstanceHandle{posed}, character.rig.rest, fade_s)
                                       : crowd.clear_pose(InstanceHandle{posed}, fade_s));
    }

    std::vector<std::byte> run(const Device& device) const {
        Crowd crowd = *Crowd::create(device, settings);
        const float apart = 2 * character.size;
        std::vector<Affine> places;
        for (uint32_t i = 0; i < crowd.instance_count(); ++i) places.push_back(place_of(i, apart));
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
        Random random(3);
        UpdateBits bits;
        for (uint32_t update = 0; update < kUpdateCount; ++update) {
            change(crowd, random);
            CrowdView view = view_in(update, apart);
            view.full_rate_pixels = 40;
            EXPECT_TRUE(crowd.update(static_cast<float>(random.between(0, 0.1)), update % 2 == 0 ? nullptr : &view));
            bits.add_feedback(crowd);
            bits.add_drawn(crowd);
            bits.add_results(crowd);
        }
        return bits.all;
    }
};

// At this distance all use coarser levels of detail, which have fewer joints.
std::vector<std::byte> run_far_away(const Device& device, const Character& character) {
    constexpr uint32_t kCount = 40;
    Crowd crowd = *Crowd::create(device, {.groups = {{&character, kCount}},
                                          .skin_format = SkinFormat::kHalfAffine,
                                          .culling = Culling{.reduces_joints = true}});
    EXPECT_GT(crowd.state().groups[0].fused.size(), 1u);
    const float apart = 2 * character.size;
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kCount; ++i) places.push_back(place_of(i, apart));
    EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
    Random random(4);
    EXPECT_TRUE(crowd.set_playback(crowd.instances(), random_playbacks(random, character, kCount)));
    UpdateBits bits;
    size_t drawn = 0, coarse = 0;
    for (uint32_t update = 0; update < kUpdateCount; ++update) {
        CrowdView view = view_in(update, apart);
        view.lod_pixels = 4;
        EXPECT_TRUE(crowd.update(0.05f, update % 3 == 0 ? nullptr : &view));
        const std::vector<DrawnInstance> seen = drawn_of(crowd);
        drawn += seen.size();
        coarse += static_cast<size_t>(std::ranges::count_if(seen, [](const auto& one) { return one.lod > 0; }));
        bits.add_drawn(crowd);
        bits.add_results(crowd);
    }
    EXPECT_GT(coarse, 0u);
    EXPECT_LT(drawn, kUpdateCount * kCount);
    return bits.all;
}

std::vector<std::byte> run_sampler(const JointSampler& sampler, uint32_t joint_count) {
    UpdateBits bits;
    std::vector<Affine> model_from_joint(joint_count);
    for (uint32_t i = 0; i < 200; ++i) {
        const Playback playback{.first = {.clip = 0, .time_s = 0.13 * i}, .weight = static_cast<float>(i % 5) / 4};
        EXPECT_TRUE(sampler.sample(playback, model_from_joint));
        bits.add(model_from_joint);
    }
    return bits.all;
}

TEST(NativeThreads, ThreadsCanUpdateSeparateCrowdsOnOneDevice) {
    LivelyCrowd lively(12, 8, 20);
    lively.settings.culling.emplace();
    lively.settings.skins_once = true;
    const ManyKinds kinds;
    const Character far = *compile_character(*make_creature({.joint_count = 40, .level_count = 12, .face_count = 800}));
    const std::vector<uint32_t> joints{29, 3};
    const JointSampler sampler = *JointSampler::create(kinds.character, joints);
    using Run = std::function<std::vector<std::byte>(const Device&)>;
    const std::vector<Run> runs{
        [&](const Device& device) { return bits_of(lively, device, UpdatePath::kFused, kUpdateCount); },
        [&](const Device& device) { return bits_of(lively, device, UpdatePath::kStaged, kUpdateCount); },
        [&](const Device& device) { return kinds.run(device); },
        [&](const Device& device) { return run_far_away(device, far); },
        [&](const Device&) { return run_sampler(sampler, static_cast<uint32_t>(joints.size())); }};
    std::vector<std::vector<std::byte>> wanted;
    for (const Run& run : runs) wanted.push_back(run(native_device({.threads = 1})));
    const Device device = native_device({.threads = 4});
    std::vector<std::thread> threads;
    for (size_t t = 0; t < runs.size(); ++t)
        threads.emplace_back([&, t] {
            for (const size_t k : {t, (t + 1) % runs.size()})
                EXPECT_TRUE(same_bits(runs[k](device), wanted[k])) << "run " << k << " of thread " << t;
        });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace throng::test
