// The native renderer against the device's: the same pictures of crowds of all kinds, and the same bytes for any number
// of threads.
#include "bench/psnr.h"
#include "draw/camera.h"
#include "draw/crowd_bounds.h"
#include "draw/native_renderer.h"
#include "tests/ball.h"
#include "tests/crowd_cases.h"
#include "tests/picture_copy.h"
#include "tests/recorder.h"
#include "tests/subset.h"
#include "tools/creatures/creature.h"

#include <cstdio>
#include <map>
#include <optional>

namespace throng::test {
namespace {

const InSubset kNativeDrawInSubsets({Subset::kNative}, {"NativePictures.*"});

using bench::psnr;

constexpr uint32_t kNativeDrawWidth = 240, kNativeDrawHeight = 160;
constexpr double kMinDetail = 0.005;  // of the pixels (part_with_detail)

double min_dB() { return bench::min_alike_db(test_gpu()->properties.limits.subPixelPrecisionBits); }

Renderer make_renderer(const RendererSettings& settings) {
    Result<Renderer> made = Renderer::create(test_device(), settings);
    if (!made) throw std::runtime_error(made.error().text());
    return std::move(*made);
}
Renderer make_renderer(DrawPath path) {
    return make_renderer({.width = kNativeDrawWidth, .height = kNativeDrawHeight, .path = path});
}

// Both renderers of the test device.
struct Pair {
    explicit Pair(uint32_t samples, uint32_t width = kNativeDrawWidth, uint32_t height = kNativeDrawHeight)
        : native(make_renderer({.width = width, .height = height, .samples = samples, .path = DrawPath::kNative})),
          device(make_renderer({.width = width, .height = height, .samples = samples, .path = DrawPath::kDevice})) {}
    Renderer native, device;
};

// The share of pixels that differ from the pixel three to the right. Sky and ground without shadows change little along
// a row; characters do.
double part_with_detail(const Picture& picture) {
    constexpr size_t kStep = 3;
    size_t count = 0;
    for (size_t y = 0; y < picture.height; ++y)
        for (size_t x = 0; x + kStep < picture.width; ++x) {
            const uint8_t* const pixel = &picture.rgba[(y * picture.width + x) * 4];
            int apart = 0;
            for (size_t i = 0; i < 3; ++i) apart += std::abs(pixel[i] - pixel[4 * kStep + i]);
            count += apart > 40;
        }
    return static_cast<double>(count) / (picture.width * picture.height);
}

class NativeDraw : public testing::Test {
protected:
    void SetUp() override {
        if (!test_gpu()->processor || test_gpu()->is_native()) GTEST_SKIP() << "no device has both renderers";
    }
    static void TearDownTestSuite() { pairs().clear(); }
    // Keyed by sample count. Kept, since creating pipelines takes longer than drawing a small picture.
    static std::map<uint32_t, Pair>& pairs() {
        static std::map<uint32_t, Pair> all;
        return all;
    }

