#include "tools/view/probe.h"

#include <algorithm>
#include <cstring>

namespace throng::view {
namespace {

constexpr uint32_t kMostParameters = 256;  // that are shown

}  // namespace

Probe::Probe(const Context& context) : buffer_(context.physical_device(), context.device(), kMostParameters * sizeof(float)) {}

void Probe::record(VkCommandBuffer commands, const Crowd& crowd, uint32_t instance) {
    const auto block = std::ranges::find_if(crowd.outputs(), [&](const OutputBlock& one) { return instance - one.first_instance < one.instance_count; });
    count_ = std::min(block->parameter_count, kMostParameters);
    if (count_ == 0) return;
    const VkBufferCopy copy{.srcOffset = VkDeviceSize{instance - block->first_instance} * block->parameter_count * sizeof(float), .size = count_ * sizeof(float)};
    vkCmdCopyBuffer(commands, block->parameter_buffer, buffer_.get(), 1, &copy);
    buffer_.record_end(commands);
}

std::vector<float> Probe::read() const {
    const std::vector<uint8_t> bytes = buffer_.read();
    std::vector<float> parameters(count_);
    std::memcpy(parameters.data(), bytes.data(), count_ * sizeof(float));
    return parameters;
}

}  // namespace throng::view
