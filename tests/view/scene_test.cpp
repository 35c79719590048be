// The viewer's scene keeps its state when settings, controllers and looks change. On the native device, without a
// window.
#include "tools/view/scene.h"
#include "tests/tool_runner.h"
#include "tools/cli/command.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <string>
#include <utility>

namespace throng {
namespace {

using namespace test;

class ViewScene : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        generate("one.glb", "--joints 40 --levels 12 --faces 600");
    }

    // Three characters in all, from `file_count` files.
    static view::Scene scene_of(size_t file_count) {
        const Character character = load_character(file("one.glb")).expect();
        view::Cast cast(std::vector<Character>(file_count, character));
        return view::Scene(Device::create({.select = "native"}).expect(), std::move(cast), {.count = 3});
    }
    static Controller guard() { return load_controller(THRONG_SOURCE_DIR "/examples/controllers/guard.json").expect(); }
    static tools::Looks looks_for(const Character& character) {
        const std::string material = json_of("info one.glb")["section_materials"][0];
        return {write("looks.json", R"({"colors": {")" + material + R"(": ["#ff0000"]}})"), character};
    }
};

// One character plays another clip than the one chosen for all.
void choose_clips(view::Scene& scene) {
    scene.set_group_playback(0, {.own = false, .first = 1, .second = 2, .weight = 0.25f});
    Playback inspected = scene.playback_of(2);
    inspected.first.clip = 3;
    scene.set_playback_of(2, inspected);
}

void expect_chosen_clips(const view::Scene& scene) {
    EXPECT_EQ(scene.group_playback(0), (view::GroupPlayback{.own = false, .first = 1, .second = 2, .weight = 0.25f}));
    EXPECT_EQ(scene.playback_of(1).first.clip, 1u);
    EXPECT_EQ(scene.playback_of(2).first.clip, 3u);
}

TEST_F(ViewScene, ClipsStayTheSameWhenLooksChange) {
    view::Scene scene = scene_of(1);
    choose_clips(scene);
    scene.set_looks({looks_for(scene.cast().characters[0])});
    EXPECT_TRUE(scene.cast().looks[0]);
    expect_chosen_clips(scene);
    scene.set_looks({std::nullopt});
    EXPECT_TRUE(scene.cast().looks[0]) << "nothing has been given in its place";
}

TEST_F(ViewScene, ParametersStayWithTheirController) {
    view::Scene scene = scene_of(2);
    scene.set_controllers({guard(), guard()});
    const uint32_t speed = guard().find_parameter("speed");
    ASSERT_LT(speed, scene.parameters(0).size());
    scene.set_parameter(0, speed, 0.5f);
    scene.set_parameter(1, speed, 0.75f);
    scene.set_looks({std::nullopt, looks_for(scene.cast().characters[1])});
    EXPECT_EQ(scene.parameters(0)[speed], 0.5f);
    EXPECT_EQ(scene.parameters(1)[speed], 0.75f);
    scene.set_controllers({std::nullopt, guard()});
    EXPECT_EQ(scene.parameters(0)[speed], 0.5f);
    EXPECT_EQ(scene.parameters(1)[speed], 0) << "of a new controller";
}

TEST_F(ViewScene, IsUnchangedIfRebuildingFails) {
    view::Scene scene = scene_of(1);
    choose_clips(scene);
    view::SceneSettings wanted = scene.settings();
    wanted.count = 7;
    wanted.spacing = std::numeric_limits<float>::infinity();
    EXPECT_THROW(scene.set_settings(wanted), tools::CommandError);
    EXPECT_EQ(scene.crowd().instance_count(), 3u);
    expect_chosen_clips(scene);
}

}  // namespace
}  // namespace throng