    // Updates the crowd and draws it with both renderers. If THRONG_PICTURES names a folder, the pictures are written
    // there.
    static void expect_alike(const std::string& what, Pair& pair, Crowd& crowd, const Camera& camera,
                             const DrawOptions& options, size_t left_out_pixels = 0) {
        std::vector<Picture> pictures;
        ASSERT_TRUE(pair.native.set_options(options));
        const Result<void> updated = pair.native.update(crowd, 0.3f, camera);
        ASSERT_TRUE(updated) << updated.error().text();
        for (Renderer* const renderer : {&pair.native, &pair.device}) {
            ASSERT_TRUE(renderer->set_options(options));
            Result<RenderResult> result = renderer->render(crowd, camera);
            ASSERT_TRUE(result) << result.error().text();
            EXPECT_TRUE(result->warnings.empty()) << result->warnings.front();
            if (const char* const folder = std::getenv("THRONG_PICTURES")) {
                const std::string name = what + (renderer->is_native() ? " native.png" : " device.png");
                EXPECT_TRUE(write_png(std::filesystem::path(folder) / name, result->picture));
            }
            pictures.push_back(std::move(result->picture));
        }
        EXPECT_GT(static_cast<NativeRenderer&>(pair.native.state()).times().triangles, 0u) << what << ": empty";
        const double alike_dB = psnr(pictures[0], pictures[1], left_out_pixels);
        std::printf("  %s: %.1f dB\n", what.c_str(), alike_dB);
        EXPECT_GE(alike_dB, min_dB()) << what;

        DrawOptions characters_only = options;
        characters_only.shadows = characters_only.skeletons = characters_only.bounds = false;
        ASSERT_TRUE(pair.native.set_options(characters_only));
        EXPECT_GT(part_with_detail(pair.native.render(crowd, camera)->picture), kMinDetail)
            << what << ": no characters are seen";
    }
    static void expect_alike(const std::string& what, Crowd& crowd, const Camera& camera,
                             const DrawOptions& options = {}, uint32_t samples = 4, size_t left_out_pixels = 0) {
        Pair& pair = pairs().try_emplace(samples, samples).first->second;
        expect_alike(what, pair, crowd, camera, options, left_out_pixels);
    }
    static void expect_alike(const std::string& what, Crowd& crowd, const DrawOptions& options = {},
                             uint32_t samples = 4) {
        expect_alike(what, crowd, whole(crowd), options, samples);
    }
    static Camera whole(const Crowd& crowd) {
        return fit_camera(world_bounds(crowd), static_cast<float>(kNativeDrawWidth) / kNativeDrawHeight);
    }
};

// In rows behind each other, each with its own rotation and size; every other one mirrored if `has_mirrored`.
std::vector<Affine> in_rows(const Character& character, uint32_t count, bool has_mirrored = false) {
    const auto columns = static_cast<uint32_t>(std::ceil(std::sqrt(count)));
    std::vector<Affine> places;
    for (uint32_t i = 0; i < count; ++i) {
        const float size = 0.8f + 0.1f * static_cast<float>(i % 4), side = has_mirrored && i % 2 == 1 ? -size : size;
        places.push_back(to_affine(Trs<float>{
            axis_angle(Vec3<float>{0, 1, 0}, static_cast<float>(i)),
            Vec3<float>{static_cast<float>(i % columns), 0, static_cast<float>(i / columns)} * (0.9f * character.size),
            {side, has_mirrored ? 1.3f * size : size, size}}));
    }
    return places;
}

Crowd placed_crowd(const std::vector<CrowdGroup>& groups, CrowdSettings settings = {}, bool has_mirrored = false) {
    settings.groups = groups;
    Crowd crowd = create(settings);
    uint32_t first = 0;
    Random random(3);
    for (const CrowdGroup& group : groups) {
        std::vector<Affine> places = in_rows(*group.character, group.instance_count, has_mirrored);
        // Groups stand side by side
        for (Affine& place : places) place.row[0][3] += static_cast<float>(first) * 0.7f;
        EXPECT_TRUE(crowd.set_placement(Instances::numbered(first, group.instance_count), places));
        const std::vector<Playback> playbacks = random_playbacks(random, *group.character, group.instance_count);
        EXPECT_TRUE(group.controller ||
                    crowd.set_playback(Instances::numbered(first, group.instance_count), playbacks));
        first += group.instance_count;
    }
    return crowd;
}
Crowd placed_crowd(const Character& character, uint32_t count, const CrowdSettings& settings = {},
                   bool has_mirrored = false) {
    return placed_crowd({{&character, count}}, settings, has_mirrored);
}

TEST_F(NativeDraw, ControllersAndLevelsOfDetailMatchTheDevice) {
    const Character walker = compiled(*make_creature(creature_settings(CreatureKind::kWalker)), {});
    const Controller controller = example("walker");
    for (const bool reduces : {false, true}) {
        Crowd crowd = placed_crowd({{.character = &walker, .instance_count = 300, .controller = &controller}},
                                   {.culling = Culling{.reduces_joints = reduces}});
        expect_alike(reduces ? "walkers with fewer joints" : "walkers", crowd);
    }
}

TEST_F(NativeDraw, FilesMatchTheDevice) {
    const std::filesystem::path folder = shared_folder("characters");
    THRONG_SKIP_WITHOUT(folder);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".glb" && entry.path().extension() != ".gltf") continue;
        const Result<Character> character = load_character(entry.path());
        ASSERT_TRUE(character) << character.error().text();
        const std::string name = entry.path().stem().string();
        Crowd one = placed_crowd(*character, 1), many = placed_crowd(*character, 100, {.culling = Culling{}});
        // Some clips walk far away from where the rest pose stands
        expect_alike(name, one,
                     fit_camera(bounds_of(std::array{&one.state()}, Outliers::kIncluded).posed,
                                static_cast<float>(kNativeDrawWidth) / kNativeDrawHeight));
        expect_alike(name + " 100", many);
    }
}

