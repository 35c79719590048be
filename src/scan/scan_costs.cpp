#include "scan/scan_costs.h"

#include "base/text.h"
#include "base/cache_folder.h"
#include "base/failure.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

namespace throng {
namespace {

constexpr std::array<std::pair<const char*, double ScanCosts::*>, 10> kNumbers{
    {{"launch_ms", &ScanCosts::launch_ms},
     {"row_ns", &ScanCosts::row_ns},
     {"scattered_rows", &ScanCosts::scattered_rows},
     {"multiplication_ns", &ScanCosts::multiplication_ns},
     {"barrier_ns", &ScanCosts::barrier_ns},
     {"workgroup_ns", &ScanCosts::workgroup_ns},
     {"latency_ns", &ScanCosts::latency_ns},
     {"units", &ScanCosts::units},
     {"resident_subgroups", &ScanCosts::resident_subgroups},
     {"bytes_per_ns", &ScanCosts::bytes_per_ns}}};

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

// What a GPU's data sheet says.
struct DataSheet {
    std::string_view maker;
    double simds = 0;      // of 32 lanes
    double subgroups = 0;  // subgroups of these kernels that a SIMD holds
    double clock_ghz = 0, bytes_per_ns = 0;
};

// The numbers of clocks come from AMD's machine code for RDNA 2 (`throng tune --predicted 'RX 6900 XT'`) and are used
// for other makers too. docs/scan.md has measurements on an H100; `throng tune` replaces these costs by measured ones.
ScanCosts costs_of(const DataSheet& gpu) {
    return {.launch_ms = 0.003,
            .row_ns = 3.9 / gpu.clock_ghz,
            // A row touches 32 cache lines, instead of 12 if joints are adjacent
            .scattered_rows = 2.7,
            .multiplication_ns = 54 / gpu.clock_ghz,
            .barrier_ns = 5.6 / gpu.clock_ghz,
            .workgroup_ns = 61 / gpu.clock_ghz,
            .latency_ns = 548 / gpu.clock_ghz,
            .units = gpu.simds,
            .resident_subgroups = gpu.simds * gpu.subgroups,
            .bytes_per_ns = gpu.bytes_per_ns,
            .origin = "built in for " + std::string(gpu.maker) + ", from machine code and data sheets"};
}

}  // namespace

ScanCosts built_in_scan_costs(const Gpu& gpu) {
    // Fitted by `throng tune` on lavapipe, Mesa 22.3.6, two cores of an AMD EPYC.
    if (gpu.is_cpu())
        return {.launch_ms = 0.03,
                .row_ns = 80,
                .multiplication_ns = 1,
                .barrier_ns = 900,
                .workgroup_ns = 13'000,
                .latency_ns = 1e-3,
                .units = std::max(1.0, static_cast<double>(std::thread::hardware_concurrency())),
                .resident_subgroups = 1e9,
                .bytes_per_ns = 20,
                .origin = "built in for software devices"};
    ScanCosts costs = built_in_hardware_costs(gpu.properties.vendorID);
    if (gpu.simd_count > 0) costs.resident_subgroups *= gpu.simd_count / costs.units;
    return costs;
}

ScanCosts built_in_hardware_costs(uint32_t vendor_id) {
    constexpr uint32_t kNvidia = 0x10DE, kAmd = 0x1002, kIntel = 0x8086;
    switch (vendor_id) {
        case kNvidia: return costs_of({"NVIDIA", 272, 10, 1.71, 760});  // RTX 3080
        case kAmd: return costs_of({"AMD", 160, 16, 2.25, 512});        // RX 6900 XT
        case kIntel: return costs_of({"Intel", 128, 16, 2.1, 560});     // Arc A770
        default: return costs_of({"other GPUs", 272, 10, 1.71, 760});
    }
}

std::filesystem::path scan_costs_file(const Gpu& gpu) {
    const std::filesystem::path folder = cache_folder();
    if (folder.empty()) return {};
    std::string name = gpu.info.name + " " + gpu.info.driver;
    for (char& c : name)
        if (!is_ascii_alphanumeric(c) && c != '.' && c != '-') c = '_';
    return folder / ("scan_costs_" + name + ".json");
}

std::string to_json(const ScanCosts& costs) {
    nlohmann::ordered_json json;
    for (const auto& [name, member] : kNumbers) json[name] = costs.*member;
    json["origin"] = costs.origin;
    return json.dump(2) + "\n";
}

ScanCosts scan_costs_from_json(std::string_view text, const std::string& place) {
    const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
    ScanCosts costs;
    for (const auto& [name, member] : kNumbers) {
        const auto found = json.is_object() ? json.find(name) : json.end();
        if (found == json.end() || !found->is_number() || !std::isfinite(found->get<double>()) ||
            found->get<double>() <= 0)
            throw Failure(ErrorCode::kInvalidFile, place,
                          std::string("'") + name + "' is not a positive number; 'throng tune' replaces the file");
        costs.*member = found->get<double>();
    }
    const auto origin = json.find("origin");
    if (origin == json.end() || !origin->is_string())
        throw Failure(ErrorCode::kInvalidFile, place, "'origin' is not a string; 'throng tune' replaces the file");
    costs.origin = origin->get<std::string>();
    // It is printed as part of one line, which control characters would break
    std::replace_if(
        costs.origin.begin(), costs.origin.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return costs;
}

ScanCosts scan_costs(const Gpu& gpu) {
    const std::filesystem::path file = scan_costs_file(gpu);
    std::error_code error;
    if (file.empty() || !std::filesystem::is_regular_file(file, error)) return built_in_scan_costs(gpu);
    try {
        return scan_costs_from_json(read_text(file), file.string());
        // The planner works without the file; `origin` tells why it was not used
    } catch (const Failure& failure) {
        ScanCosts costs = built_in_scan_costs(gpu);
        costs.origin += " (" + failure.text + ")";
        return costs;
    }
}

}  // namespace throng
