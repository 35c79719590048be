#include "base/failure.h"
#include "gpu/gpu.h"
#include "gpu/kernel.h"

#include <throng/device.h>

#include <utility>

namespace throng {

Result<std::vector<DeviceInfo>> Device::list() {
    return as_result([] { return Gpu::list(); });
}

Result<Device> Device::create(const DeviceSettings& settings) {
    return as_result([&] { return Device(Gpu::create(settings)); });
}

Result<Device> Device::adopt(const AdoptedDevice& adopted) {
    return as_result([&] { return Device(Gpu::adopt(adopted)); });
}

Device::Device(std::shared_ptr<Gpu> gpu) : gpu_(std::move(gpu)) {}

const std::shared_ptr<Gpu>& Device::gpu() const {
    if (!gpu_)
        throw Failure(ErrorCode::kInvalidArgument, "device", "the Device has been moved from and cannot be used");
    return gpu_;
}

const DeviceInfo& Device::info() const {
    static const DeviceInfo none;
    return gpu_ ? gpu_->info : none;
}

Result<void> Device::warm_up() const {
    return as_result([&] { make_pipelines(*gpu()); }, "device");
}

uint32_t Device::validation_message_count() const { return gpu_ ? gpu_->validation_message_count() : 0; }

}  // namespace throng
