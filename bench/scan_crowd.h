// The characters of one measurement: a skeleton, poses, their buffers on the device, and the results of the reference.
#pragma once

#include "scan/scan.h"

namespace throng::bench {

// Largest difference between two model matrices: of their linear parts (whose scale is 1), and of their translations as
// a fraction of the skeleton's extent. NaN if any number is NaN. A scan is wrong above kErrorBound; rounding errors
// stay far below it.
inline constexpr double kErrorBound = 1e-5;
inline bool is_wrong(double error) { return !(error <= kErrorBound); }

// A few poses of one skeleton: rotations and small translations of any kind, no scale, so that similarities hold them
// too.
struct PoseSet {
    PoseSet(const ScanRig& rig, uint32_t pose_count, uint64_t seed);

    uint32_t joint_count = 0, pose_count = 0;
    std::vector<Trs<float>> local;        // [pose][joint], parent_from_joint
    std::vector<AffineT<double>> wanted;  // [pose][joint], model_from_joint by the reference
    double extent = 0;                    // the longest translation in `wanted`

    // local[instance][joint], or [joint][instance], as a method of this layout and format reads it; instance i has pose
    // i % pose_count.
    std::vector<std::byte> bytes(uint32_t first_instance, uint32_t instance_count, ScanLayout layout,
                                 ScanFormat format) const;
};

class ScanCrowd {
public:
    // Throws kLimit and kOutOfMemory.
    ScanCrowd(std::shared_ptr<Gpu> gpu, const ScanRig& rig, uint32_t instance_count, uint64_t seed);

    // A run of characters whose buffers fit the device.
    struct Batch {
        uint32_t first_instance = 0, instance_count = 0;
        Buffer model, scratch;
        std::array<std::array<Buffer, 2>, 2> local;  // [ScanLayout][ScanFormat], made when first asked for
    };
    uint32_t instance_count() const { return batches_.back().first_instance + batches_.back().instance_count; }
    uint32_t batch_count() const { return static_cast<uint32_t>(batches_.size()); }
    const Batch& batch(uint32_t index) const { return batches_[index]; }
    uint64_t row_count(uint32_t batch) const {
        return uint64_t{3} * batches_[batch].instance_count * poses_.joint_count;
    }

    const Buffer& local(uint32_t batch, ScanLayout layout, ScanFormat format);
    BufferTable buffers(uint32_t batch, const ScanMethod& method, const Buffer& links);

    // Fills the results with NaN, to detect matrices that a method does not write.
    void poison() const;
    // The largest error of all matrices of all instances.
    double max_error(ScanLayout layout) const;

private:
    std::shared_ptr<Gpu> gpu_;
    PoseSet poses_;
    std::vector<Batch> batches_;
    Buffer read_back_, no_births_;
};

// Largest difference of instances' matrices (of pose i % pose_count, or of pose 0 alone) from the reference.
double max_error(std::span<const Affine> model, const PoseSet& poses, uint32_t first_instance, uint32_t instance_count,
                 ScanLayout layout);

}  // namespace throng::bench