TEST_F(NativeDraw, CreaturesMatchTheDevice) {
    for (const CreatureKind kind : {CreatureKind::kDragon, CreatureKind::kWillow, CreatureKind::kCentipede}) {
        const Character character = compiled(*make_creature(creature_settings(kind)), {});
        const std::string name = "creature " + std::to_string(static_cast<int>(kind));
        Crowd one = placed_crowd(character, 1), many = placed_crowd(character, 30, {.culling = Culling{}});
        expect_alike(name, one);
        expect_alike(name + " 30", many);
    }
}

TEST_F(NativeDraw, LinesMatchTheDevice) {
    const Character character = creature();
    for (const bool culls : {false, true}) {
        Crowd crowd = placed_crowd(
            character, 20, {.keep_model_matrices = true, .culling = culls ? std::optional(Culling{}) : std::nullopt});
        const std::string with = culls ? ", culled" : "";
        expect_alike("skeletons" + with, crowd, {.skeletons = true});
        expect_alike("bounds" + with, crowd, {.bounds = true});
        expect_alike("skeletons and bounds" + with, crowd, {.skeletons = true, .bounds = true}, 1);
    }
}

TEST_F(NativeDraw, EveryWayOfSkinningMatchesTheDevice) {
    for (const uint32_t influences : {4u, 8u}) {
        const Character ball = compiled(make_ball({.influence_count = influences}), kExact);
        for (const SkinFormat format : {SkinFormat::kAffine, SkinFormat::kHalfAffine, SkinFormat::kSimilarity})
            for (const SkinBlend blend : {SkinBlend::kLinear, SkinBlend::kDualQuaternion})
                for (const bool once : {false, true}) {
                    Crowd crowd = placed_crowd(ball, 9,
                                               {.skin_format = format,
                                                .culling = once ? std::optional(Culling{}) : std::nullopt,
                                                .skin_blend = blend,
                                                .skins_once = once});
                    expect_alike("format " + std::to_string(static_cast<int>(format)) + ", blend " +
                                     std::to_string(static_cast<int>(blend)) + ", " + std::to_string(influences) +
                                     (once ? ", once" : ""),
                                 crowd);
                }
    }
}

TEST_F(NativeDraw, AnyRigMatchesTheDevice) {
    for (const double spread : {0.0, 0.3}) {
        const Character character = make_character(
            {.scale_spread = spread, .vertex_count = 300, .morph_count = spread > 0 ? 3u : 0u});
        for (const bool once : {false, true}) {
            Crowd crowd = placed_crowd(character, 16, {.skins_once = once});
            expect_alike("spread " + std::to_string(spread) + (once ? ", once" : ""), crowd);
        }
    }
}

TEST_F(NativeDraw, MorphsMatchTheDevice) {
    const Character ball = compiled(make_ball({.has_morphs = true}), kExact);
    for (const SkinBlend blend : {SkinBlend::kLinear, SkinBlend::kDualQuaternion})
        for (const bool once : {false, true}) {
            Crowd crowd = placed_crowd(ball, 9, {.skin_blend = blend, .skins_once = once});
            expect_alike("morphs " + std::to_string(static_cast<int>(blend)) + (once ? ", once" : ""), crowd);
        }
}

TEST_F(NativeDraw, MaterialsMatchTheDevice) {
    for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend})
        for (const bool is_double_sided : {false, true}) {
            Asset asset = make_ball({.is_open = true});
            add_maps(asset);
            asset.materials[0].alpha_mode = mode;
            asset.materials[0].alpha_cutoff = 0.3f;
            asset.materials[0].double_sided = is_double_sided;
            const Character ball = compiled(asset, kExact);
            Crowd one = placed_crowd(ball, 1), many = placed_crowd(ball, 12);
            const std::string name = "material " + std::to_string(static_cast<int>(mode)) +
                                     (is_double_sided ? ", both sides" : "");
            expect_alike(name, one);
            expect_alike(name + ", small", many);
            // lavapipe computes mip levels with a linear approximation of log2, up to 0.043 below the exact ones. At
            // the edge of a mask, an alpha close to the cutoff may then fall on the other side; with one sample, that
            // is a whole pixel
            const size_t left_out_pixels = mode == AlphaMode::kOpaque ? 0 : kNativeDrawWidth * kNativeDrawHeight / 1000;
            expect_alike(name + ", 1 sample", many, whole(many), {}, 1, left_out_pixels);
        }
}

