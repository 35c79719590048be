#include "tools/command.h"
#include "tools/scatter.h"

#include <algorithm>
#include <cstdio>

namespace throng::tools {
namespace {

struct RenderOptions {
    std::vector<std::string> files;
    std::string size = "1920x1080", out, scan = "auto", device;
    CompileSettings compile;
    uint32_t count = 1;
    double time_s = 0;
    uint64_t seed = 1;
    bool everything = false, json = false;
};

RendererSettings parse_size(const std::string& text) {
    const size_t x = std::min(text.find('x'), text.size());
    const auto width = parse_number(text.substr(0, x)), height = parse_number(text.substr(std::min(x + 1, text.size())));
    if (!width || !height || *width == 0 || *height == 0) throw CommandError("--size " + text + ": give it as WIDTHxHEIGHT, for example 1920x1080");
    return {.width = *width, .height = *height};
}

// Of each level of detail, the finest first; of a crowd that does not cull, all.
std::vector<uint32_t> count_drawn(Crowd& crowd, bool everything) {
    if (everything) return {crowd.instance_count()};
    std::vector<uint32_t> counts;
    const std::vector<DrawnInstance> drawn = unwrap(crowd.read_drawn());
    for (const DrawnInstance& one : drawn) {
        counts.resize(std::max<size_t>(counts.size(), one.detail + 1));
        ++counts[one.detail];
    }
    return counts;
}

void print_times(const RenderOptions& options, const Device& device, const Crowd& crowd, const std::vector<uint32_t>& drawn, const StageTimes& times, double draw_ms) {
    const std::string scan = crowd.scan(0).method;
    if (options.json) {
        nlohmann::json stages{{"skin+draw", draw_ms}};
        for (const auto& [name, member] : kStages) stages[name] = times.*member;
        return print_json({{"out", options.out}, {"device", device.info().name}, {"driver", device.info().driver}, {"count", crowd.instance_count()},
                           {"drawn", drawn}, {"scan", scan}, {"stages_ms", stages}});
    }
    std::printf("%s: %u characters on %s, scan by %s\n", options.out.c_str(), crowd.instance_count(), device.info().name.c_str(), scan.c_str());
    std::printf("  drawn by level of detail:");
    for (const uint32_t count : drawn) std::printf(" %u", count);
    std::printf("\n ");
    for (const auto& [name, member] : kStages) std::printf(" %s %.2f ms,", name, times.*member);
    std::printf(" skin+draw %.2f ms\n", draw_ms);
}

void run_render(const RenderOptions& options) {
    const RendererSettings size = parse_size(options.size);
    const std::vector<Character> characters = load_characters(options.files, options.compile);
    const Device device = open_device(options.device);
    print_progress("placing " + std::to_string(options.count) + " characters");
    const Scatter field = scatter(characters, options.count, options.seed);
    Crowd crowd = unwrap(Crowd::create(device, {.groups = field.groups, .scan = options.scan, .culls = !options.everything}));
    unwrap(crowd.set_playback(0, field.playback));
    unwrap(crowd.set_placement(0, field.placement));
    const Bounds bounds = world_bounds(crowd);
    const Camera camera = fit_camera(bounds, static_cast<float>(size.width) / static_cast<float>(size.height));
    const CrowdView view = view_of(camera, size.width, size.height, bounds);
    print_progress("animating");
    unwrap(crowd.update(0));  // compiles the kernels, so that the next one is timed without that
    unwrap(crowd.update(static_cast<float>(options.time_s), options.everything ? nullptr : &view));
    print_progress("drawing");
    Renderer renderer = unwrap(Renderer::create(device, size));
    const RenderResult result = unwrap(renderer.render(crowd, camera));
    unwrap(write_png(options.out, result.picture));
    print_progress("");
    print_warnings(result.warnings);
    const Result<StageTimes> times = crowd.stage_times();
    print_times(options, device, crowd, count_drawn(crowd, options.everything), times ? *times : StageTimes{}, result.draw_ms);
}

}  // namespace

void add_render(CLI::App& app) {
    CLI::App& command = *app.add_subcommand("render", "draw a crowd of one or several files to a picture");
    auto options = std::make_shared<RenderOptions>();
    command.add_option("files", options->files, "glTF 2.0 or .throng files; several are mixed, scaled to one size")->required();
    command.add_option("--count", options->count, "characters in all")->check(CLI::Range(1u, 10'000'000u))->capture_default_str();
    command.add_option("--size", options->size, "of the picture")->capture_default_str();
    command.add_option("--time", options->time_s, "seconds after the start; every character starts at a time of its own")->check(finite())->capture_default_str();
    command.add_option("--seed", options->seed, "of clips, times, blends and places")->capture_default_str();
    add_out_option(command, options->out, "the .png file to write");
    add_scan_option(command, options->scan);
    add_error_option(command, options->compile);
    add_device_option(command, options->device);
    command.add_flag("--everything", options->everything, "animate and draw all, at full detail, also what the picture does not show");
    command.add_flag("--json", options->json, "print the stage times as JSON");
    command.footer("Examples:\n  throng render fox.glb --out fox.png\n  throng render fox.glb knight.glb --count 1000 --size 1280x720 --time 2 --seed 3 --out crowd.png");
    command.callback([options] { run_render(*options); });
}

}  // namespace throng::tools
