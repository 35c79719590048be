// Work that is submitted and waited for, from any thread.
#pragma once

#include "gpu/vulkan.h"

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace throng {

class Gpu;

class Submissions {
public:
    // `keeps_idle`: command pools and fences are kept for reuse, as many as there have been submissions at the same
    // time. NVIDIA's driver takes longer to make a pool than an H100 takes for a small update.
    Submissions(const Gpu& gpu, bool keeps_idle);
    ~Submissions();

    // Submits what `body` records to the device's queue, and waits for it. It sees all work submitted before.
    void run(const std::function<void(VkCommandBuffer)>& body);
    // Frees what is kept; no submission may be running.
    void clear();

private:
    struct Submission;
    std::unique_ptr<Submission> take();
    void give_back(std::unique_ptr<Submission> submission);

    const Gpu& gpu_;
    const bool keeps_idle_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Submission>> idle_;
};

}  // namespace throng
