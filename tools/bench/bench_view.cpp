// throng bench view: what an update for a view leaves out, and gains.
#include "bench/view_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/generated_field.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"
#include "tools/scene/camera_path.h"

#include <cmath>
#include <cstdio>

namespace throng::tools {
namespace {

struct ViewOptions {
    FieldOptions field{.count = 100'000};
    std::string size = "1280x720", device;
    uint32_t samples = 15;
    float lod_pixels = 1, full_rate_pixels = 100;
    CameraOptions camera{.path = "low"};
    UpdatePath path = UpdatePath::kAuto;
    bool json = false;
};

void print_view_row(const Json& record) {
    std::printf("%-18s ", text(record, "variant").c_str());
    const std::string pixels = record.contains("max_pixels") ? ", and " + record["max_pixels"].dump() + " pixels" : "";
    const bool are_finite = pixels.empty() || !std::isnan(bench::number(record, "max_pixels"));
    if (print_untimed(record, "not measured", " of the size off" + pixels, are_finite ? "max_error" : "max_pixels"))
        return;
    print_columns(record, {{"%9.3f", "ms/median"}, {" %9.3f", "ms/p5"}, {" -%8.3f ", "ms/p95"}});
    if (record.contains("times_faster"))
        print_columns(record, {{"%7.2f ", "times_faster"}});
    else
        std::printf("%7s ", "");  // there is no time of everything to compare with
    const Json stages = record.value("stages", Json::object());
    for (const auto& [stage, stage_ms] : stages.items())
        std::printf(" %s %.2f,", stage.c_str(), stage_ms.get<double>());
    std::printf(" drawn");
    for (const Json& count : record["drawn"]) std::printf(" %u", count.get<uint32_t>());
    print_columns(record, {{", error %.1e", "max_error"}});
    if (record.contains("max_pixels")) print_columns(record, {{" and %.2f pixels", "max_pixels"}});
    std::printf("\n");
}

void run_view(const ViewOptions& options) {
    const Device device = open_device(options.device);
    const RendererSettings size = parse_size(options.size);
    print_progress("compiling");
    const Field field = make_field(options.field);
    const auto view = [&](const Bounds& bounds) {
        const CameraSubject subject{.bounds = bounds,
                                    .aspect_ratio = static_cast<float>(size.width) / static_cast<float>(size.height),
                                    .world_from_model = field.placement.front(),
                                    .model_bounds = {field.character.bounds_min, field.character.bounds_max}};
        return unwrap(view_of(make_camera_path(options.camera).at(0, subject), size.width, size.height, bounds,
                              {.lod_pixels = options.lod_pixels, .full_rate_pixels = options.full_rate_pixels}));
    };
    const std::vector<Json> records = bench::measure_view(device,
                                                          {.configuration = field.configuration,
                                                           .character = &field.character,
                                                           .playback = field.playback,
                                                           .placement = field.placement,
                                                           .path = options.path,
                                                           .view_of = view},
                                                          options.samples, print_progress);
    Measured measured(options.json);
    measured.add(records, [&] {
        std::printf(
            "%s, driver %s: %s, %s; medians of %u updates\n%-18s %9s %19s %7s  stages, characters drawn of each level "
            "of "
            "detail\n",
            device.info().name.c_str(), device.info().driver.c_str(), field.configuration.c_str(),
            text(records.front(), "path").c_str(), options.samples, "variant", "ms", "5 % - 95 %", "faster");
        for (const Json& record : records) print_view_row(record);
    });
    measured.finish("", "an update");
}

}  // namespace

void add_bench_view(Command bench) {
    Command command = bench.add_subcommand("view",
                                           "updates of what a camera sees: culled, with fewer joints, less often where "
                                           "small; checked, then timed beside an update of everything");
    auto options = std::make_shared<ViewOptions>();
    add_field_options(command, options->field);
    command.add_option("--size", options->size, "size of the picture that the camera takes").capture_default_str();
    add_camera_options(command, options->camera);
    command
        .add_option("--lod-pixels", options->lod_pixels,
                    "by how many pixels coarser levels of detail, and their joints, may be off")
        .check(finite())
        .check(range(0.01, 1000.0))
        .capture_default_str();
    command
        .add_option("--full-rate", options->full_rate_pixels,
                    "pixels: smaller characters are animated less often, in the last variant")
        .check(finite())
        .check(range(0.0, 1e30))
        .capture_default_str();
    add_path_option(command, options->path);
    add_samples_option(command, options->samples);
    add_json_flag(command, options->json);
    add_device_option(command, options->device);
    command.footer(
        "Examples:\n  throng bench view\n  throng bench view fox.glb --count 10000 --camera orbit\n  throng bench view "
        "--json > view.jsonl");
    command.callback([options] { run_view(*options); });
}

}  // namespace throng::tools