TEST_F(NativeDraw, SamplersMatchTheDevice) {
    for (const TextureFilter filter : {TextureFilter::kLinear, TextureFilter::kNearest})
        for (const auto& [u, v] : {std::pair(TextureWrap::kRepeat, TextureWrap::kMirror),
                                   {TextureWrap::kMirror, TextureWrap::kClamp},
                                   {TextureWrap::kClamp, TextureWrap::kRepeat}}) {
            Asset asset = make_ball({.is_open = true});
            add_maps(asset);
            AssetMaterial& material = asset.materials[0];
            material.filter = filter;
            material.wrap_u = u;
            material.wrap_v = v;
            for (std::array<float, 2>& texcoord : asset.meshes[0].primitives[0].texcoords)
                texcoord = {2.5f * texcoord[0] - 0.7f, 2.5f * texcoord[1] - 0.7f};
            const Character ball = compiled(asset, kExact);
            Crowd one = placed_crowd(ball, 1), many = placed_crowd(ball, 12);
            const std::string name = joined("sampler ", static_cast<int>(filter), static_cast<int>(u),
                                            static_cast<int>(v));
            expect_alike(name, one);
            expect_alike(name + ", small", many);
        }
}

TEST_F(NativeDraw, MirroredAndStretchedInstancesMatchTheDevice) {
    for (const bool is_double_sided : {false, true}) {
        Asset asset = make_ball({.is_open = true, .has_morphs = true});
        add_maps(asset);
        asset.materials[0].double_sided = is_double_sided;
        const Character ball = compiled(asset, kExact);
        for (const bool once : {false, true}) {
            Crowd crowd = placed_crowd(ball, 9, {.skins_once = once}, true);
            expect_alike(std::string("mirrored") + (is_double_sided ? ", both sides" : "") + (once ? ", once" : ""),
                         crowd);
        }
    }
}

TEST_F(NativeDraw, GroupsMatchTheDevice) {
    Asset textured = make_ball({.has_morphs = true});
    add_maps(textured);
    textured.materials[0].alpha_mode = AlphaMode::kMask;
    const Character ball = compiled(textured, kExact), small = small_character(), dragon = creature();
    const Controller controller = example("dragon");
    Crowd crowd = placed_crowd(
        {{&ball, 12},
         {&small, 9},
         {.character = &dragon, .instance_count = 4, .controller = &controller, .pose_capacity = 2},
         {&ball, 3}},
        {.keep_model_matrices = true, .culling = Culling{.skips_updates = true}});
    expect_alike("groups", crowd);
    expect_alike("groups, all lines", crowd, {.skeletons = true, .bounds = true});
}

TEST_F(NativeDraw, OptionsMatchTheDevice) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 20, {.culling = Culling{}});
    expect_alike("no shadows", crowd, {.shadows = false});
    expect_alike("no fog", crowd, {.fog = false});
    expect_alike("dark", crowd, {.exposure = 0.4f});
    expect_alike("bright", crowd, {.exposure = 3});
    expect_alike("low sun", crowd, {.to_sun = {1, 0.1f, 0.2f}});
    expect_alike("coarse", crowd, {.lod_pixels = 5});
    expect_alike("1 sample", crowd, {}, 1);
}

// One of very many instances stands so high that the shadow map does not include it. Its shadow must still be visible.
TEST_F(NativeDraw, AnOutlierHighAboveMatchesTheDevice) {
    const Character ball = compiled(make_ball({}), kExact);
    constexpr uint32_t kMany = 110;
    Crowd crowd = placed_crowd(ball, kMany);
    const float size = ball.size;
    ASSERT_TRUE(crowd.set_placement(InstanceHandle{0}, placed_at(4 * size, 400 * size, 4 * size)));
    const Camera camera{.eye = {12 * size, 9 * size, 14 * size}, .target = {4 * size, 0, 4 * size}};
    expect_alike("an outlier high above", crowd, camera, {.to_sun = {0, 1, 0}});
}

