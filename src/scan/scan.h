// The scan stage: local transforms -> model transforms, by one method for one skeleton.
#pragma once

#include "gpu/kernel.h"
#include "scan/scan_io.h"
#include "scan/scan_table.h"

namespace throng {

// Affine[instance_count][joint_count] each, but for links.
struct ScanBuffers {
    BufferRange local;    // parent_from_joint, read
    BufferRange links;    // ScanStage::links()
    BufferRange model;    // model_from_joint, written
    BufferRange scratch;  // the method's own; another buffer than the rest
};

class ScanStage {
public:
    ScanStage() = default;
    // parents[j] < j, or io::kScanNoJoint.
    ScanStage(const std::shared_ptr<Gpu>& gpu, const ScanMethod& method, std::span<const uint32_t> parents);

    const ScanMethod& method() const { return *method_; }
    const Buffer& links() const { return links_; }
    Bindings bind(const ScanBuffers& buffers) const;
    void record(VkCommandBuffer commands, const Bindings& bindings, uint32_t instance_count) const;

private:
    const ScanMethod* method_ = nullptr;
    uint32_t joint_count_ = 0;
    Buffer links_;
    Kernel kernel_;
};

}  // namespace throng
