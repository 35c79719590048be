// One command buffer that is recorded, submitted and waited for again and again.
#pragma once

#include "tools/view/context.h"

namespace throng::view {

class Submission {
public:
    explicit Submission(const Context& context);

    // The last submission must have been waited for.
    VkCommandBuffer begin();
    // Transfers wait for `before`; `after` is signalled at the end. Both may be null.
    void submit(VkSemaphore before, VkSemaphore after);
    void wait();

private:
    const Context* context_;
    OwnedCommandPool pool_;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    OwnedFence finished_;
};

}  // namespace throng::view
