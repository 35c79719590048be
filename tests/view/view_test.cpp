// throng view under Xvfb: driven by scripted input, and once by real keyboard and mouse events. Checks screenshots.
#include "tests/display.h"
#include "tests/png.h"
#include "tests/tool_runner.h"
#include "tools/view/history.h"
#include "tools/view/orbit.h"
#include "tools/view/pick.h"
#include "tools/view/same_device.h"
#include "tools/view/window.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <thread>

namespace throng {
namespace {

using namespace test;
namespace fs = std::filesystem;

struct Rectangle {
    int left, top, right, bottom;
};

Rectangle all_of(const Png& picture) { return {0, 0, picture.width, picture.height}; }

int distance(const uint8_t* a, const uint8_t* b) {
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

// The fraction of the rectangle's pixels, 0..1, for which `is` returns true.
template <class Is>
double part(const Rectangle& of, const Is& is) {
    int count = 0;
    for (int y = of.top; y < of.bottom; ++y)
        for (int x = of.left; x < of.right; ++x) count += is(x, y);
    return double(count) / ((of.right - of.left) * (of.bottom - of.top));
}

double changed(const Png& a, const Png& b, const Rectangle& of) {
    return part(of, [&](int x, int y) { return distance(a.at(x, y), b.at(x, y)) > 24; });
}

class View : public ToolTest {
protected:
    static void SetUpTestSuite() {
        ToolTest::SetUpTestSuite();
        display_ = std::make_unique<Display>(kScreen);
        for (const auto& [name, seed] : {std::pair{"one.glb", "1"}, {"other.glb", "5"}})
            generate(name, {"--joints", "40", "--levels", "12", "--faces", "600", "--seed", seed});
    }
    static void TearDownTestSuite() {
        display_.reset();
        ToolTest::TearDownTestSuite();
    }

    static constexpr const char* kScreen = "800x600x24";

    static std::map<std::string, std::string> environment() {
        return {{"DISPLAY", display_->name()},
                {"VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation"},
                {"VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT"}};
    }

    // Runs the events under the validation layer, which must report nothing. The final state is dumped to state_.
    static Outcome view(const std::string& events, std::vector<std::string> arguments = {}) {
        if (std::ranges::find(arguments, "--count") == arguments.end())
            arguments.insert(arguments.end(), {"--count", "12"});
        arguments.insert(arguments.begin(), {"view", file("one.glb"), "--size", "640x400", "--script",
                                             write("events.txt", events), "--dump", file("dump.json")});
        const Outcome run = run_tool(arguments, {.environment = environment(), .time_limit_s = 120});
        EXPECT_EQ(run.exit_code, 0) << run;
        for (const char* word : {"VUID", "Validation", "SYNC-HAZARD", "UNASSIGNED"})
            EXPECT_EQ((run.out + run.err).find(word), std::string::npos) << run;
        state_ = Json::parse(read_file(file("dump.json")), nullptr, false);
        EXPECT_FALSE(state_.is_discarded());
        return run;
    }

    static Png seen(const std::string& name) { return read_png(file(name)); }

    static inline std::unique_ptr<Display> display_;
    static inline Json state_;
};

// A part of the window without panels. It shows the crowd, not only the ground.
constexpr Rectangle kMiddle{200, 120, 440, 300};
// The part of a window that its panels leave free.
constexpr Rectangle kBesidePanels{304, 40, 636, 236};
// The ground changes little along a row; characters do.
double part_with_detail(const Png& picture, const Rectangle& of) {
    return part(of, [&](int x, int y) { return distance(picture.at(x, y), picture.at(x + 3, y)) > 40; });
}
// Hides the panels and pauses.
constexpr const char* kStill = "0 hold tab\n0 hold space\n1 let tab\n1 let space\n";

TEST(ViewGraph, HasAColourForEachStage) { EXPECT_EQ(view::stage_color_count(), stage_names().size()); }

TEST_F(View, ShowsTheCrowdAndFollowsTheMouse) {
    const Outcome run = view(std::string(kStill) + "4 shot " + file("first.png") +
                             "\n5 move 320 200\n6 press left\n7 move 420 200\n8 release left\n9 shot " +
                             file("turned.png") + "\n10 press left\n11 move 320 200\n12 release left\n13 shot " +
                             file("back.png") + "\n14 scroll 5\n15 shot " + file("closer.png") +
                             "\n16 press right\n17 move 380 240\n18 release right\n19 shot " + file("panned.png") +
                             "\n");
    EXPECT_TRUE(run.err.empty()) << run;
    const Png first = seen("first.png"), turned = seen("turned.png"), back = seen("back.png"),
              closer = seen("closer.png"), panned = seen("panned.png");
    ASSERT_EQ(first.width, 640);
    ASSERT_EQ(first.height, 400);
    EXPECT_GT(part_with_detail(first, kMiddle), 0.02);
    EXPECT_GT(changed(first, turned, kMiddle), 0.1);
    EXPECT_LT(changed(first, back, all_of(first)), 0.005) << "paused, and turned back";
    EXPECT_GT(changed(back, closer, kMiddle), 0.1);
    EXPECT_GT(changed(closer, panned, kMiddle), 0.1);
}

TEST_F(View, AnimatesUnlessItIsPaused) {
    view("0 hold tab\n1 let tab\n3 shot " + file("early.png") + "\n20 shot " + file("late.png") +
         "\n21 hold space\n22 let space\n23 shot " + file("paused.png") + "\n30 shot " + file("still.png") +
         "\n31 type .\n32 shot " + file("stepped.png") + "\n");
    EXPECT_GT(changed(seen("early.png"), seen("late.png"), kMiddle), 0.01);
    EXPECT_EQ(seen("paused.png").rgba, seen("still.png").rgba);
    EXPECT_NE(seen("still.png").rgba, seen("stepped.png").rgba);
}

TEST_F(View, ListsItsKeys) {
    view(std::string(kStill) + "4 shot " + file("without.png") + "\n5 type ?\n8 shot " + file("with.png") +
         "\n9 hold escape\n10 let escape\n12 shot " + file("again.png") + "\n");
    const Png without = seen("without.png"), with = seen("with.png"), again = seen("again.png");
    const auto is_panel = [](const Png& in) {
        return part(kMiddle, [&](int x, int y) { return *std::max_element(in.at(x, y), in.at(x, y) + 3) < 70; });
    };
    EXPECT_LT(is_panel(without), 0.3);
    EXPECT_GT(is_panel(with), 0.6);
    EXPECT_GT(part(kMiddle, [&](int x, int y) { return *std::min_element(with.at(x, y), with.at(x, y) + 3) > 150; }),
              0.003)
        << "its writing";
    EXPECT_EQ(without.rgba, again.rgba);
    EXPECT_FALSE(state_["shows_keys"]);
}

TEST_F(View, AClickSelectsAnInstance) {
    static constexpr Rectangle kInspector{360, 24, 610, 60};
    view("0 hold space\n1 let space\n3 shot " + file("none.png") +
             "\n4 move 475 120\n5 press left\n6 release left\n9 shot " + file("one.png") + "\n",
         {"--count", "1"});
    EXPECT_EQ(state_["selected"], 0);
    const auto dark = [](const Png& in) {
        return part(kInspector, [&](int x, int y) { return *std::max_element(in.at(x, y), in.at(x, y) + 3) < 70; });
    };
    EXPECT_LT(dark(seen("none.png")), 0.2);
    EXPECT_GT(dark(seen("one.png")), 0.6);
    // There is no character beside the first one.
    view("4 move 475 120\n5 press left\n6 release left\n8 move 630 20\n", {"--count", "1"});
    EXPECT_EQ(state_["selected"], 0);
    view("4 move 634 200\n5 press left\n6 release left\n8 move 630 20\n", {"--count", "1"});
    EXPECT_TRUE(state_["selected"].is_null());
}

TEST_F(View, DrawsSkeletonsInTheColoursOfTheirLevels) {
    view(std::string(kStill) + "4 shot " + file("flesh.png") + "\n5 type k\n9 shot " + file("bones.png") + "\n",
         {"--count", "4"});
    EXPECT_TRUE(state_["skeletons"]);
    const Png flesh = seen("flesh.png"), bones = seen("bones.png");
    // Among the pixels that the lines change: joints near the roots are orange and yellow, those at the tips blue.
    const auto changed_to = [&](const auto& is_color) {
        return part(all_of(bones), [&](int x, int y) {
            const uint8_t *now = bones.at(x, y), *before = flesh.at(x, y);
            const int difference = std::abs(now[0] - before[0]) + std::abs(now[1] - before[1]) +
                                   std::abs(now[2] - before[2]);
            return difference > 90 && is_color(int{now[0]}, int{now[1]}, int{now[2]});
        });
    };
    EXPECT_GT(changed_to([](int r, int g, int b) { return r > b + 80 && g > b + 50; }), 1e-3) << "yellow";
    EXPECT_GT(changed_to([](int r, int, int b) { return b > r + 60; }), 1e-4) << "blue";
}

TEST_F(View, ADroppedControllerIsUsed) {
    const Outcome run = view(
        "2 drop " THRONG_SOURCE_DIR
        "/examples/controllers/guard.json\n5 move 475 120\n6 press left\n7 release left\n12 move 630 20\n",
        {"--count", "1"});
    EXPECT_TRUE(run.err.empty()) << run;
    EXPECT_EQ(state_["selected"], 0);
    EXPECT_EQ(state_["controller"]["parameters"].size(), 2) << "speed and attack, as the device has them";
    EXPECT_EQ(state_["controller"]["leading"], nlohmann::json::array({0})) << "idle";
    const Outcome wrong = view("2 drop " THRONG_SOURCE_DIR "/examples/controllers/willow.json\n6 move 630 20\n",
                               {"--count", "1"});
    EXPECT_NE(wrong.err.find("gust"), std::string::npos) << "a clip that it has not: " << wrong;
}

constexpr const char* kGuard = THRONG_SOURCE_DIR "/examples/controllers/guard.json";
constexpr const char* kClickOnTheOne = "5 move 475 120\n6 press left\n7 release left\n12 move 630 20\n";

TEST_F(View, AnInvalidControllerDoesNotBlockAnother) {
    const std::string wrong = write("wrong.json", "{");
    const Outcome run = view("2 drop " + wrong + " " + kGuard + "\n" + kClickOnTheOne, {"--count", "1"});
    EXPECT_NE(run.err.find("wrong.json"), std::string::npos) << run;
    EXPECT_EQ(state_["controller"]["leading"], nlohmann::json::array({0})) << state_;
}

TEST_F(View, AControllerForUnreadableCharactersIsNotUsed) {
    const std::string broken = write("broken.glb", "glTF, it says");
    const Outcome run = view("2 drop " + broken + " " + kGuard + "\n" + kClickOnTheOne, {"--count", "1"});
    EXPECT_NE(run.err.find("broken.glb"), std::string::npos) << run;
    EXPECT_EQ(state_["selected"], 0);
    EXPECT_TRUE(state_["controller"].is_null()) << state_;
}

TEST_F(View, DroppedLooksAreApplied) {
    const std::string material = json_of("info " + file("one.glb"))["section_materials"][0];
    const std::string looks = write("looks.json", R"({"colors": {")" + material + R"(": ["#ff0000"]}})");
    const Outcome run = view(std::string(kStill) + "4 shot " + file("plain.png") + "\n5 drop " + looks + "\n10 shot " +
                                 file("red.png") + "\n",
                             {"--count", "4"});
    EXPECT_TRUE(run.err.empty()) << run;
    const auto red = [](const Png& in) {
        return part(kMiddle,
                    [&](int x, int y) { return in.at(x, y)[0] > 2 * std::max(in.at(x, y)[1], in.at(x, y)[2]); });
    };
    EXPECT_LT(red(seen("plain.png")), 0.01);
    EXPECT_GT(red(seen("red.png")), 0.05);
}

TEST_F(View, ChangesTheInstanceCount) {
    view("2 move 188 76\n3 press left\n6 release left\n10 shot " + file("many.png") + "\n", {"--count", "2"});
    EXPECT_GT(state_["count"], 200) << "the middle of the slider, which is logarithmic";
    EXPECT_LT(state_["count"], 500);
    view("2 type +\n4 type +\n6 type +\n8 type -\n", {"--count", "3"});
    EXPECT_EQ(state_["count"], 10) << "5, 10, 20, 10";
    view("2 type +++-\n8 move 630 20\n", {"--count", "3"});
    EXPECT_EQ(state_["count"], 10) << "the same in one frame";
}

TEST_F(View, ResetShowsTheWholeCrowdForAnyCameraPath) {
    const std::string whole = "4 type r\n8 move 630 20\n";
    view(whole);
    const Json eye = state_["eye"];
    view(whole, {"--camera", "low"});
    EXPECT_EQ(state_["eye"], eye);
}

TEST_F(View, TheSelectionSurvivesCountChanges) {
    const std::string click = "0 hold space\n1 let space\n4 move 540 120\n5 press left\n6 release left\n";
    view(click + "20 move 630 20\n", {file("other.glb"), "--count", "2"});
    ASSERT_EQ(state_["selected"], 1) << "the first of the second file";
    view(click + "10 type +\n20 move 630 20\n", {file("other.glb"), "--count", "2"});
    EXPECT_EQ(state_["count"], 5) << "two of the first file, three of the second";
    EXPECT_EQ(state_["selected"], 2);
    view(click + "10 type -\n20 move 630 20\n", {file("other.glb"), "--count", "2"});
    EXPECT_EQ(state_["count"], 1);
    EXPECT_TRUE(state_["selected"].is_null() || state_["selected"] == 0) << state_;
}

TEST_F(View, TheSeedIsAppliedWhenItsFieldLosesFocus) {
    view(
        "2 move 188 100\n3 press left\n4 release left\n6 hold ctrl\n6 hold a\n7 let a\n7 let ctrl\n8 type 81\n"
        "12 move 600 200\n14 press left\n15 release left\n20 move 630 20\n");
    EXPECT_EQ(state_["seed"], 81);
}

TEST_F(View, MovingBeforeAPressIsNotADrag) {
    view("0 hold space\n1 let space\n4 move 475 120\n12 move 475 120\n");
    const Json eye = state_["eye"];
    view("0 hold space\n1 let space\n4 move 475 120\n8 move 600 60\n8 press left\n9 release left\n12 move 600 60\n");
    EXPECT_EQ(state_["eye"], eye);
}

TEST_F(View, EscapeClosesAList) {
    const std::string select = "0 hold space\n1 let space\n4 move 475 120\n5 press left\n6 release left\n",
                      open = "8 move 188 124\n9 press left\n10 release left\n",
                      escape = "14 hold escape\n15 let escape\n", last = "20 shot " + file("list.png") + "\n";
    view(select + last, {"--count", "1"});
    const Png before = seen("list.png");
    constexpr Rectangle kList{100, 140, 280, 220};
    view(select + open + last, {"--count", "1"});
    EXPECT_GT(changed(before, seen("list.png"), kList), 0.1) << "it is open";
    view(select + open + escape + last, {"--count", "1"});
    EXPECT_LT(changed(before, seen("list.png"), kList), 0.02);
    EXPECT_EQ(state_["selected"], 0) << "one thing at a time";
}

TEST_F(View, CullsHiddenAndUpdatesSmallInstancesLessOften) {
    const Outcome run = view(std::string(kStill) + "4 shot " + file("all.png") + "\n5 type u\n6 type o\n14 shot " +
                                 file("skipped.png") + "\n20 move 630 20\n",
                             {"--count", "60"});
    EXPECT_TRUE(run.err.empty()) << run;
    EXPECT_EQ(state_["skips_updates"], true);
    EXPECT_EQ(state_["occlusion"], true);
    const Png skipped = seen("skipped.png");
    EXPECT_GT(part_with_detail(skipped, kMiddle), 0.02);
    EXPECT_LT(changed(seen("all.png"), skipped, all_of(skipped)), 0.005) << "nobody sees what is left out";
    EXPECT_GT(state_["drawn"].get<std::vector<uint32_t>>().back(), 0u);
}

TEST_F(View, CountsWhatIsDrawn) {
    const auto drawn = [](const std::string& last) {
        view("0 hold space\n1 let space\n2 scroll 20\n16 " + last + "\n18 move 630 20\n", {"--count", "40"});
        return state_["drawn"].get<std::vector<uint32_t>>();
    };
    EXPECT_LT(drawn("move 0 0")[0], 40u) << "too near to see all";
    EXPECT_EQ(drawn("type l"), std::vector{40u}) << "without culling";
}

TEST_F(View, PicturesDoNotOverwriteDroppedFiles) {
    const std::string dropped = file("dropped.glb");
    fs::copy_file(file("other.glb"), dropped);
    const Outcome run = run_tool({"view", file("one.glb"), "--size", "640x400", "--script",
                                  write("events.txt", "2 drop " + dropped + "\n5 shot " + dropped + "\n")},
                                 {.environment = {{"DISPLAY", display_->name()}}, .time_limit_s = 120});
    EXPECT_TRUE(run.refused("dropped.glb: would overwrite ")) << run;
    EXPECT_EQ(read_file(dropped), read_file(file("other.glb")));
}

TEST_F(View, DropsReplaceTheScene) {
    write("broken.glb", "glTF, it says");
    const Outcome run = view(std::string(kStill) + "4 shot " + file("one.png") + "\n5 drop " + file("broken.glb") +
                                 "\n8 shot " + file("still_one.png") + "\n9 drop " + file("other.glb") + " " +
                                 file("one.glb") + "\n20 drop " + file("nobody.glb") + "\n24 shot " + file("both.png") +
                                 "\n",
                             {"--count", "4"});
    EXPECT_NE(run.err.find("broken.glb"), std::string::npos) << run;
    EXPECT_NE(run.err.find("nobody.glb"), std::string::npos) << run;
    EXPECT_EQ(state_["files"], (Json{"other.glb", "one.glb"}));
    EXPECT_NE(state_["message"].get<std::string>().find("nobody.glb"), std::string::npos) << "said in the window";
    EXPECT_EQ(state_["count"], 4);
    const Png one = seen("one.png"), still_one = seen("still_one.png"), both = seen("both.png");
    EXPECT_LT(changed(one, still_one, kMiddle), 0.01);
    EXPECT_GT(changed(one, both, kMiddle), 0.05);
}

TEST_F(View, FollowsTheSizeOfTheWindow) {
    view(std::string(kStill) + "3 resize 500 320\n12 shot " + file("small.png") + "\n13 resize 720 450\n22 shot " +
         file("large.png") + "\n");
    const Png small = seen("small.png"), large = seen("large.png");
    EXPECT_EQ(std::pair(small.width, small.height), std::pair(500, 320));
    EXPECT_EQ(std::pair(large.width, large.height), std::pair(720, 450));
    EXPECT_EQ(state_["size"], (Json{720, 450}));
    EXPECT_GT(
        part({300, 180, 420, 300}, [&](int x, int y) { return distance(large.at(x, y), large.at(x + 3, y)) > 40; }),
        0.02);
}

// Keyboard and mouse events of the display, through the X server and GLFW. The delays only ensure that no two events
// fall into one frame.
TEST_F(View, TakesRealInput) {
    const std::string shot = file("real.png");
    const auto run_command = [](const std::string& words) {
        return std::system(("DISPLAY=" + display_->name() + " xdotool " + words + " > /dev/null").c_str());
    };
    const auto take_shot = [&] {
        fs::remove(shot);
        run_command("key F12");
        for (int tries = 0; tries < 600 && !fs::exists(shot); ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        return seen("real.png");
    };
    Outcome run;
    std::thread viewer([&] {
        run = run_tool({"view", file("one.glb"), "--size", "640x400", "--screenshot", shot},
                       {.environment = {{"DISPLAY", display_->name()}}, .time_limit_s = 120});
    });
    EXPECT_EQ(run_command("search --sync --onlyvisible --name '^throng$'"), 0);
    run_command("mousemove 320 200 sleep 0.3 key Tab sleep 0.3 key space sleep 0.3");
    take_shot();  // the message disappears
    const Png before = take_shot();
    run_command("mousedown 1 sleep 0.3 mousemove 420 200 sleep 0.3 mouseup 1 sleep 0.3");
    const Png after = take_shot();
    run_command("key ctrl+q");
    viewer.join();
    EXPECT_TRUE(run.succeeded()) << run;
    EXPECT_GT(changed(before, after, kMiddle), 0.1);
}

TEST_F(View, EndsAfterItsFramesWithAPicture) {
    // Drawn by the device, or by the processor if that is the device; also with recorded updates
    std::optional<Png> first;
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, {"--renderer", "vulkan"}, {"--path", "device"}}) {
        std::vector<std::string> words{"view", file("one.glb"), "--size", "640x400",      "--count",
                                       "12",   "--after",       "3",      "--screenshot", file("end.png")};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome run = run_tool(words, {.environment = environment(), .time_limit_s = 120});
        EXPECT_TRUE(run.succeeded()) << run;
        const Png picture = seen("end.png");
        ASSERT_EQ(picture.width, 640);
        ASSERT_EQ(picture.height, 400);
        EXPECT_GT(part_with_detail(picture, kBesidePanels), 0.02) << testing::PrintToString(more);
        if (!first) first = picture;
        EXPECT_LT(changed(*first, picture, kBesidePanels), 0.02) << testing::PrintToString(more);
    }
}

TEST_F(View, RefusesInvalidInputInOneLine) {
    const auto refused = [](std::vector<std::string> arguments, const std::string& named, const std::string& display) {
        arguments.insert(arguments.begin(), "view");
        const Outcome run = run_tool(arguments, {.environment = {{"DISPLAY", display}}, .time_limit_s = 120});
        EXPECT_TRUE(run.refused(named)) << testing::PrintToString(arguments) << "\n" << run;
    };
    refused({file("one.glb")}, "DISPLAY", "");
    refused({file("one.glb")}, "DISPLAY", ":12345");
    refused({file("nobody.glb")}, "nobody.glb", display_->name());
    refused({file("one.glb"), "--size", "1x1"}, "--size", display_->name());
    refused({file("one.glb"), "--count", "200000"}, "100000", display_->name());
    refused({file("one.glb"), "--device", "nobody's"}, "nobody's", display_->name());
    refused({file("one.glb"), "--device", "native"}, "cannot show pictures", display_->name());
    refused({file("one.glb"), "--screenshot", file("picture.jpg")}, "picture.jpg: pictures are .png files",
            display_->name());
    refused({file("one.glb"), "--count", "3", "--camera", "follow:character=3"}, "there are 3 characters",
            display_->name());
    refused({file("one.glb"), "--eye", "0,2,0", "--target", "0,2,0"}, "must be different points", display_->name());
    refused({file("one.glb"), "--script", write("wrong.txt", "1 move 2\n")}, "wrong.txt:1", display_->name());
    const RunSettings in_window{.environment = {{"DISPLAY", display_->name()}}, .time_limit_s = 120};
    EXPECT_EQ(run_tool({"view", file("one.glb"), "--count", "200000"}, in_window).exit_code, 2) << "a wrong option";
}

// How many times this key counts as pressed, for one frame with these actions.
std::ptrdiff_t pressed(view::KeyPresses& presses, int key, unsigned character, std::initializer_list<int> actions) {
    for (const int action : actions) {
        presses.add_key(key, action, 0);
        if (action != GLFW_RELEASE) presses.add_character(character);
    }
    return std::ranges::count(presses.take(), character, &view::KeyPress::character);
}

TEST(ViewKeyPresses, AHeldKeyCountsOnce) {
    view::KeyPresses presses;
    const auto press_k = [&](std::initializer_list<int> actions) { return pressed(presses, GLFW_KEY_K, 'k', actions); };
    EXPECT_EQ(press_k({GLFW_PRESS, GLFW_REPEAT, GLFW_REPEAT}), 1);
    EXPECT_EQ(press_k({GLFW_REPEAT, GLFW_RELEASE, GLFW_PRESS, GLFW_RELEASE, GLFW_PRESS}), 2);
    EXPECT_TRUE(presses.all().empty());
}

TEST(ViewKeyPresses, AHeldKeyThatStepsCountsInEachFrame) {
    for (const unsigned character : {'.', '+', '-'}) {
        view::KeyPresses presses;
        const auto press = [&](std::initializer_list<int> actions) {
            return pressed(presses, GLFW_KEY_PERIOD, character, actions);
        };
        EXPECT_EQ(press({GLFW_PRESS, GLFW_REPEAT}), 1);
        EXPECT_EQ(press({GLFW_REPEAT, GLFW_REPEAT}), 1) << "a slow frame does not make up for steps";
        EXPECT_EQ(press({GLFW_RELEASE}), 0);
        EXPECT_EQ(press({GLFW_PRESS, GLFW_RELEASE, GLFW_PRESS}), 2);
    }
}

TEST(ViewDevice, IsFoundAmongSeveralWithOneName) {
    const std::vector<std::string> names{"slow", "fast", "fast", "native"}, others{"fast", "slow", "fast"};
    EXPECT_EQ(view::same_device(names, 0, others), 1u);
    EXPECT_EQ(view::same_device(names, 1, others), 0u);
    EXPECT_EQ(view::same_device(names, 2, others), 2u);
    EXPECT_EQ(view::same_device(names, 3, others), std::nullopt);
}

TEST(ViewOrbit, FollowsTheMouse) {
    using view::Orbit;
    Orbit orbit;
    orbit.reset({.eye = {0, 3, 10}, .target = {0, 1, 0}});
    const auto near = [](const Vec3<float>& a, const Vec3<float>& b) { return length(a - b) < 1e-4f; };
    EXPECT_TRUE(near(orbit.camera().eye, {0, 3, 10}));
    orbit.turn(3.14159265f, 0);
    EXPECT_TRUE(near(orbit.camera().eye, {0, 3, -10})) << "half round";
    orbit.turn(0, 100);
    EXPECT_LT(orbit.camera().eye.y, 1 + length(Vec3<float>{0, 2, 10})) << "never straight above";
    orbit.reset({.eye = {0, 1, 10}, .target = {0, 1, 0}});
    orbit.zoom(0.5f);
    EXPECT_TRUE(near(orbit.camera().eye, {0, 1, 5}));
    orbit.look(0.5f, 0);
    EXPECT_TRUE(near(orbit.camera().eye, {0, 1, 5})) << "only the head turns";
    EXPECT_LT(orbit.camera().target.x, -1) << "to the left";
    orbit.reset({.eye = {0, 1, 10}, .target = {0, 1, 0}});
    orbit.fly(0, 0, 0.5f);
    EXPECT_TRUE(near(orbit.camera().eye, {0, 1, 5}));
    EXPECT_TRUE(near(orbit.camera().target, {0, 1, -5}));
    orbit.reset({.eye = {0, 1, 10}, .target = {0, 1, 0}, .vertical_field_of_view_rad = 2 * std::atan(0.5f)});
    orbit.pan(0.5f, 0.25f);
    EXPECT_TRUE(near(orbit.camera().target, {5, 3.5f, 0})) << "half and a quarter of the picture's height there, 10";
}

TEST(ViewOrbit, StaysAboveTheGround) {
    view::Orbit orbit;
    orbit.reset({.eye = {0, 3, 10}, .target = {0, 1, 0}});
    orbit.stand_on(0.5f);
    for (int step = 0; step < 100; ++step) {
        orbit.turn(0.1f, -0.1f);
        orbit.zoom(1.1f);
        EXPECT_GT(orbit.camera().eye.y, 0.5f) << step;
    }
    orbit.reset({.eye = {0, -3, 10}, .target = {0, 1, 0}});
    orbit.turn(0.1f, 0.01f);
    EXPECT_LT(orbit.camera().eye.y, 0.5f) << "who is under it already is not thrown up";
}

TEST(ViewOrbit, ACameraShowsItsTargetInAPartOfAPicture) {
    const Camera camera{.eye = {3, 6, 10}, .target = {1, 1, -2}, .vertical_field_of_view_rad = 0.6f};
    const float aspect_ratio = 1.6f;
    for (const view::PicturePart& part :
         {view::PicturePart(), {.left = 0.4f, .bottom = 0.6f}, {.top = 0.3f, .right = 0.7f}}) {
        const Camera whole = view::camera_around(camera, part, aspect_ratio);
        EXPECT_LT(length(whole.eye - camera.eye), 1e-6f);
        const Vec3<float> seen = view::Projection(whole, aspect_ratio).project(camera.target);
        EXPECT_NEAR(seen.x, (part.left + part.right) / 2, 1e-5);
        EXPECT_NEAR(seen.y, (part.top + part.bottom) / 2, 1e-5);
        EXPECT_NEAR(std::tan(whole.vertical_field_of_view_rad / 2) * part.height(), std::tan(0.3f), 1e-5);
    }
}

TEST(ViewOrbit, FitsTheWholeCrowdBesideThePanels) {
    for (const Vec3<float>& extent : {Vec3<float>{1, 2, 1}, Vec3<float>{20, 2, 20}, Vec3<float>{30, 2, 5}})
        for (const float aspect_ratio : {4 / 3.0f, 16 / 9.0f, 2.5f})
            for (const view::PicturePart& part :
                 {view::PicturePart(), {.left = 0.31f, .bottom = 0.6f}, {.left = 0.5f, .bottom = 0.7f}}) {
                const Bounds bounds{{}, extent};
                view::Orbit orbit;
                orbit.fit(bounds, part, aspect_ratio);
                const view::Projection picture(view::camera_around(orbit.camera(), part, aspect_ratio), aspect_ratio);
                for (size_t i = 0; i < 8; ++i) {
                    const Vec3<float> corner{i & 1 ? extent.x : 0, i & 2 ? extent.y : 0, i & 4 ? extent.z : 0};
                    const Vec3<float> at = picture.project(corner);
                    EXPECT_GE(at.x, part.left);
                    EXPECT_LE(at.x, part.right);
                    EXPECT_GE(at.y, part.top);
                    EXPECT_LE(at.y, part.bottom);
                }
            }
}

TEST(ViewProjection, RaysInvertTheProjection) {
    const Camera camera{.eye = {3, 4, 9}, .target = {0, 1, -2}};
    const view::Projection projection(camera, 1.6f);
    const Vec3<float> middle = projection.project(camera.target);
    EXPECT_NEAR(middle.x, 0.5f, 1e-5f);
    EXPECT_NEAR(middle.y, 0.5f, 1e-5f);
    const auto ray = projection.ray(0.2f, 0.9f);
    const Vec3<float> point = projection.project(ray.origin + ray.direction * 7.0f);
    EXPECT_NEAR(point.x, 0.2f, 1e-5f);
    EXPECT_NEAR(point.y, 0.9f, 1e-5f);
    EXPECT_NEAR(point.z, 7, 1e-4f);
    EXPECT_LT(projection.project(camera.eye * 2.0f).z, 0) << "behind";
}

TEST(ViewPick, HitsPlacedBoxes) {
    // Turned by a quarter about y, twice as large, and moved: x from -4 to 0, z from -6 to 2.
    const view::PlacedBox box{
        {-2, 0, -1},
        {2, 1, 1},
        to_affine(Trs<float>{axis_angle(Vec3<float>{0, 1, 0}, 1.57079633f), {-2, 0, -2}, {2, 2, 2}})};
    const auto along_z = [&](float x, float y, float from) {
        return view::distance_to(box, {{x, y, from}, {0, 0, -1}});
    };
    EXPECT_NEAR(along_z(-2, 1, 10).value_or(-1), 8, 1e-4f);
    EXPECT_NEAR(along_z(-2, 1, 0).value_or(-1), 0, 1e-4f) << "from within";
    EXPECT_FALSE(along_z(0.5f, 1, 10));
    EXPECT_FALSE(along_z(-2, 2.5f, 10));
    EXPECT_FALSE(along_z(-2, 1, -7)) << "it lies behind";
    EXPECT_FALSE(
        view::distance_to({box.min, box.max, to_affine(Trs<float>{.scale = {1, 0, 1}})}, {{0, 5, 0}, {0, -1, 0}}))
        << "flat";
}

}  // namespace
}  // namespace throng
