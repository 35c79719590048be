#include "bench/isa/predicted_costs.h"
#include "bench/record.h"
#include "bench/scan_tune.h"
#include "tools/cli/command.h"
#include "tools/cli/program.h"
#include "tools/bench/bench_commands.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace throng::tools {
namespace {

struct TuneOptions {
    std::string device, predicted;
    bool quick = false, dry_run = false, json = false;
};

// Predicts the costs of a GPU that is not in this machine.
void run_predicted(const TuneOptions& options) {
    const auto machine = std::ranges::find(bench::machines(), options.predicted, &bench::Machine::name);
    const auto [costs, scan_count, median_slack, largest_slack] = bench::predict_scan_costs(
        *machine, built_in_hardware_costs(0), print_progress);
    print_progress("");
    std::printf("%s", to_json(costs).c_str());
    if (options.json) return;
    std::printf(
        "from %u scans; methods chosen by these costs take %.2f times as long as the fastest (median), at most %.2f "
        "times\n",
        scan_count, median_slack, largest_slack);
}

// Checks, before the measurements, that their result can be kept.
void check_cache(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::create_directories(file.parent_path(), error) && error)
        throw CommandError(file.parent_path().string() + ": cannot be created: " + error.message());
    if (const std::string wrong = writable_file().what_is_wrong(file.string()); !wrong.empty())
        throw CommandError(wrong);
}

void run_tune(const TuneOptions& options) {
    if (!options.predicted.empty()) {
        if (!options.device.empty())
            throw UsageError("--predicted is for a GPU that is not in this machine; leave out --device");
        return run_predicted(options);
    }
    const Device device = open_vulkan_device(options.device);
    const Gpu& gpu = *device.gpu();
    const std::filesystem::path file = scan_costs_file(gpu);
    if (file.empty() && !options.dry_run)
        throw CommandError(
            "neither XDG_CACHE_HOME nor HOME is set: there is no cache folder to keep the costs in (--dry-run prints "
            "them)");
    if (!options.dry_run) check_cache(file);
    const ScanLimits limits = scan_limits(gpu);
    const std::vector<bench::ScanObservation> observations = bench::observe_scans(device.gpu(), options.quick,
                                                                                  print_progress);
    print_progress("");
    const ScanCosts start = built_in_scan_costs(gpu);
    ScanCosts costs = bench::fit_scan_costs(observations, limits, start);
    costs.origin = "measured by throng tune, " + bench::where_and_when(device.info())["date"].get<std::string>();
    if (options.json)
        print_json(nlohmann::json::parse(to_json(costs)));
    else
        std::printf("%s, driver %s: %zu scans measured\n%s", device.info().name.c_str(), device.info().driver.c_str(),
                    observations.size(), to_json(costs).c_str());
    if (!options.json)
        std::printf(
            "on these scans predictions are off by a factor of %.2f (median); with the built-in costs by %.2f\n",
            bench::typical_factor(observations, limits, costs), bench::typical_factor(observations, limits, start));
    if (options.dry_run) return;
    const std::string text = to_json(costs);
    write_file(file, std::as_bytes(std::span(text)));
    if (!options.json) std::printf("saved to %s\n", file.c_str());
}

}  // namespace

void add_tune(Command app) {
    Command command = app.add_subcommand(kTune.command, kTune.description);
    auto options = std::make_shared<TuneOptions>();
    add_device_option(command, options->device);
    const Option quick = command.add_flag("--quick", options->quick,
                                          "fewer and smaller scans: takes seconds, is less exact");
    command.add_flag("--dry-run", options->dry_run, "print the costs, and save nothing");
    std::vector<std::string> machines;
    for (const bench::Machine& machine : bench::machines()) machines.emplace_back(machine.name);
    command
        .add_option("--predicted", options->predicted,
                    "print the costs of a GPU that is not in this machine, as its machine code predicts them (throng "
                    "bench isa), and save nothing")
        .check(is_member(machines))
        .excludes(quick);
    command.add_flag("--json", options->json, "the costs as JSON");
    command.footer(
        "Takes about a minute. The costs are saved in $XDG_CACHE_HOME/throng or ~/.cache/throng, one file per device.\n"
        "Examples:\n  throng tune\n  throng tune --device cpu --dry-run\n  throng tune --predicted 'RTX 3080'");
    command.callback([options] { run_tune(*options); });
}

}  // namespace throng::tools
