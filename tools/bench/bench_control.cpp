// throng bench control: what state machines, layers and events of a crowd cost, beside the whole update.
#include "bench/control_bench.h"
#include "tools/cli/command.h"
#include "tools/creatures/creature.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"

#include <cstdio>

namespace throng::tools {
namespace {

struct ControlOptions {
    std::vector<uint32_t> counts{1'000, 10'000, 100'000};
    uint32_t joints = 300, levels = 60, samples = 30;
    uint64_t seed = 1;
    std::string device;
    UpdatePath path = UpdatePath::kAuto;
    bool json = false;
};

// A crowd that would have more joints than this gives each character fewer, but at least 40, as small characters in the
// distance have
constexpr uint64_t kJointBudget = 4'000'000;

void print_control_row(const Json& record) {
    print_columns(record, {{"%10.0f", "characters"}, {" %7.0f ", "joints"}});
    if (print_untimed(record, "not measured")) return;
    print_columns(record, {{"%9.3f", "control_ms/median"},
                           {" %9.3f", "control_ms/p5"},
                           {" -%8.3f", "control_ms/p95"},
                           {" %12.1f", "ns_per_character"},
                           {" %12.3f", "update_ms/median"},
                           {" %7.1f %%", "share", 100},
                           {"  %.1e\n", "max_error"}});
}

void run_control(const ControlOptions& options) {
    const Device device = open_device(options.device);
    Measured measured(options.json);
    for (const uint32_t count : options.counts) {
        const uint32_t joints = std::min(options.joints,
                                         static_cast<uint32_t>(std::max<uint64_t>(kJointBudget / count, 40)));
        const Character character = unwrap(compile_character(unwrap(make_creature(
            {.joint_count = joints, .level_count = std::min(options.levels, joints / 3), .seed = options.seed}))));
        const Json record = bench::measure_control(device,
                                                   {.character = &character,
                                                    .count = count,
                                                    .samples = options.samples,
                                                    .seed = options.seed,
                                                    .path = options.path},
                                                   print_progress);
        measured.add({&record, 1}, [&] {
            if (measured.all().empty())
                std::printf(
                    "%s, driver %s: 12 states in 3 layers, %s; medians of %u updates\n%10s %7s %9s %19s %12s %12s %9s  "
                    "%s\n",
                    device.info().name.c_str(), device.info().driver.c_str(), text(record, "path").c_str(),
                    options.samples, "characters", "joints", "control", "5 % - 95 %", "ns/character", "update", "share",
                    "error");
            print_control_row(record);
        });
    }
    measured.finish("", "an update");
}

}  // namespace

void add_bench_control(Command bench) {
    Command command = bench.add_subcommand(
        "control",
        "state machines: 12 states in 3 layers for each character, checked, then timed beside the whole update");
    auto options = std::make_shared<ControlOptions>();
    command.add_option("--characters", options->counts, "numbers of characters, comma-separated")
        .delimiter(',')
        .check(range(1u, 1'000'000u))
        .capture_default_str();
    command.add_option("--joints", options->joints, "joints of each; fewer where all together would exceed 4,000,000")
        .check(range(40u, 1000u))
        .capture_default_str();
    command.add_option("--levels", options->levels, "levels of the skeletons, at most a third of the joints")
        .check(range(8u, 300u))
        .capture_default_str();
    add_path_option(command, options->path);
    add_samples_option(command, options->samples);
    command.add_option("--seed", options->seed, "seed of creatures and parameters").capture_default_str();
    add_json_flag(command, options->json);
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench control\n  throng bench control --characters 10000 --joints 64\n  throng bench "
        "control --json > control.jsonl");
    command.callback([options] { run_control(*options); });
}

}  // namespace throng::tools
