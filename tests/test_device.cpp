#include "tests/test_device.h"

#include <cstdlib>
#include <map>
#include <optional>

namespace throng {
namespace {

std::string environment(const char* name, const char* otherwise) {
    const char* value = std::getenv(name);
    return value ? value : otherwise;
}

std::optional<Device>& device_slot() {
    static std::optional<Device> device;
    return device;
}

// Fails the running test when the layer has spoken since the last look.
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
    Result<Device> created = Device::create({.select = environment("THRONG_DEVICE", ""), .validation = validations.at(environment("THRONG_VALIDATION", "synchronization"))});
    if (!created) {
        ADD_FAILURE() << created.error().text();
        std::abort();
    }
    device = *created;
    testing::UnitTest::GetInstance()->listeners().Append(new ValidationListener);
    std::printf("device: %s, driver %s, subgroups of %u\n", device->info().name.c_str(), device->info().driver.c_str(), device->info().subgroup_size);
    return *device;
}

std::filesystem::path shared_folder(const std::string& name) {
    return std::filesystem::path(environment("THRONG_SHARED", THRONG_SHARED_DIR)) / name;
}

}  // namespace throng
