#include "base/text.h"
#include "tools/film/film.h"
#include "tools/cli/inputs.h"
#include "tools/cli/options.h"
#include "tools/cli/path_name.h"
#include "tools/commands.h"
#include "tools/film/shot.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <map>

namespace throng::tools {
namespace {

// How many characters each file has, and how they are updated.
nlohmann::json files_of(const RenderOptions& options, const Crowd& crowd) {
    nlohmann::json files = nlohmann::json::array();
    for (uint32_t group = 0; group < options.scene.files.size(); ++group) {
        const GroupPath path = *crowd.path(group);
        files.push_back({{"file", options.scene.files[group]},
                         {"count", crowd.instances(group)->size()},
                         {"path", path_name(path)},
                         {"scan", path.scan.method}});
    }
    return files;
}

void print_times(const RenderOptions& options, const Device& device, Shot& shot) {
    const nlohmann::json files = files_of(options, shot.crowd());
    const std::string renderer = renderer_name(shot.is_drawn_natively());
    const uint32_t count = shot.crowd().instance_count();
    if (options.json)
        return print_json({{"out", options.out},
                           {"device", device.info().name},
                           {"driver", device.info().driver},
                           {"count", count},
                           {"drawn", shot.count_drawn()},
                           {"files", files},
                           {"renderer", renderer},
                           {"stages_ms", to_json(shot.times())}});
    std::printf("%s: %u characters on %s, renderer %s\n", printable(options.out, std::string::npos).c_str(), count,
                device.info().name.c_str(), renderer.c_str());
    for (const nlohmann::json& file : files)
        std::printf("  %u of %s, %s, scan by %s\n", file["count"].get<uint32_t>(),
                    printable(file["file"].get<std::string>(), std::string::npos).c_str(),
                    file["path"].get<std::string>().c_str(), file["scan"].get<std::string>().c_str());
    print_drawn(shot.count_drawn());
    print_times(shot.times());
}

void run_render(const RenderOptions& options) {
    if (!options.frames.empty()) return render_film(options);
    if (options.out.ends_with(".mp4"))
        throw UsageError("--out " + options.out + ": a film needs --frames, for example 0:240");
    protect_inputs(input_files(options.scene), {options.out});
    check_png_name("--out", options.out);
    const Device device = open_device(options.device);
    Shot shot(device, options);
    print_progress("drawing");
    const RenderResult result = shot.draw(options.time_s, options.time_s);
    unwrap(write_png(options.out, result.picture));
    print_progress("");
    print_warnings(result.warnings);
    print_times(options, device, shot);
}

}  // namespace

void add_render(Command app) {
    Command command = app.add_subcommand("render", "draw a crowd of one or several files to a picture or a film");
    RenderOptions& options = command.options_of(run_render);
    add_scene_options(command, options.scene);
    add_clip_options(command, options.scene);
    command.add_option("--size", options.size, "size of the picture").capture_default_str();
    command
        .add_option("--time", options.time_s, "seconds after the start; each character starts elsewhere in its clips")
        .check(finite())
        .capture_default_str();
    add_camera_options(command, options.camera);
    command.add_flag("--steer", options.scene.steer,
                     "each character walks to the place of another of its kind, and avoids the others; a controller's "
                     "parameter \"speed\" is set to how fast it walks. Use it with --spacing 2 or more");
    Option frames = command.add_option(
        "--frames", options.frames, "FIRST:END: a film, of frames FIRST to END - 1; frame 0 is the picture at --time");
    command.add_option("--fps", options.fps, "frames a second")
        .needs(frames)
        .check(finite())
        .check(range(0.1, 1000.0))
        .capture_default_str();
    command
        .add_option("--shard", options.shard,
                    "I/N: only the frames whose number divided by N leaves I; the same bytes as without")
        .needs(frames);
    command.add_flag("--force", options.force, "draw the .mp4 again if it exists already").needs(frames);
    add_out_option(command, options.out,
                   "the .png file to write; with --frames a film.mp4, or pictures such as frame_%04d.png. Whole frames "
                   "of an interrupted run are kept (those of an .mp4 in a folder .mp4.frames, "
                   "until the film is there)");
    add_device_option(command, options.device);
    add_renderer_option(command, options.renderer);
    Option lod = command
                     .add_option("--lod-pixels", options.lod_pixels,
                                 "by how many pixels coarser levels of detail may be off where they are drawn")
                     .check(finite())
                     .check(range(0.01, 1000.0))
                     .capture_default_str();
    Option own_poses = command
                           .add_option("--own-poses", options.scene.own_poses,
                                       "how many characters of each file may have their own skin matrices at a time; "
                                       "those far away share poses that are off by at most a pixel (default: all)")
                           .check(range(1u, 10'000'000u));
    command
        .add_flag("--everything", options.everything,
                  "animate and draw all characters at full detail, even those that the picture does not show")
        .excludes(lod)
        .excludes(own_poses);
    const std::map<std::string, SkinBlend> blends{{"linear", SkinBlend::kLinear},
                                                  {"dual-quaternion", SkinBlend::kDualQuaternion}};
    command.add_choice("--skinning", options.skin_blend, blends,
                       "linear, or dual-quaternion, by which twisting joints keep their girth");
    command
        .add_flag(
            "--skin-once", options.skins_once,
            "skin vertices once a frame, in compute, instead of once for the shadows and once for the picture (the "
            "native renderer always does so)")
        .excludes(own_poses);
    command
        .add_flag("--skeletons", options.skeletons,
                  "draw a line from each joint to its parent, over everything, coloured by level")
        .excludes(own_poses);
    command.add_flag("--bounds", options.bounds, "draw the boxes that culling tests");
    command.add_flag("--json", options.json, "print the stage times as JSON");
    command.footer(
        "Examples:\n  throng render fox.glb --out fox.png\n  throng render fox.glb knight.glb --count 1000 --size "
        "1280x720 --time 2 --seed 3 --out crowd.png\n"
        "  throng render fox.glb --clip Run --count 50 --out run.png\n"
        "  throng render fox.glb --clip Walk --blend Run --weight 0.25 --frames 0:120 --out faster.mp4\n"
        "  throng render fox.glb --device native --out fox.png    # by the processor, without Vulkan\n"
        "  throng render fox.glb --renderer vulkan --out fox.png  # by the device's shaders, a software device's too\n"
        "  throng render walker.glb --count 500 --placement disc --camera orbit:seconds=10 --frames 0:300 --out "
        "orbit.mp4\n"
        "  throng render walker.glb --count 60 --spacing 2.5 --steer --controller walker_steer.json --eye 0,14,12 "
        "--target 0,0,0 --frames 0:600 --out walk.mp4\n"
        "  throng render dragon.glb walker.glb --sizes 4,1.8 --counts 20,900 --controller walker.glb=walker.json "
        "--camera follow:character=17 --frames 0:240 --shard 0/4 --out frame_%04d.png");
}

}  // namespace throng::tools
