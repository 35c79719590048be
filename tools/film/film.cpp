// A frame depends on its number alone: whichever frames are drawn, all characters take the same steps from the first
// frame on, since steps that show nothing still advance time. So a film can be interrupted, or shared among machines,
// without a byte of difference.
#include "tools/film/film.h"

#include "base/crc64.h"
#include "base/failure.h"
#include "base/read_file.h"
#include "base/text.h"
#include "import/limits.h"
#include "tools/film/encode.h"
#include "tools/film/film_frames.h"
#include "tools/film/film_lock.h"
#include "tools/film/film_pace.h"
#include "tools/film/interruption.h"
#include "tools/cli/inputs.h"
#include "tools/cli/options.h"
#include "tools/cli/path_name.h"

#include <throng/version.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <functional>
#include <future>
#include <iostream>
#include <optional>

namespace throng::tools {
namespace {

namespace fs = std::filesystem;

// Which frames to draw, and where their files are.
struct FilmPlan {
    explicit FilmPlan(const RenderOptions& options)
        : size(parse_size(options.size)),
          range(parse_frames(options.frames)),
          shard(parse_shard(options.shard)),
          is_film(options.out.ends_with(".mp4")),
          out(options.out),
          folder(options.out + ".frames"),
          files(is_film ? folder / "%06d.png" : fs::path(options.out)) {
        if (is_film && (size.width % 2 != 0 || size.height % 2 != 0))
            throw UsageError("--size " + options.size + ": an .mp4 needs an even width and height");
    }

    bool is_shared() const { return shard.count > 1; }
    // The lock held by the process that draws all frames, or by those that draw shards.
    fs::path lock_path() const { return lock_path_of(""); }
    // The lock held by the process that draws this shard.
    fs::path shard_lock_path() const {
        return lock_path_of("." + std::to_string(shard.index) + "-of-" + std::to_string(shard.count));
    }
    fs::path lock_path_of(const std::string& part) const {
        return (is_film ? fs::path(out) : files.settings_path()).string() + part + ".lock";
    }

