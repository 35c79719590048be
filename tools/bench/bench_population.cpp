// throng bench population: instances that come and go.
#include "bench/population_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/generated_field.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"

#include <cstdio>

namespace throng::tools {
namespace {

struct PopulationOptions {
    FieldOptions field{.count = 20'000};
    std::string device;
    uint32_t samples = 9;
    UpdatePath path = UpdatePath::kAuto;
    bool json = false;
};

void print_rows(std::span<const Json> records) {
    std::printf("%10s %-10s %9s %19s  %s\n", "characters", "who are", "ms", "5 % - 95 %", "memory, MiB");
    for (const Json& record : records) {
        if (!record.contains("instances")) continue;
        print_columns(record, {{"%10.0f", "characters"}});
        std::printf(" %-10s ", text(record, "instances").c_str());
        if (print_untimed(record, "not measured")) continue;
        print_columns(record, {{"%9.3f", "ms/median"},
                               {" %8.3f", "ms/p5"},
                               {" - %8.3f", "ms/p95"},
                               {"  %.0f\n", "memory_bytes", 1.0 / (1 << 20)}});
    }
    std::printf("\n%-18s %10s %8s %12s %12s\n", "frames with", "characters", "changed", "calls, ms", "update, ms");
    for (const Json& record : records) {
        if (!record.contains("frames_with")) continue;
        std::printf("%-18s", text(record, "frames_with").c_str());
        print_columns(record, {{" %10.0f", "characters"}, {" %8.0f ", "changed"}});
        if (print_untimed(record, "not measured")) continue;
        print_columns(record, {{"%12.3f", "call_ms/median"}, {" %12.3f\n", "update_ms/median"}});
    }
}

void run_population(const PopulationOptions& options) {
    const Device device = open_device(options.device);
    print_progress("compiling");
    const Field field = make_field(options.field);
    const std::vector<Json> records = bench::measure_population(device,
                                                                {.configuration = field.configuration,
                                                                 .character = &field.character,
                                                                 .playback = field.playback,
                                                                 .placement = field.placement,
                                                                 .path = options.path},
                                                                options.samples, print_progress);
    Measured measured(options.json);
    measured.add(records, [&] {
        std::printf("%s, driver %s: room for %s, %s; medians of %u updates\n", device.info().name.c_str(),
                    device.info().driver.c_str(), field.configuration.c_str(), text(records.front(), "path").c_str(),
                    options.samples);
        print_rows(records);
    });
    measured.finish("", "an update");
}

}  // namespace

void add_bench_population(Command bench) {
    Command command = bench.add_subcommand("population",
                                           "characters that come and go: what free room costs, and births and deaths "
                                           "beside new playbacks");
    auto options = std::make_shared<PopulationOptions>();
    add_field_options(command, options->field);
    add_path_option(command, options->path);
    add_samples_option(command, options->samples);
    add_json_flag(command, options->json);
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench population\n  throng bench population fox.glb --count 40000 --path device\n  "
        "throng bench population --json > population.jsonl");
    command.callback([options] { run_population(*options); });
}

}  // namespace throng::tools
