// Recorded frames on their way to the window: one may be shown while the processor draws the next.
#pragma once

#include "tools/view/canvas.h"
#include "tools/view/submission.h"
#include "tools/view/swapchain.h"

#include <array>
#include <future>
#include <optional>

namespace throng::view {

// From start() until end() or finish() returns, nothing else may use the queue.
class Display {
public:
    explicit Display(const Context& context);

    bool is_stale(VkExtent2D window_size) const { return swapchain_.is_stale(window_size); }
    // No frame may be ready or in flight.
    void resize(VkExtent2D window_size);
    VkFormat format() const { return swapchain_.format(); }
    VkExtent2D extent() const { return swapchain_.extent(); }

    // The next frame's commands.
    VkCommandBuffer begin();
    // Completes the commands, which copy the canvas to the window. Waits for the previous frame; then this one is
    // ready.
    void end(const Canvas& canvas);
    // Begins to show the frame that is ready, if there is one; does not wait for it.
    void start();
    // Shows the frame that is ready, and waits for it.
    void finish();
    // Waits until no frame is in flight, even after a failure.
    void abandon();

private:
    void wait();

    const Context* context_;
    Swapchain swapchain_;
    std::array<Submission, 2> submissions_;  // of the frame that is being recorded, and of the one before
    uint32_t recorded_ = 0;                  // index of the former in submissions_
    bool is_ready_ = false;
    std::optional<uint32_t> image_;  // of the frame that is ready; none: the swapchain is stale, and it is not shown
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    std::future<void> shown_;  // of the frame that has been started
};

}  // namespace throng::view
