#include "bench/scan_crowd.h"

#include "base/failure.h"
#include "base/thread_pool.h"
#include "gpu/barrier.h"
#include "scan/scan_reference.h"
#include "tools/creatures/creature_math.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng::bench {
namespace {

constexpr uint32_t kPoseCount = 64;

// As in gpu/similarity.glsl.
struct Similarity {
    Quaternion<float> rotation;
    Vec3<float> translation;
    float scale = 1;
};
static_assert(sizeof(Similarity) == 32);

Affine as_affine(const Trs<float>& pose) { return to_affine(pose.as<double>()).as<float>(); }
Similarity as_similarity(const Trs<float>& pose) { return {pose.rotation, pose.translation, pose.scale.x}; }

// Raises `worst` to `difference`. A NaN replaces any number and stays.
void take_larger(double& worst, double difference) {
    if (difference > worst || difference != difference) worst = difference;
}

size_t index_of(ScanLayout layout, size_t instance, size_t joint, size_t instance_count, size_t joint_count) {
    return layout == ScanLayout::kTransposed ? joint * instance_count + instance : instance * joint_count + joint;
}

Vec3<double> random_direction(creature::Random& random) {
    const double z = random.between(-1, 1), angle_rad = random.between(0, 2 * std::numbers::pi),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(angle_rad), r * std::sin(angle_rad), z};
}

// The number of instances that the storage-buffer range, one allocation and one dispatch allow. An instance may need
// its own workgroup, and 64 invocations of the copy kernel copy 64 matrices.
uint32_t batch_capacity(const Gpu& gpu, uint32_t joint_count) {
    const uint64_t instance_bytes = uint64_t{joint_count} * sizeof(Affine),
                   workgroups = gpu.properties.limits.maxComputeWorkGroupCount[0];
    const uint64_t range_bytes = std::min<uint64_t>(gpu.properties.limits.maxStorageBufferRange,
                                                    gpu.max_allocation_bytes);
    const uint64_t capacity = std::min({range_bytes / instance_bytes, workgroups, workgroups * 64 / joint_count});
    if (capacity > 0) return static_cast<uint32_t>(std::min<uint64_t>(capacity, UINT32_MAX));
    throw Failure(ErrorCode::kLimit, "characters of " + std::to_string(joint_count) + " joints",
                  "the device's limits of buffer size or workgroup count are too low even for one character");
}

}  // namespace

PoseSet::PoseSet(const ScanRig& rig, uint32_t pose_count_in, uint64_t seed)
    : joint_count(rig.joint_count()), pose_count(pose_count_in) {
    creature::Random random(seed);
    for (uint32_t pose = 0; pose < pose_count; ++pose) {
        std::vector<AffineT<double>> parent_from_joint;
        for (uint32_t joint = 0; joint < joint_count; ++joint) {
            const auto rotation = axis_angle(random_direction(random), random.between(0, std::numbers::pi));
            const auto translation = random_direction(random) * random.between(0.05, 0.15);
            local.push_back(Trs<double>{rotation, translation}.as<float>());
            parent_from_joint.push_back(to_affine(local.back().as<double>()));
        }
        for (const AffineT<double>& model_from_joint : scan_reference(rig.parents, parent_from_joint)) {
            extent = std::max(extent, length(transform_point(model_from_joint, Vec3<double>{})));
            wanted.push_back(model_from_joint);
        }
    }
}

std::vector<std::byte> PoseSet::bytes(uint32_t first_instance, uint32_t instance_count, ScanLayout layout,
                                      ScanFormat format) const {
    const auto spread_out = [&](const auto& transform_of) {
        using Transform = decltype(transform_of(local[0]));
        std::vector<Transform> poses;
        for (const Trs<float>& pose : local) poses.push_back(transform_of(pose));
        std::vector<std::byte> out(size_t{instance_count} * joint_count * sizeof(Transform));
        auto* transforms = reinterpret_cast<Transform*>(out.data());
        for (size_t instance = 0; instance < instance_count; ++instance)
            for (size_t joint = 0; joint < joint_count; ++joint)
                transforms[index_of(layout, instance, joint, instance_count, joint_count)] =
                    poses[(first_instance + instance) % pose_count * joint_count + joint];
        return out;
    };
    return format == ScanFormat::kSimilarity ? spread_out(as_similarity) : spread_out(as_affine);
}

