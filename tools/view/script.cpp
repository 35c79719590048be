#include "tools/view/script.h"

#include "tools/cli/command.h"

#include <imgui.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

namespace throng::view {
namespace {

const std::map<std::string, size_t> kButtons{{"left", 0}, {"right", 1}, {"middle", 2}};

// How many arguments an event takes, and whether they are numbers.
struct Form {
    size_t least = 1, most = 1;
    bool numbers = false;
};
const std::map<std::string, Form> kForms{
    {"move", {2, 2, true}}, {"press", {}}, {"release", {}},     {"scroll", {1, 1, true}}, {"type", {}},
    {"hold", {}},           {"let", {}},   {"drop", {1, 1000}}, {"resize", {2, 2, true}}, {"shot", {}}};

// Of GLFW; 0: there is no such key.
int key_of(const std::string& name) {
    static const std::map<std::string, int> keys{{"tab", GLFW_KEY_TAB},          {"space", GLFW_KEY_SPACE},
                                                 {"escape", GLFW_KEY_ESCAPE},    {"f12", GLFW_KEY_F12},
                                                 {"shift", GLFW_KEY_LEFT_SHIFT}, {"ctrl", GLFW_KEY_LEFT_CONTROL}};
    if (name.size() == 1 && name[0] >= 'a' && name[0] <= 'z') return GLFW_KEY_A + (name[0] - 'a');
    const auto found = keys.find(name);
    return found == keys.end() ? 0 : found->second;
}

bool is_number(const std::string& text) {
    char* end = nullptr;
    const float number = std::strtof(text.c_str(), &end);
    return !text.empty() && *end == '\0' && number > -1e5f && number < 1e5f;
}

bool is_known(const std::string& word, const std::vector<std::string>& arguments) {
    const auto form = kForms.find(word);
    if (form == kForms.end() || arguments.size() < form->second.least || arguments.size() > form->second.most)
        return false;
    if (form->second.numbers && !std::ranges::all_of(arguments, is_number)) return false;
    if (word == "press" || word == "release") return kButtons.contains(arguments[0]);
    return (word != "hold" && word != "let") || key_of(arguments[0]) != 0;
}

}  // namespace

Script::Script(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw tools::CommandError(path + ": cannot be read");
    std::string line;
    for (size_t number = 1; std::getline(file, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string frame_text;
        if (!(words >> frame_text)) continue;
        Event event;
        words >> event.word;
        for (std::string word; words >> word;) event.arguments.push_back(word);
        const auto frame = tools::parse_number(frame_text);
        if (!frame || !is_known(event.word, event.arguments) || (!events_.empty() && *frame < events_.back().frame))
            throw tools::CommandError(path + ":" + std::to_string(number) + ": '" + line +
                                      "' is not an event, or its frame is before the last event's");
        event.frame = *frame;
        events_.push_back(std::move(event));
    }
}

std::optional<std::string> Script::play(uint64_t frame, Window& window) {
    ImGuiIO& io = ImGui::GetIO();
    std::optional<std::string> shot;
    for (; next_ < events_.size() && events_[next_].frame <= frame; ++next_) {
        const auto& [at, word, arguments] = events_[next_];
        const auto number = [&](size_t i) { return std::strtof(arguments[i].c_str(), nullptr); };
        if (word == "move") mouse_ = {number(0), number(1)};
        if (word == "press" || word == "release") buttons_[kButtons.at(arguments[0])] = word == "press";
        if (word == "scroll") io.MouseWheel += number(0);
        if (word == "type") {
            io.AddInputCharactersUTF8(arguments[0].c_str());
            for (const char c : arguments[0]) window.presses().add_character(static_cast<unsigned char>(c));
        }
        if (word == "hold" || word == "let") {
            const int key = key_of(arguments[0]);
            io.KeysDown[key] = word == "hold";
            io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT];
            io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL];
            window.presses().add_key(key, word == "hold" ? GLFW_PRESS : GLFW_RELEASE,
                                     io.KeyCtrl ? GLFW_MOD_CONTROL : 0);
        }
        if (word == "drop") window.drop(arguments);
        if (word == "resize")
            glfwSetWindowSize(window.handle(), static_cast<int>(number(0)), static_cast<int>(number(1)));
        if (word == "shot") shot = arguments[0];
    }
    io.MousePos = {mouse_[0], mouse_[1]};
    std::copy(buttons_.begin(), buttons_.end(), io.MouseDown);
    return shot;
}

}  // namespace throng::view
