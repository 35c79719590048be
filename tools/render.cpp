#include "tools/command.h"
#include "tools/scatter.h"

#include <cstdio>

namespace throng::tools {
namespace {

struct RenderOptions {
    std::vector<std::string> files;
    std::string size = "1920x1080", out, scan = "auto", device;
    uint32_t count = 1;
    double time_s = 0;
    uint64_t seed = 1;
    bool json = false;
};

RendererSettings parse_size(const std::string& text) {
    RendererSettings settings;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &settings.width, &settings.height, &rest) != 2 || text.find('-') != std::string::npos ||
        settings.width == 0 || settings.height == 0)
        throw CommandError("--size " + text + ": give it as WIDTHxHEIGHT, for example 1920x1080");
    return settings;
}

void print_times(const RenderOptions& options, const Device& device, const Crowd& crowd, const StageTimes& times, double draw_ms) {
    const std::string_view scan = crowd.scan_method(0);
    if (options.json)
        return print_json({{"out", options.out}, {"device", device.info().name}, {"driver", device.info().driver}, {"count", crowd.instance_count()}, {"scan", scan},
                           {"stages_ms", {{"control", times.control}, {"sample", times.sample}, {"blend", times.blend}, {"scan", times.scan}, {"bind", times.bind}, {"skin+draw", draw_ms}}}});
    std::printf("%s: %u characters on %s\n", options.out.c_str(), crowd.instance_count(), device.info().name.c_str());
    std::printf("  control %.2f ms, sample %.2f ms, blend %.2f ms, scan %.2f ms (%.*s), bind %.2f ms, skin+draw %.2f ms\n", times.control, times.sample, times.blend, times.scan,
                static_cast<int>(scan.size()), scan.data(), times.bind, draw_ms);
}

void run_render(const RenderOptions& options) {
    const RendererSettings size = parse_size(options.size);
    const std::vector<Character> characters = load_characters(options.files);
    const Device device = open_device(options.device);
    print_progress("placing " + std::to_string(options.count) + " characters");
    const Scatter field = scatter(characters, options.count, options.seed);
    Crowd crowd = unwrap(Crowd::create(device, {.groups = field.groups, .scan = options.scan}));
    unwrap(crowd.set_playback(0, field.playback));
    unwrap(crowd.set_placement(0, field.placement));
    print_progress("animating");
    unwrap(crowd.update(0));  // compiles the kernels, so that the next one is timed without that
    unwrap(crowd.update(static_cast<float>(options.time_s)));
    print_progress("drawing");
    Renderer renderer = unwrap(Renderer::create(device, size));
    const Camera camera = fit_camera(world_bounds(crowd), static_cast<float>(size.width) / static_cast<float>(size.height));
    const RenderResult result = unwrap(renderer.render(crowd, camera));
    unwrap(write_png(options.out, result.picture));
    print_progress("");
    const Result<StageTimes> times = crowd.stage_times();
    print_times(options, device, crowd, times ? *times : StageTimes{}, result.draw_ms);
}

}  // namespace

void add_render(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("render", "draw a crowd of one or several files to a picture");
    auto options = std::make_shared<RenderOptions>();
    command.add_option("files", options->files, "glTF 2.0 files; several are mixed, scaled to one size")->required();
    command.add_option("--count", options->count, "characters in all")->check(CLI::Range(1u, 10'000'000u))->capture_default_str();
    command.add_option("--size", options->size, "of the picture")->capture_default_str();
    command.add_option("--time", options->time_s, "seconds after the start; every character starts at a time of its own")->capture_default_str();
    command.add_option("--seed", options->seed, "of clips, times, blends and places")->capture_default_str();
    command.add_option("--out", options->out, "the .png file to write")->required();
    add_scan_option(command, options->scan);
    add_device_option(command, options->device);
    command.add_flag("--json", options->json, "print the stage times as JSON");
    command.footer("Examples:\n  throng render fox.glb --out fox.png\n  throng render fox.glb knight.glb --count 1000 --size 1280x720 --time 2 --seed 3 --out crowd.png");
    command.callback([options] { run_render(*options); });
}

}  // namespace throng::tools
