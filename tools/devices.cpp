#include "tools/cli/command.h"
#include "tools/commands.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace throng::tools {
namespace {

std::string version_text(uint32_t version) {
    return std::to_string(version >> 22 & 0x7F) + "." + std::to_string(version >> 12 & 0x3FF) + "." +
           std::to_string(version & 0xFFF);
}

void run_devices(bool json) {
    const std::vector<DeviceInfo> devices = unwrap(Device::list());
    if (json) {
        nlohmann::json list = nlohmann::json::array();
        for (const DeviceInfo& d : devices)
            list.push_back({{"index", d.index},
                            {"name", d.name},
                            {"type", d.type},
                            {"driver", d.driver},
                            {"vulkan", version_text(d.api_version)},
                            {"subgroup_size", d.subgroup_size},
                            {"shared_memory_bytes", d.shared_memory_bytes},
                            {"storage_buffer_range_bytes", d.storage_buffer_range_bytes},
                            {"usable", d.usable},
                            {"compiles_only", d.compiles_only}});
        return print_json(list);
    }
    for (const DeviceInfo& d : devices) {
        if (d.type == "native") {
            std::printf("%u  %s\n   native: updates and draws crowds without Vulkan\n", d.index, d.name.c_str());
            continue;
        }
        std::printf("%u  %s\n   %s, driver %s, Vulkan %s, subgroups of %u%s\n", d.index, d.name.c_str(), d.type.c_str(),
                    d.driver.c_str(), version_text(d.api_version).c_str(), d.subgroup_size,
                    d.usable          ? ""
                    : d.compiles_only ? "; compiles only, for 'throng bench isa'"
                                      : "; not usable: Vulkan 1.3 is needed");
    }
}

}  // namespace

void add_devices(Command app) {
    Command command = app.add_subcommand("devices",
                                         "list the devices of this machine: those of Vulkan, and its processor");
    auto json = std::make_shared<bool>(false);
    command.add_flag("--json", *json, "as JSON");
    command.footer("Examples:\n  throng devices\n  throng devices --json");
    command.callback([json] { run_devices(*json); });
}

}  // namespace throng::tools
