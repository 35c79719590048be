#include "tools/camera_path.h"
#include "tools/command.h"
#include "tools/crowd_scene.h"

#include <algorithm>
#include <cstdio>

namespace throng::tools {
namespace {

struct RenderOptions {
    SceneOptions scene;
    CameraOptions camera;
    std::string size = "1920x1080", out, device;
    double time_s = 0;
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
    const CameraPath path = make_camera_path(options.camera);
    const Device device = open_device(options.device);
    CrowdScene scene(device, options.scene, !options.everything);
    scene.follow(path.followed_character());
    scene.start();
    const Camera camera = path.at(options.time_s, scene.subject(static_cast<float>(size.width) / static_cast<float>(size.height)));
    const CrowdView view = view_of(camera, size.width, size.height, scene.bounds());
    print_progress("animating");
    scene.step(static_cast<float>(options.time_s), options.everything ? nullptr : &view);
    print_progress("drawing");
    Renderer renderer = unwrap(Renderer::create(device, size));
    Crowd& crowd = scene.crowd();
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
    add_scene_options(command, options->scene);
    command.add_option("--size", options->size, "of the picture")->capture_default_str();
    command.add_option("--time", options->time_s, "seconds after the start; every character starts at a time of its own")->check(finite())->capture_default_str();
    add_camera_options(command, options->camera);
    add_out_option(command, options->out, "the .png file to write");
    add_device_option(command, options->device);
    command.add_flag("--everything", options->everything, "animate and draw all, at full detail, also what the picture does not show");
    command.add_flag("--json", options->json, "print the stage times as JSON");
    command.footer("Examples:\n  throng render fox.glb --out fox.png\n  throng render fox.glb knight.glb --count 1000 --size 1280x720 --time 2 --seed 3 --out crowd.png");
    command.callback([options] { run_render(*options); });
}

}  // namespace throng::tools
