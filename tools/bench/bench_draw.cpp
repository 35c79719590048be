// throng bench draw: pictures by this machine's processor.
#include "bench/draw_bench.h"
#include "tools/bench/bench_commands.h"
#include "tools/bench/measured.h"
#include "tools/cli/command.h"
#include "tools/cli/inputs.h"
#include "tools/creatures/creature.h"
#include "tools/scene/camera_path.h"
#include "tools/scene/scatter.h"

#include <cstdio>
#include <filesystem>

namespace throng::tools {
namespace {

struct DrawBenchOptions {
    std::vector<std::string> files;
    uint32_t count = 1000, samples = 9;
    std::string size = "1920x1080", isa = "all", device = "llvmpipe";
    std::vector<uint32_t> threads;
    CameraOptions camera;
    uint64_t seed = 1;
    bool vulkan = false, json = false;
};

struct Shown {
    std::string name;
    std::vector<Character> characters;
    ScatterSettings places;
    CameraOptions camera;
    std::string size;
};

Character creature(const CreatureSettings& settings) {
    return unwrap(compile_character(unwrap(make_creature(settings)), {}));
}

// The crowd of `./run demo` without its controllers; small characters, of which the camera sees a part; one alone.
std::vector<std::function<Shown(uint64_t seed)>> generated() {
    return {[](uint64_t seed) {
                Shown shown{.name = "10,000 of three kinds",
                            .characters = {},
                            .places = {.counts = {300, 120, 9580},
                                       .heights = {5, 9, 1.8},
                                       .formation = Formation::kDisc,
                                       .seed = seed},
                            .camera = {.eye = {0, 16, 150}, .target = {0, 0, 75}},
                            .size = "1920x1080"};
                for (const CreatureKind kind : {CreatureKind::kDragon, CreatureKind::kWillow, CreatureKind::kWalker})
                    shown.characters.push_back(creature(creature_settings(kind)));
                return shown;
            },
            [](uint64_t seed) {
                return Shown{.name = "100,000 x 64 joints",
                             .characters = {creature({.joint_count = 64, .level_count = 16, .face_count = 500})},
                             .places = {.counts = {100'000}, .heights = {}, .seed = seed},
                             .camera = {.path = "low"},
                             .size = "1280x720"};
            },
            [](uint64_t seed) {
                return Shown{.name = "one dragon",
                             .characters = {creature(creature_settings(CreatureKind::kDragon))},
                             .places = {.counts = {1}, .heights = {}, .seed = seed},
                             .camera = {},
                             .size = "1920x1080"};
            }};
}

void print_draw_row(const Json& record) {
    std::printf("%-8s %7s  ", text(record, "variant").c_str(),
                record.contains("threads") ? record["threads"].dump().c_str() : "");
    if (print_untimed(record, "not measured", " dB alike", "alike_db")) return;
    print_columns(record, {{"%9.1f", "ms/median"},
                           {" %9.1f", "ms/p5"},
                           {" -%8.1f", "ms/p95"},
                           {" %8.1f", "mtriangles_per_s"},
                           {" %8.1f", "msamples_per_s"}});
    if (record.contains("times_faster"))
        print_columns(record, {{" %7.1f", "times_faster"}});
    else
        std::printf(" %7s", "");
    std::printf(" ");
    const Json parts = record.value("parts", Json::object());
    for (const auto& [part, part_ms] : parts.items()) std::printf(" %s %.1f,", part.c_str(), part_ms.get<double>());
    if (record.contains("alike_db")) print_columns(record, {{" %.1f dB", "alike_db"}});
    if (real(record, "host_samples") > 0)
        print_columns(record, {{", %g of", "host_samples"}, {" %g pictures by the host's clock", "samples"}});
    std::printf("\n");
}

void print_draw_table(std::span<const Json> records) {
    const Json& first = records.front();
    std::printf(
        "\n%s, %s, on %s: %.0f drawn, %.2f M vertices, %.2f M triangles; medians of %.0f pictures\n%-8s %7s  %9s %19s "
        "%8s %8s %7s  parts; likeness to the first\n",
        text(first, "configuration").c_str(), text(first, "size").c_str(), text(first, "device").c_str(),
        real(first, "drawn"), real(first, "vertices") * 1e-6, real(first, "triangles") * 1e-6, real(first, "samples"),
        "by", "threads", "ms", "5 % - 95 %", "Mtri/s", "Msam/s", "faster");
    for (const Json& record : records) print_draw_row(record);
}

void measure(const DrawBenchOptions& options, const Shown& shown, Measured& measured) {
    const Scatter field = scatter(shown.characters, shown.places);
    const RendererSettings picture = parse_size(shown.size);
    const auto camera_of = [&](const Crowd& crowd) {
        const CameraSubject subject{
            .bounds = main_bounds(crowd),
            .aspect_ratio = static_cast<float>(picture.width) / static_cast<float>(picture.height),
            .world_from_model = field.placement.front(),
            .model_bounds = {shown.characters.front().bounds_min, shown.characters.front().bounds_max}};
        return make_camera_path(shown.camera).at(0, subject);
    };
    const std::vector<Json> records = bench::measure_draw(
        {.configuration = shown.name,
         .make_crowd =
             [&](const Device& device) {
                 Crowd crowd = unwrap(
                     Crowd::create(device, {.groups = field.groups, .culling = Culling{.reduces_joints = true}}));
                 unwrap(crowd.set_placement(crowd.instances(), field.placement));
                 unwrap(crowd.set_playback(crowd.instances(), field.playback));
                 const CrowdView view = unwrap(
                     view_of(camera_of(crowd), picture.width, picture.height, main_bounds(crowd)));
                 unwrap(crowd.update(0, &view));
                 return crowd;
             },
         .camera_of = camera_of,
         .picture = picture,
         .isas = chosen_isas(options.isa),
         .threads = options.threads,
         .vulkan_device = options.vulkan ? std::optional(options.device) : std::nullopt},
        options.samples, print_progress);
    measured.add(records, [&] { print_draw_table(records); });
}

void run_draw(DrawBenchOptions options) {
    chosen_isas(options.isa);
    parse_size(options.size);
    options.threads = or_all_and_one(options.threads);
    Measured measured(options.json);
    if (options.files.empty()) {
        for (const auto& make : generated()) {
            print_progress("making creatures");
            measure(options, make(options.seed), measured);
        }
    } else {
        std::string names;
        for (const std::filesystem::path file : options.files)
            names += (names.empty() ? "" : ", ") + file.filename().string();
        Shown shown{.name = std::to_string(options.count) + " x " + names,
                    .characters = load_characters(options.files, {}),
                    .places = {.counts = deal_out(options.count, options.files.size()), .seed = options.seed},
                    .camera = options.camera,
                    .size = options.size};
        measure(options, shown, measured);
    }
    measured.finish("", "a picture");
}

}  // namespace

void add_bench_draw(Command bench) {
    Command command = bench.add_subcommand("draw",
                                           "pictures by the processor, with each of its instruction sets and numbers "
                                           "of threads: compared, then timed; needs no device");
    auto options = std::make_shared<DrawBenchOptions>();
    Option files = command.add_option("files", options->files,
                                      "glTF 2.0 or .throng files (default: generated creatures)");
    command.add_option("--count", options->count, "characters (with files)")
        .needs(files)
        .check(range(1u, 10'000'000u))
        .capture_default_str();
    command.add_option("--size", options->size, "size of the picture (with files)").needs(files).capture_default_str();
    // Generated crowds have cameras of their own
    for (Option camera : add_camera_options(command, options->camera)) camera.needs(files);
    Option vulkan = command.add_flag("--against-vulkan", options->vulkan,
                                     "also draw with lavapipe, Mesa's software device (mesa-vulkan-drivers)");
    command
        .add_option("--device", options->device,
                    "the device to use instead of lavapipe: its number or a part of its name")
        .needs(vulkan);
    add_threads_option(command, options->threads);
    add_isa_option(command, options->isa);
    add_samples_option(command, options->samples, "pictures timed");
    command.add_option("--seed", options->seed, "seed of places, clips, times and blends").capture_default_str();
    add_json_flag(command, options->json);
    command.footer(
        "Examples:\n  throng bench draw\n  throng bench draw --against-vulkan --samples 3\n  throng bench draw fox.glb "
        "--count 5000 --camera orbit --isa avx2 --threads 2");
    command.callback([options] { run_draw(*options); });
}

}  // namespace throng::tools
