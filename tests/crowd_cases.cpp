#include "tests/crowd_cases.h"

#include "control/control_reference.h"
#include "tools/creatures/creature.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>

namespace throng::test {

size_t different_bytes(const Picture& a, const Picture& b) {
    EXPECT_EQ(a.rgba.size(), b.rgba.size());
    size_t count = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) count += a.rgba[i] != b.rgba[i];
    return count;
}

Crowd create(CrowdSettings settings) {
    if (const char* scan = std::getenv("THRONG_TEST_SCAN"); scan && settings.scan == "auto") settings.scan = scan;
    const char* const path = std::getenv("THRONG_TEST_PATH");
    if (path && path == std::string_view("device") && settings.path == UpdatePath::kAuto)
        settings.path = UpdatePath::kDevice;
    Result<Crowd> crowd = Crowd::create(test_device(), settings);
    if (!crowd) {
        ADD_FAILURE() << crowd.error().text();
        std::abort();
    }
    return std::move(*crowd);
}

std::vector<std::vector<PlayedMotion>> copy_of(std::span<const std::span<const PlayedMotion>> layers) {
    std::vector<std::vector<PlayedMotion>> copies;
    for (const std::span<const PlayedMotion> layer : layers) copies.push_back(copy_of(layer));
    return copies;
}

std::vector<DrawnInstance> drawn_of(Crowd& crowd) {
    Result<std::vector<DrawnInstance>> drawn = crowd.read_drawn();
    if (!drawn) {
        ADD_FAILURE() << drawn.error().text();
        return {};
    }
    return std::move(*drawn);
}

Character creature(uint32_t joints, uint32_t levels, double error) {
    static std::map<std::tuple<uint32_t, uint32_t, double>, Character> compiled;  // tests share few shapes
    const auto [at, is_new] = compiled.try_emplace({joints, levels, error});
    if (is_new)
        at->second =
            compile_character(*make_creature({.joint_count = joints, .level_count = levels}), {.error = error}).value();
    return at->second;
}

Character creature_with_lods() {
    return *compile_character(*make_creature({.joint_count = 40, .level_count = 12, .face_count = 800}));
}

Affine placed_at(float x, float y, float z) { return to_affine(Trs<float>{.translation = {x, y, z}}); }

std::string path_name(const testing::TestParamInfo<UpdatePath>& of) {
    constexpr std::array kNames{"Auto", "Fused", "Staged", "Native", "Device"};  // [UpdatePath]
    return kNames[static_cast<size_t>(of.param)];
}

Controller example(const char* name) {
    Result<Controller> controller = load_controller(source_file(std::string("examples/controllers/") + name + ".json"));
    EXPECT_TRUE(controller) << (controller ? "" : controller.error().text());
    return std::move(*controller);
}

std::vector<ReferenceCharacter> references(const Character& character, const Controller& controller, uint32_t count) {
    std::vector<ReferenceCharacter> all;
    for (uint32_t i = 0; i < count; ++i) all.push_back(std::move(*ReferenceCharacter::create(character, controller)));
    return all;
}

ParameterChange random_change(Random& random, const Controller& controller) {
    const uint32_t parameter = random.below(static_cast<uint32_t>(controller.parameters.size()));
    const bool is_float = controller.parameters[parameter].type == ParameterType::kFloat;
    return {parameter, is_float ? static_cast<float>(random.between(-2, 3)) : static_cast<float>(random.below(2))};
}

Character small_character() { return make_character({.name = "small", .joint_count = 20}); }

ClipPlayback random_slot(Random& random, const Character& character) {
    const auto clip_count = static_cast<uint32_t>(character.clips.size());
    const uint32_t clip = random.below(clip_count + 1);
    return {.clip = clip == clip_count ? kNone : clip,
            .time_s = random.between(-1, 5),
            .speed = static_cast<float>(random.between(-2, 2)),
            .loop = random.chance(0.5)};
}