// With these cameras, triangles cross the near plane, are seen through the ground, or are smaller than pixels.
TEST_F(NativeDraw, CamerasMatchTheDevice) {
    const Character character = creature();
    for (const bool culls : {false, true}) {
        Crowd crowd = placed_crowd(
            character, 25, {.keep_model_matrices = true, .culling = culls ? std::optional(Culling{}) : std::nullopt});
        const Bounds bounds = world_bounds(crowd);
        const Vec3<float> middle = (bounds.min + bounds.max) * 0.5f, extent = bounds.max - bounds.min;
        const std::string with = culls ? ", culled" : "";
        const DrawOptions lines{.skeletons = true, .bounds = true};
        for (const DrawOptions& options : {DrawOptions{}, lines}) {
            const std::string more = with + (options.bounds ? ", lines" : "");
            expect_alike("inside" + more, crowd, {.eye = middle, .target = middle + Vec3<float>{1, -0.1f, 0.3f}},
                         options);
            expect_alike("at one's feet" + more, crowd,
                         {.eye = {0.1f, 0.2f, 0.3f}, .target = middle, .vertical_field_of_view_rad = 1.5f}, options);
            expect_alike("from above" + more, crowd, {.eye = middle + Vec3<float>{0, extent.x, 0}, .target = middle},
                         options);
            expect_alike("from below" + more, crowd,
                         {.eye = middle - Vec3<float>{extent.x, extent.y, 0}, .target = middle}, options);
            expect_alike("far away" + more, crowd, {.eye = middle + Vec3<float>{0, 1, 4} * extent.x, .target = middle},
                         options);
        }
    }
}

// The tiles at the right and bottom edges are smaller than the others. The larger picture has more than sixteen tiles.
TEST_F(NativeDraw, LargePicturesMatchTheDevice) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 40, {.culling = Culling{}});
    for (const auto& [width, height] : {std::pair(1000u, 600u), {2003u, 1111u}}) {
        Pair pair(4, width, height);
        const Camera camera = fit_camera(world_bounds(crowd), static_cast<float>(width) / static_cast<float>(height));
        for (const bool shadows : {true, false})
            expect_alike(std::to_string(width) + " wide" + (shadows ? "" : ", no shadows"), pair, crowd, camera,
                         {.shadows = shadows});
    }
}

// Two frames per command buffer, and more of both than can be in flight.
TEST_F(NativeDraw, RecordedDrawingEqualsRender) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 9, {.culling = Culling{}});
    const Camera camera = whole(crowd);
    Renderer renderer = make_renderer(DrawPath::kNative);
    for (int submission = 0; submission < 3; ++submission) {
        std::vector<Picture> drawn;
        std::vector<PictureCopy> copies;
        test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
            for (int frame = 0; frame < 2; ++frame) {
                ASSERT_TRUE(renderer.update(crowd, 0.3f, camera));
                drawn.push_back(renderer.render(crowd, camera)->picture);
                ASSERT_TRUE(renderer.record_drawing(commands, crowd, camera));
                copies.emplace_back(kNativeDrawWidth, kNativeDrawHeight).record(commands, renderer);
            }
        });
        EXPECT_NE(drawn[0].rgba, drawn[1].rgba);
        for (size_t frame = 0; frame < 2; ++frame)
            EXPECT_EQ(copies[frame].picture().rgba, drawn[frame].rgba) << submission << ", " << frame;
    }
}

// Displays take blue first, with either renderer. A picture that is returned always has red first.
TEST_F(NativeDraw, RecordedPicturesCanHaveBlueFirst) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 9, {.culling = Culling{}});
    const Camera camera = whole(crowd);
    ASSERT_TRUE(crowd.update(0.3f));
    for (const DrawPath path : {DrawPath::kNative, DrawPath::kDevice}) {
        const Picture wanted = make_renderer(path).render(crowd, camera)->picture;
        Renderer renderer = make_renderer(
            {.width = kNativeDrawWidth, .height = kNativeDrawHeight, .path = path, .blue_first = true});
        EXPECT_EQ(renderer.render(crowd, camera)->picture.rgba, wanted.rgba);
        const PictureCopy copy(kNativeDrawWidth, kNativeDrawHeight);
        test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
            ASSERT_TRUE(renderer.record_drawing(commands, crowd, camera));
            copy.record(commands, renderer);
        });
        Picture copied = copy.picture();
        EXPECT_NE(copied.rgba, wanted.rgba);
        for (size_t i = 0; i < copied.rgba.size(); i += 4) std::swap(copied.rgba[i], copied.rgba[i + 2]);
        EXPECT_EQ(copied.rgba, wanted.rgba);
    }
}

