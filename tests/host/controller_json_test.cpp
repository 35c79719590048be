// Controllers as JSON: what is read, and that each refusal names a line and a reason.
#include "controller/controller_rules.h"
#include "json/json_text.h"
#include "tests/controller_cases.h"
#include "tests/files.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace throng {
namespace {

using namespace test;

std::string error_of(std::string_view json) {
    const Result<Controller> controller = parse_controller(json, "guard.json");
    return controller ? "" : controller.error().text();
}

TEST(ControllerJson, EveryFieldIsRead) {
    const Result<Controller> read = parse_controller(kCompleteController, "guard.json");
    ASSERT_TRUE(read) << read.error().text();
    const Controller& c = *read;
    EXPECT_EQ(c.name, "guard.json");

    ASSERT_EQ(c.parameters.size(), 5u);
    EXPECT_EQ(c.parameters[0].name, "speed");
    EXPECT_EQ(c.parameters[0].type, ParameterType::kFloat);
    EXPECT_EQ(c.parameters[0].initial, 0.25f);
    EXPECT_EQ(c.parameters[1].initial, -1e-3f);
    EXPECT_EQ(c.parameters[2].type, ParameterType::kBool);
    EXPECT_EQ(c.parameters[2].initial, 1);
    EXPECT_EQ(c.parameters[3].initial, 0);
    EXPECT_EQ(c.parameters[4].type, ParameterType::kTrigger);
    EXPECT_EQ(c.parameters[4].initial, 0);

    ASSERT_EQ(c.events.size(), 2u);
    EXPECT_EQ(c.events[0].name + c.events[0].clip, "stepwalk");
    EXPECT_EQ(c.events[0].time_s, 0.3);
    EXPECT_EQ(c.events[1].time_s, 0.1);
    EXPECT_EQ(c.find_events("step"), (std::vector<EventIndex>{0, 1}));
    EXPECT_TRUE(c.find_events("stride").empty());
    EXPECT_EQ(c.events_named("step").value(), c.find_events("step"));
    const auto missing = c.events_named("stride");
    ASSERT_FALSE(missing);
    EXPECT_TRUE(contains(missing.error().text(), "there is no event 'stride'")) << missing.error().text();

    ASSERT_EQ(c.masks.size(), 2u);
    ASSERT_EQ(c.masks[0].items.size(), 2u);
    EXPECT_EQ(c.masks[0].items[0].joint, "spine");
    EXPECT_EQ(c.masks[0].items[0].weight, 1);
    EXPECT_EQ(c.masks[0].items[0].ramp, 3u);
    EXPECT_EQ(c.masks[0].items[1].weight, 0.5f);
    EXPECT_EQ(c.masks[0].items[1].ramp, 0u);
    EXPECT_EQ(c.masks[1].name, "left arm");

    ASSERT_EQ(c.layers.size(), 3u);
    EXPECT_EQ(c.layers[1].mode, LayerMode::kAdditive);
    EXPECT_EQ(c.layers[1].mask, "upper");
    EXPECT_EQ(c.layers[1].weight, 2);
    EXPECT_EQ(c.layers[1].weight_parameter, "tired");
    EXPECT_TRUE(c.layers[1].states.empty());
    EXPECT_EQ(c.layers[2].mode, LayerMode::kOverride);
    EXPECT_EQ(c.layers[2].weight, 0.75f);
    EXPECT_EQ(c.layers[2].weight_parameter, "");
    EXPECT_EQ(c.find_layer("top"), 2u);
    EXPECT_EQ(c.find_mask("left arm"), 1u);
    EXPECT_EQ(c.find_parameter("tired"), 3u);
    EXPECT_EQ(c.find_parameter("Tired"), kNone);
}

TEST(ControllerJson, StatesAreReadInTheirOrder) {
    const Controller c = *parse_controller(kCompleteController, "guard.json");
    const std::vector<ControllerState>& states = c.layers[0].states;
    ASSERT_EQ(states.size(), 4u);
    EXPECT_EQ(states[0].name + states[1].name + states[2].name + states[3].name, "movezebraaimfall")
        << "the start comes first, the others as in the file";

    EXPECT_EQ(states[0].x_parameter, "speed");
    EXPECT_EQ(states[0].y_parameter, "");
    ASSERT_EQ(states[0].points.size(), 2u);
    EXPECT_EQ(states[0].points[0].clip, "walk");
    EXPECT_EQ(states[0].points[0].x, 1.5f);
    EXPECT_EQ(states[0].points[1].x, 4.f);
    EXPECT_EQ(states[0].speed, 0.5f);
    EXPECT_EQ(states[0].speed_parameter, "speed");
    EXPECT_EQ(states[0].sync, "legs");
    EXPECT_TRUE(states[0].loop);

    ASSERT_EQ(states[1].points.size(), 1u);
    EXPECT_EQ(states[1].points[0].clip, "idle");
    EXPECT_EQ(states[1].speed, 1);
    EXPECT_EQ(states[1].x_parameter + states[1].speed_parameter + states[1].sync, "");

    EXPECT_EQ(states[2].x_parameter, "side");
    EXPECT_EQ(states[2].y_parameter, "speed");
    EXPECT_EQ(states[2].speed_parameter, "side");
    EXPECT_EQ(states[2].points[0].x, -1);
    EXPECT_EQ(states[2].points[1].y, 1);
    EXPECT_FALSE(states[3].loop);
    EXPECT_EQ(states[3].speed, -2);
}

TEST(ControllerJson, TransitionsAreReadInTheirOrder) {
    const Controller c = *parse_controller(kCompleteController, "guard.json");
    const std::vector<ControllerTransition>& transitions = c.layers[0].transitions;
    ASSERT_EQ(transitions.size(), 5u);
    EXPECT_EQ(transitions[0].from, "zebra");
    EXPECT_EQ(transitions[0].to, "move");
    std::string conditions;
    for (const ControllerCondition& condition : transitions[0].conditions)
        conditions += condition.parameter + " " + std::to_string(static_cast<int>(condition.test)) + " " +
                      std::to_string(condition.value) + "; ";
    EXPECT_EQ(conditions, "speed 0 0.100000; speed 1 9.000000; alert 2 0.000000; tired 3 0.000000; ");
    EXPECT_EQ(transitions[0].exit, 0);
    EXPECT_EQ(transitions[0].fade_s, 0);
    EXPECT_EQ(transitions[0].fade, FadeKind::kCross);
    EXPECT_FALSE(transitions[0].interrupts);

    EXPECT_EQ(transitions[1].from, "");
    EXPECT_EQ(transitions[1].fade, FadeKind::kInertial);
    EXPECT_EQ(transitions[1].fade_s, 0.2f);
    EXPECT_TRUE(transitions[1].interrupts);
    ASSERT_EQ(transitions[1].conditions.size(), 1u);
    EXPECT_EQ(transitions[1].conditions[0].test, ControllerCondition::Test::kTriggered);
    EXPECT_EQ(transitions[2].from, "");
    EXPECT_EQ(transitions[2].exit, 2.5f);
    EXPECT_EQ(transitions[3].from, "fall");
    EXPECT_EQ(transitions[4].to, "zebra");
}

TEST(ControllerJson, TheSmallestControllerIsOneLayer) {
    const Result<Controller> least = parse_controller(R"({"layers": [{"name": "all"}]})", "least.json");
    ASSERT_TRUE(least) << least.error().text();
    EXPECT_EQ(least->layers[0].weight, 1);
    EXPECT_EQ(error_of("{\"layers\": []}"), "guard.json:1: layers: a controller needs at least one layer");
    EXPECT_EQ(error_of("{}"), "guard.json:1: 'layers' is missing");
    EXPECT_EQ(error_of("[]"), "guard.json:1: must be an object, but is an array");
    EXPECT_EQ(error_of("\n\n7\n"), "guard.json:3: must be an object, but is a number")
        << "a number is read up to the end of its line, no further";
    EXPECT_TRUE(error_of("").starts_with("guard.json:1: not JSON: ")) << error_of("");
}

TEST(ControllerJson, TheDocumentationsExampleIsValid) {
    const std::string page = read_file(THRONG_SOURCE_DIR "/docs/controller.md"), fence = "```json\n";
    const size_t begin = page.find(fence) + fence.size();
    std::string example = page.substr(begin, page.find("```", begin) - begin);
    EXPECT_EQ(error_of(example), "");
    const std::string to = "\"to\": \"move\"";
    const std::string error = error_of(example.replace(example.find(to), to.size(), "\"to\": \"mvoe\""));
    EXPECT_TRUE(!error.empty() && page.find(error) != page.npos) << "the page shows another message: " << error;
}

TEST(ControllerJson, ErrorsNameTheirLine) {
    EXPECT_GE(kBrokenControllers.size(), 50u);
    for (const BrokenController& how : kBrokenControllers) {
        const std::string text = broken(how), error = error_of(text);
        ASSERT_FALSE(text.empty()) << "'" << how.old << "' is not in the complete file";
        EXPECT_TRUE(error.starts_with("guard.json:" + std::to_string(how.line) + ": "))
            << how.old << " -> " << how.now << "\n"
            << error;
        EXPECT_NE(error.find(how.reason), std::string::npos) << how.old << " -> " << how.now << "\n" << error;
        EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
}

TEST(ControllerJson, EveryKindOfLineEndingIsCounted) {
    std::string windows;
    for (const char c : broken({"\"fade\": \"cross\"", "\"fade\": 1", 47, ""}))
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(error_of(windows), "guard.json:47: layers[0].transitions[2].fade: must be a string, but is a number");
    EXPECT_EQ(error_of("\xEF\xBB\xBF{\n\"layers\":\n7\n}"), "guard.json:2: layers: must be an array, but is a number")
        << "with a byte order mark; a member's line is its key's";
}

std::string repeated(size_t count, const std::string& item) {
    std::string all;
    for (size_t i = 0; i < count; ++i) {
        std::string next = item;
        for (size_t at; (at = next.find('#')) != next.npos;) next.replace(at, 1, std::to_string(i));
        all += (i ? "," : "") + next;
    }
    return all;
}

TEST(ControllerJson, EachLimitIsKeptAndNamed) {
    struct Limit {
        std::string before, item, after;
        size_t limit;
        std::string what;
    };
    const std::string one_layer = R"("layers": [{"name": "a"}]})",
                      open_layer = R"({"parameters": {"x": 0}, "layers": [{"name": "a", "states": {)";
    for (const auto& [before, item, after, limit, what] : std::vector<Limit>{
             {R"({"parameters": {)", R"("p#": 0)", "}, " + one_layer, kParameterLimit, "parameters: # parameters"},
             {R"({"masks": {)", R"("m#": [])", "}, " + one_layer, kMaskLimit, "masks: # masks"},
             {R"({"masks": {"m": [)", R"({"joint": "j"})", "]}, " + one_layer, kMaskItemLimit, "masks.m: # items"},
             {R"({"events": [)", R"({"name": "e", "clip": "c", "at_s": 0})", "], " + one_layer, kEventLimit,
              "events: # events"},
             {R"({"layers": [)", R"({"name": "l#"})", "]}", kLayerLimit, "layers: # layers"},
             {open_layer, R"("s#": {"clip": "c"})", "}}]}", kStateLimit, "layers[0].states: # states"},
             {open_layer + R"("s": {"blend": "x", "clips": [)", R"({"clip": "c", "at": #})", "]}}}]}", kBlendPointLimit,
              "layers[0].states.s.clips: # clips"},
             {open_layer + R"("s": {"clip": "c"}}, "transitions": [)", R"({"from": "s", "to": "s", "exit": 1})", "]}]}",
              kTransitionLimit, "layers[0].transitions: # transitions"},
         }) {
        EXPECT_EQ(error_of(before + repeated(limit, item) + after), "");
        const Result<Controller> over = parse_controller(before + repeated(limit + 1, item) + after, "guard.json");
        ASSERT_FALSE(over) << what;
        EXPECT_EQ(over.error().code, ErrorCode::kLimit);
        std::string expected = "guard.json:1: " + what + ", more than the limit of " + std::to_string(limit);
        EXPECT_EQ(over.error().text(), expected.replace(expected.find('#'), 1, std::to_string(limit + 1)));
    }
    EXPECT_EQ(error_of("{\"parameters\": [\n" + repeated(kJsonValueLimit, "0") + "]}"),
              "guard.json:2: the JSON has more than the limit of 500000 values");
    EXPECT_EQ(error_of(std::string(kJsonTextLimit_bytes + 1, ' ')), "guard.json: is larger than the limit of 4 MiB");
    EXPECT_NE(error_of(std::string(kJsonTextLimit_bytes, '[')).find("nested deeper"), std::string::npos);
}

// Any bytes give either a controller, or one line that begins with the file and a line number.
void expect_no_crash(const std::string& json) {
    const std::string error = error_of(json);
    if (error.empty()) return;
    EXPECT_TRUE(error.starts_with("guard.json:") && std::isdigit(static_cast<unsigned char>(error[11]))) << error;
    EXPECT_EQ(error.find_first_of("\r\n"), std::string::npos) << error;
    const uint32_t line = static_cast<uint32_t>(std::stoul(error.substr(11)));
    EXPECT_LE(line, 1 + std::count(json.begin(), json.end(), '\n'));
}

TEST(ControllerJson, ArbitraryBytesDoNotCrash) {
    for (size_t size = 0; size < kCompleteController.size(); ++size)
        expect_no_crash(kCompleteController.substr(0, size));
    std::mt19937 random(1);
    const auto below = [&](size_t count) { return random() % count; };
    const std::string alphabet = "{}[]\",:0123456789.-+eE \n\\u*";
    for (int i = 0; i < 2000; ++i) {
        std::string json = kCompleteController;
        for (size_t changes = 1 + below(4); changes > 0; --changes) {
            const size_t at = below(json.size());
            switch (below(4)) {
                case 0: json[at] = static_cast<char>(below(256)); break;
                case 1: json[at] = alphabet[below(alphabet.size())]; break;
                case 2: json.erase(at, 1 + below(20)); break;
                default: json.insert(at, json.substr(below(json.size()), below(40))); break;
            }
        }
        expect_no_crash(json);
    }
}

TEST(ControllerJson, AFileReadsLikeItsText) {
    const TemporaryFolder temporary;
    const std::filesystem::path path = temporary.write("controller.json", kCompleteController);
    const Result<Controller> read = load_controller(path);
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->name, path.filename());
    EXPECT_EQ(read->layers.size(), 3u);
    temporary.write("controller.json", std::string(kJsonTextLimit_bytes + 1, ' '));
    EXPECT_EQ(load_controller(path).error().code, ErrorCode::kLimit);
    std::filesystem::remove(path);
    const Result<Controller> missing = load_controller(path), folder = load_controller(temporary.path());
    EXPECT_EQ(missing.error().code, ErrorCode::kFile);
    EXPECT_EQ(missing.error().text(), path.filename().string() + ": no such file: " + path.string());
    EXPECT_EQ(folder.error().code, ErrorCode::kFile);
}

}  // namespace
}  // namespace throng