Playback random_playback(Random& random, const Character& character) {
    const std::array<float, 5> weights{0, 1, 0.5f, static_cast<float>(random.unit()),
                                       static_cast<float>(random.unit())};
    return {.first = random_slot(random, character),
            .second = random_slot(random, character),
            .weight = weights[random.below(5)]};
}

std::vector<Playback> random_playbacks(Random& random, const Character& character, uint32_t count) {
    std::vector<Playback> playbacks;
    for (uint32_t i = 0; i < count; ++i) playbacks.push_back(random_playback(random, character));
    return playbacks;
}

Playback advanced(Playback playback, const Character& character, double step_s) {
    for (ClipPlayback* play : {&playback.first, &playback.second}) {
        if (play->clip == kNone) continue;
        const double duration_s = character.clips[play->clip].duration_s;
        play->time_s = local_time_reference(play->time_s, duration_s, play->loop);
        play->time_s = local_time_reference(play->time_s + step_s * play->speed, duration_s, play->loop);
    }
    return playback;
}

double instance_error(Crowd& crowd, uint32_t instance, const Character& character, const Playback& playback,
                      bool with_model) {
    const ReferencePose pose = *reference_pose(character, playback);
    double worst = 0;
    const auto compare = [&](const Result<std::vector<Affine>>& got, const std::vector<AffineT<double>>& wanted) {
        if (!got || got->size() != wanted.size()) {
            worst = std::numeric_limits<double>::infinity();
            return;
        }
        for (size_t i = 0; i < wanted.size(); ++i)
            worst = std::max(worst, matrix_error((*got)[i], wanted[i], character.size));
    };
    compare(crowd.read_skin_matrices({instance}), pose.model_from_bind);
    if (with_model) compare(crowd.read_model_matrices({instance}), pose.model_from_joint);
    const std::vector<Vec3<double>> wanted = reference_positions(character, pose);
    const std::vector<Vec3<float>> got = *crowd.read_positions({instance});
    if (got.size() != wanted.size()) return std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < wanted.size(); ++i)
        worst = worse_of(worst, length(got[i].as<double>() - wanted[i]) / character.size);
    return worst;
}

double model_error(Crowd& crowd, uint32_t instance, const ReferencePose& wanted, double size) {
    const std::vector<Affine> model = *crowd.read_model_matrices({instance}),
                              skin = *crowd.read_skin_matrices({instance});
    double worst = 0;
    for (size_t i = 0; i < model.size(); ++i)
        worst = std::max(worst, matrix_error(model[i], wanted.model_from_joint[i], size));
    for (size_t i = 0; i < skin.size(); ++i)
        worst = std::max(worst, matrix_error(skin[i], wanted.model_from_bind[i], size));
    return worst;
}

std::vector<Affine> skins_of(Crowd& crowd) {
    std::vector<Affine> all;
    for (uint32_t instance = 0; instance < crowd.instance_count(); ++instance) {
        const Result<InstanceHandle> handle = crowd.handle(instance);
        if (!handle) continue;  // no instance in this slot
        const std::vector<Affine> skin = *crowd.read_skin_matrices(*handle);
        all.insert(all.end(), skin.begin(), skin.end());
    }
    return all;
}

MixedCrowd::MixedCrowd(double scale_spread) {
    for (const AssetSettings& asset :
         {AssetSettings{.name = "one", .joint_count = 1, .seed = 2}, AssetSettings{.name = "small", .seed = 6},
          AssetSettings{.name = "cubic", .joint_count = 70, .seed = 3, .cubic = true},
          AssetSettings{.name = "large", .joint_count = 300, .seed = 4}}) {
        AssetSettings scaled = asset;
        scaled.scale_spread = scale_spread;
        characters.push_back(make_character(scaled));
    }
    Random random(5);
    for (const Character& character : characters) {
        const uint32_t count = 5 + 3 * static_cast<uint32_t>(settings.groups.size());
        settings.groups.push_back({&character, count});
        for (const Playback& playback : random_playbacks(random, character, count)) playbacks.push_back(playback);
        character_of.insert(character_of.end(), count, &character);
    }
}

}  // namespace throng::test