// Where the update is recorded too, by either of the calls that record one.
TEST_F(NativeDraw, TheDeviceDrawsWhatItUpdates) {
    const Character character = creature();
    Renderer renderer = make_renderer(DrawPath::kNative);
    for (const bool in_one : {false, true}) {
        Crowd crowd = placed_crowd(character, 9, {.path = UpdatePath::kDevice, .culling = Culling{}});
        const Camera camera = whole(crowd);
        const PictureCopy copy(kNativeDrawWidth, kNativeDrawHeight);
        test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
            if (in_one) {
                ASSERT_TRUE(renderer.record(commands, crowd, 0.3f, camera));
            } else {
                const CrowdView view = *view_of(camera, kNativeDrawWidth, kNativeDrawHeight, world_bounds(crowd));
                ASSERT_TRUE(crowd.record(commands, 0.3f, &view));
                ASSERT_TRUE(renderer.record_drawing(commands, crowd, camera));
            }
            copy.record(commands, renderer);
        });
        EXPECT_GT(renderer.draw_ms(), 0);
        const Result<RenderResult> drawn = renderer.render(crowd, camera);
        ASSERT_TRUE(drawn);
        EXPECT_GE(psnr(copy.picture(), drawn->picture), min_dB());
        EXPECT_GT(renderer.draw_ms(), 0);
    }
}

// The commands of the update before have not run either, so that there are no poses yet that could be drawn natively.
TEST_F(NativeDraw, TheDeviceDrawsAlsoWhenTheLastUpdateIsDiscarded) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 9, {.path = UpdatePath::kDevice, .culling = Culling{}});
    const Camera camera = whole(crowd);
    Renderer renderer = make_renderer(DrawPath::kNative);
    const CrowdView view = *view_of(camera, kNativeDrawWidth, kNativeDrawHeight, world_bounds(crowd));
    const PictureCopy copy(kNativeDrawWidth, kNativeDrawHeight);
    const auto record = [&](VkCommandBuffer commands) { return crowd.record(commands, 0.3f, &view); };
    Recorder recorder;
    const VkCommandBuffer frame = recorder.record([&](VkCommandBuffer commands) {
        ASSERT_TRUE(record(commands));
        recorder.record([&](VkCommandBuffer dropped) { ASSERT_TRUE(record(dropped)); });
        ASSERT_TRUE(crowd.discard_last_record());
        ASSERT_TRUE(renderer.record_drawing(commands, crowd, camera));
        copy.record(commands, renderer);
    });
    recorder.submit(frame);
    test_gpu()->wait_idle();
    EXPECT_GT(part_with_detail(copy.picture()), kMinDetail);
    EXPECT_GE(psnr(copy.picture(), renderer.render(crowd, camera)->picture), min_dB());
}

TEST_F(NativeDraw, IsChosenForSoftwareDevicesAndNotForGpus) {
    EXPECT_TRUE(make_renderer(DrawPath::kAuto).is_native());
    EXPECT_FALSE(make_renderer(DrawPath::kDevice).is_native());

    const Device gpu = another_device();
    gpu.gpu()->processor.reset();  // as on hardware, which has none
    EXPECT_NE(natively_undrawable_reason(*gpu.gpu()).find("is a GPU"), std::string::npos);
    const Result<Renderer> native = Renderer::create(gpu, {.width = 8, .height = 8, .path = DrawPath::kNative}),
                           chosen = Renderer::create(gpu, {.width = 8, .height = 8});
    ASSERT_FALSE(native);
    EXPECT_EQ(native.error().code, ErrorCode::kUnsupported);
    ASSERT_TRUE(chosen);
    EXPECT_FALSE(chosen->is_native());
}

