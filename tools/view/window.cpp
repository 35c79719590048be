#include "tools/view/window.h"

#include "tools/cli/command.h"

namespace throng::view {
namespace {

// GLFW's last message. It has no line breaks.
std::string glfw_error() {
    const char* text = nullptr;
    return glfwGetError(&text) == GLFW_NO_ERROR ? "unknown error" : text;
}

}  // namespace

Window::Window(uint32_t width, uint32_t height) {
    if (!glfwInit())
        throw tools::CommandError("no window can be opened: is DISPLAY set? 'throng render' draws without one");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    window_ = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height), "throng", nullptr, nullptr);
    if (!window_) {
        const std::string why = glfw_error();
        glfwTerminate();
        throw tools::CommandError("no window of " + std::to_string(width) + "x" + std::to_string(height) +
                                  " can be opened: " + why);
    }
    glfwSetWindowSizeLimits(window_, 320, 200, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->presses().add_key(key, action, modifiers);
    });
    glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned character) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->presses().add_character(character);
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
        static_cast<Window*>(glfwGetWindowUserPointer(window))->drop({paths, paths + count});
    });
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

VkExtent2D Window::size() const {
    if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return {};
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

float Window::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    return x;
}

}  // namespace throng::view
