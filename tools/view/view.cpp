#include "tools/cli/command.h"
#include "tools/cli/program.h"
#include "tools/view/view.h"
#include "tools/view/viewer.h"

namespace throng::tools {
namespace {

void check_size(const RendererSettings& size) {
    constexpr uint32_t kMinWidth = 320, kMinHeight = 200, kMaxSide = 16384;
    if (size.width < kMinWidth || size.height < kMinHeight || size.width > kMaxSide || size.height > kMaxSide)
        throw UsageError("--size: a window must have from 320x200 to 16384x16384 pixels");
}

}  // namespace

void add_view(Command app) {
    Command command = app.add_subcommand(kView.command, kView.description);
    auto options = std::make_shared<view::ViewOptions>();
    auto size = std::make_shared<std::string>("1280x720");
    options->scene.usual_count = 100;
    add_scene_options(command, options->scene);
    add_camera_options(command, options->camera);
    command.add_option("--size", *size, "size of the window").capture_default_str();
    add_device_option(command, options->device);
    add_renderer_option(command, options->size.path);
    command.add_option("--after", options->frames, "quit after this many frames, each of 1/60 s however long it takes")
        .check(range(1u, 1'000'000u));
    command
        .add_option("--screenshot", options->screenshot,
                    "the .png file for screenshots; with --after, the last frame is saved to it, with its panels")
        .check(writable_file());
    command.add_option("--script", options->script, "input events, for tests (tools/view/script.h)").hide();
    command.add_option("--dump", options->dump, "the state at the end as JSON, for tests").hide();
    command.footer(
        "Examples:\n  throng view fox.glb\n  throng view fox.glb knight.glb --count 1000\n  throng view fox.glb "
        "--after 60 --screenshot fox.png\n  throng view fox.glb --renderer vulkan  # by the device's shaders, a "
        "software device's too");
    command.callback([options, size] {
        const RendererSettings parsed = parse_size(*size);
        options->size.width = parsed.width;
        options->size.height = parsed.height;
        check_size(options->size);
        view::Viewer(*options).run();
    });
}

}  // namespace throng::tools
