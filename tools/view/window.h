// The window, by GLFW.
#pragma once

#include <vulkan/vulkan.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace throng::view {

// A key that went down, or the character that it typed; most keys report both.
struct KeyPress {
    int key = 0;  // of GLFW; 0: a character
    bool with_ctrl = false;
    unsigned character = 0;  // of Unicode; 0: a key
};

// What was pressed since it was last taken, even if it has been released since: a frame can take longer than a key
// press. A key that is held counts once, however often the keyboard repeats it. The characters of steps() count again
// with each repeat, unless they are still waiting to be taken.
class KeyPresses {
public:
    // As GLFW reports them: first a key, then the character that it typed.
    void add_key(int key, int action, int modifiers) {
        is_repeated_ = action == GLFW_REPEAT;
        if (action == GLFW_PRESS) pressed_.push_back({.key = key, .with_ctrl = (modifiers & GLFW_MOD_CONTROL) != 0});
    }
    void add_character(unsigned character) {
        if (!is_repeated_ || (steps(character) && !is_waiting(character))) pressed_.push_back({.character = character});
    }

    std::span<const KeyPress> all() const { return pressed_; }
    std::vector<KeyPress> take() { return std::exchange(pressed_, {}); }

private:
    // One frame on, more characters, fewer characters
    static bool steps(unsigned character) { return character == '.' || character == '+' || character == '-'; }
    bool is_waiting(unsigned character) const {
        return std::ranges::any_of(pressed_, [&](const KeyPress& press) { return press.character == character; });
    }

    std::vector<KeyPress> pressed_;
    bool is_repeated_ = false;
};

// Only one can exist at a time. Hidden until show(). Throws a CommandError if there is no display.
class Window {
public:
    Window(uint32_t width, uint32_t height);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    void show() { glfwShowWindow(window_); }
    GLFWwindow* handle() const { return window_; }
    VkExtent2D size() const;      // pixels; 0 where it is minimised
    float content_scale() const;  // of the display: 1, or 2 where pixels are small
    bool closes() const { return glfwWindowShouldClose(window_) != 0; }

    // Files dropped since the last call, those of the last drop only.
    std::vector<std::string> take_dropped() { return std::exchange(dropped_, {}); }
    void drop(std::vector<std::string> files) { dropped_ = std::move(files); }

    KeyPresses& presses() { return presses_; }

private:
    GLFWwindow* window_ = nullptr;
    std::vector<std::string> dropped_;
    KeyPresses presses_;
};

}  // namespace throng::view