    RendererSettings size;
    FrameRange range;
    Shard shard;
    bool is_film;  // an .mp4
    std::string out;
    fs::path folder;  // of its frames
    FrameFiles files;
};

// The film, its frames of any shard, and their settings.
std::vector<fs::path> outs_of(const RenderOptions& options, const FilmPlan& plan) {
    std::vector<fs::path> outs{plan.files.settings_path()};
    if (plan.is_film) outs.push_back(options.out);
    for (const uint32_t frame : plan.range.frames()) outs.push_back(plan.files.path(frame));
    return outs;
}

// To notice that a file has changed since the last run.
std::string checksum(const std::string& path) {
    const std::string name = printable(fs::path(path).filename().string(), 120);
    const auto bytes = unwrap(as_result([&] { return read_file(path, gltf::kFileLimitBytes, name); }));
    char text[17];
    std::snprintf(text, sizeof(text), "%016" PRIx64, crc64(bytes));
    return text;
}

// All that a frame depends on, except what is known only with the device: its name, how it updates, and what draws.
nlohmann::json settings_of(const RenderOptions& options) {
    const SceneOptions& scene = options.scene;
    nlohmann::json files = nlohmann::json::array(), controllers = files, looks = files;
    for (const std::string& file : scene.files) files.push_back({fs::path(file).filename().string(), checksum(file)});
    for (const std::string& controller : controller_files(scene))
        controllers.push_back(controller.empty() ? "" : checksum(controller));
    for (const std::string& file : look_files(scene)) looks.push_back(file.empty() ? "" : checksum(file));
    return {{"throng", version()},
            {"files", files},
            {"controllers", controllers},
            {"looks", looks},
            {"clips", scene.clips},
            {"blends", scene.blends},
            {"weight", scene.weight},
            {"counts", counts_of(scene)},
            {"sizes", scene.sizes},
            {"placement", static_cast<int>(scene.formation)},
            {"spacing", scene.spacing},
            {"seed", scene.seed},
            {"steer", scene.steer},
            {"scan", scene.scan},
            {"path", static_cast<int>(scene.path)},
            {"error", scene.compile.error},
            {"camera", options.camera.path},
            {"eye", options.camera.eye},
            {"target", options.camera.target},
            {"size", options.size},
            {"time", options.time_s},
            {"fps", options.fps},
            {"skinning", static_cast<int>(options.skin_blend)},
            {"skin-once", options.skins_once},
            {"lod-pixels", options.lod_pixels},
            {"everything", options.everything},
            {"own-poses", scene.own_poses},
            {"skeletons", options.skeletons},
            {"bounds", options.bounds}};
}

// How the files' characters are updated: another device, or costs measured by `throng tune`, may choose another way,
// which rounds differently.
nlohmann::json updates_of(const Crowd& crowd, size_t file_count) {
    nlohmann::json updates = nlohmann::json::array();
    for (uint32_t group = 0; group < file_count; ++group) {
        const GroupPath path = *crowd.path(group);
        updates.push_back(path_name(path) + ", " + path.scan.method +
                          (path.is_native ? ", " + native_instruction_set() : ""));
    }
    return updates;
}

// Includes the instruction set, since pictures by different ones differ in their last bits.
std::string renderer_of(const Shot& shot) {
    const std::string name = renderer_name(shot.is_drawn_natively());
    return shot.is_drawn_natively() ? name + " " + native_instruction_set() : name;
}

struct Film {
    std::vector<FrameTimes> frames;  // that were drawn
    std::vector<uint32_t> drawn;     // in the last of them, of each level of detail
    std::string renderer;            // empty: none was drawn
};

std::string duration_text(double seconds) {
    const auto whole = static_cast<uint64_t>(seconds);
    if (whole < 100) return std::to_string(whole) + " s";
    if (whole < 100 * 60) return std::to_string(whole / 60) + " min";
    return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

constexpr size_t kMeasured = 3;  // after so many frames the time that the film will take is reported
constexpr double kLong_s = 600;  // but only if it is longer than this

void report_frame(size_t done, size_t all, double left_s) {
    if (done == kMeasured && left_s > kLong_s) {
        print_progress("");
        std::cerr << "throng: " << all << " frames will take about " << duration_text(left_s) << "\n";
    }
    print_progress("frame " + std::to_string(done) + " of " + std::to_string(all) + ", " + duration_text(left_s) +
                   " left");
}

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Compresses and writes a picture while the next one is drawn.
class PictureWriter {
public:
    // Throws a CommandError if the previous picture could not be written.
    void write(fs::path path, Picture picture) {
        finish();
        // If the system has no more threads, the work is deferred, and finish() does it
        written_ = std::async(
            std::launch::async | std::launch::deferred,
            [path = std::move(path), picture = std::move(picture)] { return write_png(path, picture); });
    }
    void finish() {
        if (written_.valid()) unwrap(written_.get());
    }

private:
    std::future<Result<void>> written_;
};

Film draw_frames(const Device& device, const RenderOptions& options, const FilmPlan& plan,
                 const std::vector<uint32_t>& frames, nlohmann::json settings, const Interruption& interruption) {
    Shot shot(device, options);
    Film film;
    const auto stop_before_first = [&] {
        if (interruption.is_asked_for() && film.frames.empty())
            throw CommandError("interrupted before the first of " + std::to_string(frames.size()) + " frames");
    };
    stop_before_first();
    settings["updates"] = updates_of(shot.crowd(), options.scene.files.size());
    settings["renderer"] = renderer_of(shot);
    std::error_code failure;
    if (plan.is_film) fs::create_directory(plan.folder, failure);
    if (failure) throw CommandError(plan.folder.string() + ": cannot be created: " + failure.message());
    plan.files.keep_settings(settings);
    uint32_t next = 0;  // the frame that the characters step to next
    const auto step_to = [&](uint32_t frame) { return frame == 0 ? options.time_s : 1 / options.fps; };
    PictureWriter writer;
    FilmPace pace;
    for (const uint32_t frame : frames) {
        for (; next < frame; ++next) {
            stop_before_first();
            pace.skipped(seconds_of([&] { shot.skip(step_to(next)); }));
        }
        stop_before_first();
        RenderResult result;
        pace.drew(seconds_of([&] {
            result = shot.draw(step_to(next), options.time_s + next / options.fps);
            writer.write(plan.files.path(frame), std::move(result.picture));
        }));
        ++next;
        if (film.frames.empty()) print_warnings(result.warnings);
        film.frames.push_back(shot.times());
        const size_t done = film.frames.size(), to_draw = frames.size() - done;
        report_frame(done, frames.size(), pace.left_s(to_draw, frames.back() + 1 - next - to_draw));
        if (!interruption.is_asked_for() || done == frames.size()) continue;
        writer.finish();
        print_progress("");
        throw CommandError("interrupted; " + std::to_string(done) + " of " + std::to_string(frames.size()) +
                           " frames are kept (" + plan.files.path(frame).string() +
                           " is the last): the same command draws the others");
    }
    writer.finish();
    film.drawn = shot.count_drawn();
    film.renderer = renderer_name(shot.is_drawn_natively());
    print_progress("");
    return film;
}

void print_film(const RenderOptions& options, const std::string& device, const Film& film, size_t asked) {
    const size_t rendered = film.frames.size();
    const FrameTimes times = median_of(film.frames);
    if (options.json)
        return print_json({{"out", options.out},
                           {"device", device},
                           {"frames", asked},
                           {"rendered", rendered},
                           {"kept", asked - rendered},
                           {"renderer", rendered > 0 ? nlohmann::json(film.renderer) : nlohmann::json()},
                           {"drawn", film.drawn},
                           {"stages_ms", rendered > 0 ? to_json(times) : nlohmann::json()}});
    std::printf("%s: %zu frames, %zu of them new\n", printable(options.out, std::string::npos).c_str(), asked,
                rendered);
    if (rendered == 0) return;
    std::printf("  medians of a frame on %s, renderer %s:\n", device.c_str(), film.renderer.c_str());
    print_times(times);
    std::printf("  the last:\n");
    print_drawn(film.drawn);
}

// The frames that are still to be drawn.
std::vector<uint32_t> missing_frames(const FilmPlan& plan, const Interruption& interruption) {
    const auto report = [&](size_t checked, size_t all) {
        if (interruption.is_asked_for())
            throw CommandError("interrupted while checking the " + std::to_string(all) +
                               " frames that exist: the same command continues from them");
        print_progress("checking frame " + std::to_string(checked + 1) + " of " + std::to_string(all));
    };
    std::vector<uint32_t> frames = plan.files.missing(plan.range, plan.shard, plan.size.width, plan.size.height,
                                                      report);
    print_progress("");
    return frames;
}

void encode(const RenderOptions& options, const FilmPlan& plan, const Interruption& interruption) {
    if (interruption.is_asked_for())
        throw CommandError("interrupted; all frames are kept in " + plan.folder.string() +
                           ": the same command makes the film from them");
    print_progress("encoding " + options.out);
    encode_film({plan.folder, plan.range.first, plan.range.end - plan.range.first, options.fps}, options.out);
    for (const uint32_t frame : plan.range.frames()) fs::remove(plan.files.path(frame));
    const auto files_left = std::distance(fs::directory_iterator(plan.folder), fs::directory_iterator());
    if (files_left == 1) fs::remove_all(plan.folder);  // only the settings are left
    print_progress("");
}

}  // namespace

void render_film(const RenderOptions& options) {
    const FilmPlan plan(options);
    protect_inputs(input_files(options.scene), outs_of(options, plan));
    if (plan.is_film && fs::exists(options.out) && !options.force)
        throw CommandError("--out " + options.out + ": the film exists already; --force draws it again");
    const bool encodes = plan.is_film && !plan.is_shared();
    if (encodes) check_ffmpeg();
    const auto asked = static_cast<size_t>(
        std::ranges::count_if(plan.range.frames(), [&](uint32_t frame) { return plan.shard.has(frame); }));
    nlohmann::json settings = settings_of(options);
    const std::string asked_for = settings.dump() + options.frames;
    const FilmLock lock(plan.lock_path(), plan.is_shared() ? FilmLock::Kind::kShared : FilmLock::Kind::kExclusive);
    std::optional<FilmLock> shard_lock;
    if (plan.is_shared()) shard_lock.emplace(plan.shard_lock_path());
    if (plan.is_film && fs::exists(options.out) && !options.force) {  // another process has drawn one meanwhile
        if (lock.text_before() == asked_for) return print_film(options, {}, {}, asked);
        throw CommandError("--out " + options.out +
                           ": another process has just drawn a different film there; --force replaces it");
    }
    const Interruption interruption;
    if (!plan.is_shared()) lock.write(asked_for);
    plan.files.check_settings(settings);
    const std::vector<uint32_t> frames = missing_frames(plan, interruption);
    Film film;
    std::string device_name;
    if (!frames.empty()) {
        const Device device = open_device(options.device);
        device_name = device.info().name;
        settings["device"] = device_name + ", " + device.info().driver;
        plan.files.check_settings(settings);
        film = draw_frames(device, options, plan, frames, settings, interruption);
    }
    if (encodes) encode(options, plan, interruption);
    print_film(options, device_name, film, asked);
}

}  // namespace throng::tools
