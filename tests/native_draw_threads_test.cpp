// Crowds with all materials on one native device, each drawn by its own thread: the pictures equal those of one thread.
// ./run sanitize runs this under the sanitizers.
#include "tests/ball.h"
#include "tests/kernel_runner.h"
#include "tests/lively_crowd.h"

#include <thread>

namespace throng::test {
namespace {

constexpr uint32_t kNativeDrawThreadsWidth = 200, kNativeDrawThreadsHeight = 140, kNativeDrawThreadsCount = 12,
                   kFrames = 3;

struct DrawnKind {
    Character character;
    CrowdSettings settings;
    uint32_t samples = 4;
    bool decodes_ahead = false;
};

std::vector<std::byte> pictures_of(const DrawnKind& kind, const Device& device) {
    CrowdSettings settings = kind.settings;
    settings.groups = {{&kind.character, kNativeDrawThreadsCount}};
    settings.keep_model_matrices = true;
    Crowd crowd = *Crowd::create(device, settings);
    Random random(6);
    std::vector<Affine> places;
    for (uint32_t i = 0; i < kNativeDrawThreadsCount; ++i)
        places.push_back(
            to_affine(Trs<float>{.translation = Vec3<float>{float(i % 4), 0, float(i / 4)} * kind.character.size,
                                 .scale = Vec3<float>{i % 3 == 0 ? -1.0f : 1.0f, 1, 1}}));
    EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
    EXPECT_TRUE(
        crowd.set_playback(crowd.instances(), random_playbacks(random, kind.character, kNativeDrawThreadsCount)));
    Renderer renderer = *Renderer::create(device, {.width = kNativeDrawThreadsWidth,
                                                   .height = kNativeDrawThreadsHeight,
                                                   .samples = kind.samples,
                                                   .options = {.skeletons = true}});
    if (kind.decodes_ahead) {
        EXPECT_TRUE(decode_images(crowd));
    }
    UpdateBits bits;
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const Camera camera = fit_camera(world_bounds(crowd),
                                         static_cast<float>(kNativeDrawThreadsWidth) / kNativeDrawThreadsHeight);
        const Result<RenderResult> result = renderer.render_frame(crowd, 0.1f, camera);
        EXPECT_TRUE(result) << result.error().text();
        if (result) bits.add(result->picture.rgba);
    }
    return bits.all;
}

TEST(NativeDrawThreads, ThreadsCanDrawSeparateCrowdsOnOneDevice) {
    std::vector<DrawnKind> kinds;
    for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask}) {
        Asset asset = make_ball({.columns = 12, .rows = 8, .is_open = true, .has_morphs = true});
        add_maps(asset);
        asset.materials[0].alpha_mode = mode;
        kinds.push_back({.character = *compile_character(asset),
                         .settings = {.culling = Culling{}},
                         .decodes_ahead = mode == AlphaMode::kMask});
    }
    kinds.push_back({.character = creature(30, 10),
                     .settings = {.skin_format = SkinFormat::kHalfAffine, .skins_once = true},
                     .samples = 1});
    kinds.push_back({.character = *compile_character(make_ball({.columns = 12, .rows = 8, .influence_count = 8})),
                     .settings = {.skin_blend = SkinBlend::kDualQuaternion}});
    std::vector<std::vector<std::byte>> wanted;
    for (const DrawnKind& kind : kinds) wanted.push_back(pictures_of(kind, native_device({.threads = 1})));
    const Device device = native_device({.threads = 4});
    std::vector<std::thread> threads;
    for (size_t t = 0; t < kinds.size(); ++t)
        threads.emplace_back(
            [&, t] { EXPECT_TRUE(same_bits(pictures_of(kinds[t], device), wanted[t])) << "crowd " << t; });
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace throng::test