// Occlusion is a pass on the device. The native renderer neither runs it nor culls by it.
TEST_F(NativeDraw, OcclusionChangesNothing) {
    const Character character = creature();
    std::vector<Picture> pictures;
    for (const bool occlusion : {false, true}) {
        Crowd crowd = placed_crowd(character, 40, {.culling = Culling{}});
        Renderer renderer = make_renderer({.width = kNativeDrawWidth,
                                           .height = kNativeDrawHeight,
                                           .options = {.occlusion = occlusion},
                                           .path = DrawPath::kNative});
        for (int frame = 0; frame < 3; ++frame)  // the device would cull by the previous frame
            pictures.push_back(renderer.render_frame(crowd, 0.1f, whole(crowd))->picture);
    }
    for (size_t frame = 0; frame < 3; ++frame) EXPECT_EQ(pictures[frame].rgba, pictures[3 + frame].rgba) << frame;
    EXPECT_NE(pictures[0].rgba, pictures[2].rgba);
}

// Larger and smaller than before; drawn at once, by recorded commands, and by the device.
TEST_F(NativeDraw, ResizedRenderersEqualNewOnes) {
    const Character character = creature();
    Crowd crowd = placed_crowd(character, 9, {.culling = Culling{}}),
          updated_by_device = placed_crowd(character, 9, {.path = UpdatePath::kDevice, .culling = Culling{}});
    const Camera camera = whole(crowd);
    Renderer renderer = make_renderer({.width = 50, .height = 30, .path = DrawPath::kNative});
    for (const auto& [width, height] : {std::pair(800u, 500u), {kNativeDrawWidth, kNativeDrawHeight}}) {
        ASSERT_TRUE(renderer.resize(width, height));
        Renderer made = make_renderer({.width = width, .height = height, .path = DrawPath::kNative});
        const PictureCopy copy(width, height), of_device(width, height);
        test_gpu()->submit_and_wait([&](VkCommandBuffer commands) {
            ASSERT_TRUE(renderer.update(crowd, 0.3f, camera));
            ASSERT_TRUE(renderer.record_drawing(commands, crowd, camera));
            copy.record(commands, renderer);
            ASSERT_TRUE(renderer.record(commands, updated_by_device, 0.3f, camera));
            of_device.record(commands, renderer);
        });
        const Picture wanted = made.render(crowd, camera)->picture;
        EXPECT_EQ(copy.picture().rgba, wanted.rgba);
        EXPECT_EQ(renderer.render(crowd, camera)->picture.rgba, wanted.rgba);
        EXPECT_GE(psnr(of_device.picture(), made.render(updated_by_device, camera)->picture), min_dB());
    }
}

TEST(NativePictures, ThreadsChangeNothing) {
    Asset asset = make_ball({.is_open = true, .has_morphs = true});
    add_maps(asset);
    const Character ball = compiled(asset, kExact), dragon = creature();
    const auto picture = [&](const DeviceSettings& settings, const DrawOptions& options) {
        const Device device = *Device::create(settings);
        Crowd crowd = std::move(*Crowd::create(
            device, {.groups = {{&ball, 400}, {&dragon, 100}}, .keep_model_matrices = true, .culling = Culling{}}));
        Random random(8);
        std::vector<Affine> places = in_rows(ball, 400, true);
        for (const Affine& place : in_rows(dragon, 100)) places.push_back(place);
        EXPECT_TRUE(crowd.set_placement(crowd.instances(), places));
        EXPECT_TRUE(crowd.set_playback(Instances::numbered(400, 100), random_playbacks(random, dragon, 100)));
        Renderer renderer = std::move(*Renderer::create(device, {.width = 1000, .height = 600, .options = options}));
        Result<RenderResult> result = renderer.render_frame(crowd, 0.1f, fit_camera(world_bounds(crowd), 5.0f / 3));
        EXPECT_TRUE(result && result->draw_ms > 0);
        return std::move(result->picture);
    };
    EXPECT_GT(part_with_detail(picture({.select = "native", .threads = 1}, {.shadows = false})), kMinDetail);
    const DrawOptions all{.skeletons = true, .bounds = true};
    const Picture alone = picture({.select = "native", .threads = 1}, all);
    for (const uint32_t threads : {2u, 7u})
        EXPECT_EQ(picture({.select = "native", .threads = threads}, all).rgba, alone.rgba) << threads;
}

}  // namespace
}  // namespace throng::test
