#include "bench/scan_tune.h"
#include "tools/command.h"

#include <cstdio>
#include <ctime>

namespace throng::tools {
namespace {

struct TuneOptions {
    std::string device;
    bool dry_run = false;
};

std::string today() {
    const std::time_t now = std::time(nullptr);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
    return text;
}

void run_tune(const TuneOptions& options) {
    const Device device = open_device(options.device);
    const Gpu& gpu = *device.gpu();
    const std::filesystem::path file = scan_costs_file(gpu);
    if (file.empty() && !options.dry_run) throw CommandError("neither XDG_CACHE_HOME nor HOME is set: there is no cache folder to keep the costs in (--dry-run prints them)");
    const ScanLimits limits = scan_limits(gpu);
    const std::vector<bench::ScanObservation> observations = bench::observe_scans(device.gpu(), print_progress);
    print_progress("");
    const ScanCosts start = built_in_scan_costs(gpu);
    ScanCosts costs = bench::fit_scan_costs(observations, limits, start);
    costs.origin = "measured by throng tune, " + today();
    std::printf("%s, driver %s: %zu scans measured\n%s", device.info().name.c_str(), device.info().driver.c_str(), observations.size(), to_json(costs).c_str());
    std::printf("predictions are off by a factor of %.2f (median); with the built-in costs by %.2f\n", bench::typical_factor(observations, limits, costs),
                bench::typical_factor(observations, limits, start));
    if (options.dry_run) return;
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    const std::string text = to_json(costs);
    write_file(file, std::as_bytes(std::span(text)));
    std::printf("kept in %s\n", file.c_str());
}

}  // namespace

void add_tune(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("tune", "measure what scans cost on this device, for --scan auto to choose by");
    auto options = std::make_shared<TuneOptions>();
    add_device_option(command, options->device);
    command.add_flag("--dry-run", options->dry_run, "print the costs, and keep nothing");
    command.footer("Takes about two minutes on a software device. The costs are kept in $XDG_CACHE_HOME/throng or ~/.cache/throng, a file a device.\n"
                   "Examples:\n  throng tune\n  throng tune --device cpu --dry-run");
    command.callback([options] { run_tune(*options); });
}

}  // namespace throng::tools
