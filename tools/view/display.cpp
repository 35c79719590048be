#include "tools/view/display.h"

namespace throng::view {

Display::Display(const Context& context)
    : context_(&context), swapchain_(context), submissions_{Submission(context), Submission(context)} {}

void Display::abandon() {
    if (shown_.valid()) shown_.wait();
    vkDeviceWaitIdle(context_->device());
}

void Display::resize(VkExtent2D window_size) {
    check(vkDeviceWaitIdle(context_->device()), "vkDeviceWaitIdle");
    swapchain_.recreate(window_size);
}

VkCommandBuffer Display::begin() {
    recorded_ ^= 1;
    return commands_ = submissions_[recorded_].begin();
}

void Display::end(const Canvas& canvas) {
    wait();
    image_ = swapchain_.acquire();
    if (image_) canvas.record_copy(commands_, swapchain_.image(*image_));
    is_ready_ = true;
}

void Display::start() {
    if (!std::exchange(is_ready_, false)) return;
    shown_ = std::async(std::launch::async, [this, &submission = submissions_[recorded_], image = image_] {
        // Submits a frame even if it is not shown: it has been recorded, and others wait for its copies
        submission.submit(image ? swapchain_.acquired() : VK_NULL_HANDLE,
                          image ? swapchain_.written(*image) : VK_NULL_HANDLE);
        if (image) swapchain_.present(*image);
        submission.wait();
    });
}

void Display::finish() {
    start();
    wait();
}

void Display::wait() {
    if (shown_.valid()) shown_.get();
}

}  // namespace throng::view