double max_error(std::span<const Affine> model, const PoseSet& poses, uint32_t first_instance, uint32_t instance_count,
                 ScanLayout layout) {
    const auto error_of = [&](size_t instance) {
        const size_t pose = (first_instance + instance) % poses.pose_count;
        double linear = 0, translation = 0;
        for (size_t joint = 0; joint < poses.joint_count; ++joint) {
            const Affine& got = model[index_of(layout, instance, joint, instance_count, poses.joint_count)];
            const AffineT<double>& wanted = poses.wanted[pose * poses.joint_count + joint];
            for (size_t row = 0; row < 3; ++row) {
                for (size_t column = 0; column < 3; ++column)
                    take_larger(linear, std::abs(got.row[row][column] - wanted.row[row][column]));
                take_larger(translation, std::abs(got.row[row][3] - wanted.row[row][3]));
            }
        }
        take_larger(linear, translation / poses.extent);
        return linear;
    };
    constexpr uint32_t kPart = 256;  // of a thread
    std::vector<double> of_parts((instance_count + kPart - 1) / kPart);
    ThreadPool threads(0);
    for_each_job(threads, static_cast<uint32_t>(of_parts.size()), [&](uint32_t part) {
        for (uint32_t i = part * kPart; i < std::min((part + 1) * kPart, instance_count); ++i)
            take_larger(of_parts[part], error_of(i));
    });
    double worst = 0;
    for (const double error : of_parts) take_larger(worst, error);
    return worst;
}

ScanCrowd::ScanCrowd(std::shared_ptr<Gpu> gpu, const ScanRig& rig, uint32_t instance_count, uint64_t seed)
    : gpu_(std::move(gpu)), poses_(rig, std::min(kPoseCount, instance_count), seed) {
    const uint64_t capacity = batch_capacity(*gpu_, rig.joint_count()),
                   batch_count = (instance_count + capacity - 1) / capacity;
    uint64_t largest_bytes = 0;
    for (uint64_t i = 0; i < batch_count; ++i) {
        Batch& batch = batches_.emplace_back();
        batch.first_instance = static_cast<uint32_t>(instance_count * i / batch_count);
        batch.instance_count = static_cast<uint32_t>(instance_count * (i + 1) / batch_count) - batch.first_instance;
        const uint64_t size_bytes = uint64_t{batch.instance_count} * rig.joint_count() * sizeof(Affine);
        batch.model = Buffer(gpu_, "model matrices", size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        batch.scratch = Buffer(gpu_, "scratch", size_bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        largest_bytes = std::max(largest_bytes, size_bytes);
    }
    read_back_ = Buffer(gpu_, "read-back", largest_bytes, 0, MemoryKind::kReadback);
    no_births_ = upload_table(gpu_, "births", std::vector<uint32_t>());
}

const Buffer& ScanCrowd::local(uint32_t index, ScanLayout layout, ScanFormat format) {
    Batch& batch = batches_[index];
    Buffer& buffer = batch.local[static_cast<size_t>(layout)][static_cast<size_t>(format)];
    if (!buffer.handle())
        buffer = upload(gpu_, "local transforms",
                        poses_.bytes(batch.first_instance, batch.instance_count, layout, format));
    return buffer;
}

BufferTable ScanCrowd::buffers(uint32_t batch, const ScanMethod& method, const Buffer& links) {
    return {{io::kLocalBuffer, local(batch, method.layout, method.format)},
            {io::kScanLinksBuffer, links},
            {io::kModelBuffer, batches_[batch].model},
            {io::kScratchBuffer, batches_[batch].scratch},
            {io::kBirthsBuffer, no_births_}};
}

void ScanCrowd::poison() const {
    gpu_->submit_and_wait([&](VkCommandBuffer commands) {
        memory_barrier(*gpu_, commands, kShaderRead | kShaderWrite | kTransferRead, kTransferWrite);
        for (const Batch& batch : batches_)
            for (const Buffer* buffer : {&batch.model, &batch.scratch})
                gpu_->vk.vkCmdFillBuffer(commands, buffer->handle(), 0, VK_WHOLE_SIZE, 0xFFFFFFFF);
    });
}

double ScanCrowd::max_error(ScanLayout layout) const {
    double worst = 0;
    for (const Batch& batch : batches_) {
        gpu_->submit_and_wait([&](VkCommandBuffer commands) {
            memory_barrier(*gpu_, commands, kShaderWrite, kTransferRead);
            const VkBufferCopy copy{0, 0, batch.model.size_bytes()};
            gpu_->vk.vkCmdCopyBuffer(commands, batch.model.handle(), read_back_.handle(), 1, &copy);
            memory_barrier(*gpu_, commands, kTransferWrite, kHostRead);
        });
        const std::span model(reinterpret_cast<const Affine*>(read_back_.mapped()),
                              size_t{batch.instance_count} * poses_.joint_count);
        take_larger(worst, bench::max_error(model, poses_, batch.first_instance, batch.instance_count, layout));
    }
    return worst;
}

}  // namespace throng::bench
