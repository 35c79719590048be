// What the device alone knows of one character: the parameters of its controller.
#pragma once

#include "tools/view/context.h"

#include <throng/crowd.h>

namespace throng::view {

class Probe {
public:
    explicit Probe(const Context& context);

    // Behind the crowd's update.
    void record(VkCommandBuffer commands, const Crowd& crowd, uint32_t instance);
    // Once that has run; empty where the character has no controller.
    std::vector<float> read() const;

private:
    HostBuffer buffer_;
    uint32_t count_ = 0;
};

}  // namespace throng::view
