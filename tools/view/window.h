// The window, by GLFW.
#pragma once

#include <vulkan/vulkan.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace throng::view {

struct KeyPress {
    int key = 0;  // of GLFW
    bool with_ctrl = false;
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

    // Keys pressed since the last call, even if released since: a frame can take longer than a key press.
    std::span<const KeyPress> pressed() const { return pressed_; }
    std::vector<KeyPress> take_pressed() { return std::exchange(pressed_, {}); }
    void press(const KeyPress& press) { pressed_.push_back(press); }

private:
    GLFWwindow* window_ = nullptr;
    std::vector<std::string> dropped_;
    std::vector<KeyPress> pressed_;
};

}  // namespace throng::view
