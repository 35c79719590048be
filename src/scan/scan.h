// The scan stage: local transforms -> model transforms, by one method for one skeleton.
#pragma once

#include "gpu/kernel.h"
#include "gpu/upload.h"
#include "scan/scan_io.h"
#include "scan/scan_table.h"

namespace throng {

ScanLimits scan_limits(const Gpu& gpu);

// A method, and its number of invocations per character, one of ScanMethod::thread_choices().
struct ScanChoice {
    const ScanMethod* method = nullptr;
    uint32_t threads = 0;
};

class ScanStage {
public:
    ScanStage() = default;
    // Throws kUnsupported with the plan's reason if the method does not apply. `limits` may be lower than the device's.
    // `varies`: instances come and go, and those that are not there are left out as far as the method allows.
    ScanStage(Uploads& uploads, const ScanChoice& choice, const ScanRig& rig, const ScanLimits& limits,
              bool varies = false);
    // Like the other constructor, but submits the uploads and waits for them.
    ScanStage(const std::shared_ptr<Gpu>& gpu, const ScanChoice& choice, const ScanRig& rig, const ScanLimits& limits);

    const ScanChoice& choice() const { return choice_; }
    const ScanCounts& counts() const { return counts_; }
    uint32_t workgroup_size() const { return workgroup_size_; }
    const Buffer& links() const { return links_; }
    // All buffers except links() are [instance_count][joint_count], or [joint_count][instance_count] with
    // ScanLayout::kTransposed.
    Bindings bind(const BufferTable& buffers) const { return kernel_.bind(buffers); }
    void record(VkCommandBuffer commands, const Bindings& bindings, uint32_t instance_count) const;

private:
    ScanChoice choice_;
    ScanCounts counts_;
    uint32_t joint_count_ = 0, workgroup_size_ = 0, instances_per_workgroup_ = 1;
    Buffer links_;
    Kernel kernel_;
};

}  // namespace throng
