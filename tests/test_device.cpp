#include "tests/test_device.h"

#include "gpu/gpu.h"
#include "scan/scan_shaders.h"

#include <cstdlib>
#include <map>
#include <optional>

namespace throng {
namespace {

Device created_device(const DeviceSettings& settings) {
    Result<Device> device = Device::create(settings);
    if (!device) {
        ADD_FAILURE() << device.error().text();
        std::abort();
    }
    return *device;
}

std::string environment(const char* name, const char* otherwise) {
    const char* value = std::getenv(name);
    return value ? value : otherwise;
}

std::optional<Device>& device_slot() {
    static std::optional<Device> device;
    return device;
}

// Fails the running test if the validation layer has reported anything since the last check.
class ValidationListener : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo&) override {
        if (!device_slot()) return;
        const uint32_t count = device_slot()->validation_message_count();
        if (count > seen_) ADD_FAILURE() << count - seen_ << " messages of the validation layer; they are on stderr";
        seen_ = count;
    }
    void OnTestProgramEnd(const testing::UnitTest&) override { device_slot().reset(); }

    uint32_t seen_ = 0;
};

}  // namespace

Device& test_device() {
    std::optional<Device>& device = device_slot();
    if (device) return *device;
    const std::map<std::string, Validation> validations{{"off", Validation::kOff},
                                                        {"standard", Validation::kStandard},
                                                        {"synchronization", Validation::kSynchronization},
                                                        {"gpu-assisted", Validation::kGpuAssisted}};
    device = created_device({.select = environment("THRONG_DEVICE", ""),
                             .validation = validations.at(environment("THRONG_VALIDATION", "synchronization")),
                             .pipeline_cache = false});
    testing::UnitTest::GetInstance()->listeners().Append(new ValidationListener);
    std::printf("device: %s, driver %s, subgroups of %u\n", device->info().name.c_str(), device->info().driver.c_str(),
                device->info().subgroup_size);
    return *device;
}

bool rounds_like_the_cpu() { return test_device().gpu()->is_cpu() || test_device().gpu()->is_native(); }

Device another_device() { return created_device({.select = test_device().info().name, .pipeline_cache = false}); }

bool has_scan(std::string_view method) { return !test_device().gpu()->is_native() || scan_shaders(method).native; }

Device device_of_workgroups(uint32_t max_workgroups) {
    Device device = another_device();
    uint32_t& limit = device.gpu()->properties.limits.maxComputeWorkGroupCount[0];
    limit = std::min(limit, max_workgroups);
    return device;
}

}  // namespace throng
