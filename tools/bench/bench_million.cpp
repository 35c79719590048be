// throng bench million: a frame of very many characters.
#include "bench/million_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/generated_field.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"

#include <cstdio>

namespace throng::tools {
namespace {

struct MillionOptions {
    FieldOptions field{.count = 1'000'000};
    std::string size = "1280x720", device;
    uint32_t samples = 9, capacity = 32'768;
    float poses_per_s = 30, shared_pixels = 1, blending = 0.1f;
    UpdatePath path = UpdatePath::kAuto;
    bool json = false;
};

// Leaves the fraction `blending` of the playbacks between two clips; the rest play one.
std::vector<Playback> mostly_one_clip(std::vector<Playback> playback, float blending) {
    const double step = blending;
    double due = 0;
    for (Playback& one : playback) {
        due += step;
        if (due >= 1)
            due -= 1;
        else
            one.weight = 1;
    }
    return playback;
}

void print_views(std::span<const Json> records) {
    std::printf("%-12s %9s %9s %9s %9s %19s  %-6s %s\n", "view", "drawn", "own poses", "distinct", "ms", "5 % - 95 %",
                "pixels", "stages, ms");
    for (const Json& record : records) {
        if (!record.contains("drawn")) continue;
        std::printf("%-12s", text(record, "view").c_str());
        print_columns(record, {{" %9.0f", "drawn"}, {" %9.0f", "own_poses"}, {" %9.0f", "distinct_poses"}});
        if (print_untimed(
                record, "not measured", " pixels off",
                real(record, "max_pixels_own") > real(record, "max_pixels") ? "max_pixels_own" : "max_pixels"))
            continue;
        print_columns(record, {{" %9.2f", "ms/median"}, {" %8.2f", "ms/p5"}, {" - %8.2f", "ms/p95"}});
        if (record.contains("max_pixels"))
            print_columns(record, {{"  %-6.2f", "max_pixels"}});
        else
            std::printf("  %-6s", flag(record, "pool_is_full") ? "full" : "-");
        const Json stages = record.value("stages", Json::object());
        for (const auto& [stage, ms] : stages.items()) std::printf(" %s %.2f", stage.c_str(), ms.get<double>());
        std::printf("\n");
    }
    constexpr double kMiB = 1.0 / (1 << 20);
    print_columns(records.front(),
                  {{"memory of the crowd %.0f MiB;", "memory_bytes", kMiB},
                   {" skin matrices of all characters alone would take %.0f MiB\n", "matrices_of_all_bytes", kMiB}});
}

void print_recording(std::span<const Json> records) {
    const auto is_recording = [](const Json& record) { return bench::is_measured(record) && !record.contains("view"); };
    if (std::ranges::none_of(records, is_recording)) return;
    std::printf("\nthe CPU's part of a frame that the device computes\n%10s %10s %19s\n", "characters", "ms",
                "5 % - 95 %");
    for (const Json& record : records)
        if (is_recording(record)) {
            print_columns(record, {{"%10.0f ", "characters"}});
            if (print_untimed(record, "not measured")) continue;
            print_columns(
                record, {{"%10.3f", "record_ms/median"}, {" %8.3f", "record_ms/p5"}, {" - %8.3f\n", "record_ms/p95"}});
        }
}

void print_million_predictions(std::span<const Json> records) {
    std::string machine;
    for (const Json& record : records) {
        if (record.contains("family") && record.contains("unsupported_reason"))
            std::printf("\nnothing is predicted: %s\n", text(record, "unsupported_reason").c_str());
        if (!record.contains("machine")) continue;
        if (machine.empty())
            std::printf(
                "\npredicted from machine code (%s) and data sheets, measured on none of these; ms\n%-22s %-12s "
                "%8s %8s %8s %8s\n",
                text(record, "family").c_str(), "device", "view", "control", "cull", "fused", "in all");
        machine = text(record, "machine");
        std::printf("%-22s %-12s", machine.c_str(), text(record, "view").c_str());
        print_columns(record, {{" %8.3f", "predicted_stages/control"},
                               {" %8.3f", "predicted_stages/cull"},
                               {" %8.3f", "predicted_stages/fused"},
                               {" %8.3f", "predicted_ms"}});
        std::printf("\n");
    }
}

void run_million(const MillionOptions& options) {
    const Device device = open_device(options.device);
    const RendererSettings size = parse_size(options.size);
    print_progress("compiling");
    const Field field = make_field(options.field);
    const std::vector<Playback> playback = mostly_one_clip(field.playback, options.blending);
    const std::vector<Json> records = bench::measure_million(
        device,
        {.configuration = field.configuration,
         .character = &field.character,
         .playback = playback,
         .placement = field.placement,
         .path = options.path,
         .pool = {.capacity = options.capacity, .shared_poses_per_s = options.poses_per_s},
         .width = size.width,
         .height = size.height,
         .shared_pose_pixels = options.shared_pixels},
        options.samples, print_progress);
    Measured measured(options.json);
    measured.add(records, [&] {
        std::printf("%s, driver %s: %s, %s; medians of %u updates\n", device.info().name.c_str(),
                    device.info().driver.c_str(), field.configuration.c_str(), text(records.front(), "path").c_str(),
                    options.samples);
        print_views(records);
        print_recording(records);
        print_million_predictions(records);
    });
    measured.finish("", "an update");
}

}  // namespace

void add_bench_million(Command bench) {
    Command command = bench.add_subcommand(
        "million",
        "a frame of very many characters: time by what is drawn, memory, distinct poses, the CPU's part, and "
        "what GPUs would need");
    auto options = std::make_shared<MillionOptions>();
    add_field_options(command, options->field);
    command.add_option("--size", options->size, "size of the picture that the cameras take").capture_default_str();
    command.add_option("--blending", options->blending, "part of the characters that blend two clips")
        .check(finite())
        .check(range(0.0, 1.0))
        .capture_default_str();
    command.add_option("--capacity", options->capacity, "how many characters may have their own poses at a time")
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    command.add_option("--poses-per-second", options->poses_per_s, "shared poses per second of each clip")
        .check(finite())
        .check(range(0.01, 1000.0))
        .capture_default_str();
    command.add_option("--shared-pixels", options->shared_pixels, "by how many pixels a shared pose may be off")
        .check(finite())
        .check(range(0.0, 1000.0))
        .capture_default_str();
    add_path_option(command, options->path);
    add_samples_option(command, options->samples);
    add_json_flag(command, options->json);
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench million\n  throng bench million fox.glb --count 100000 --device native\n  throng "
        "bench "
        "million --json > million.jsonl");
    command.callback([options] { run_million(*options); });
}

}  // namespace throng::tools
