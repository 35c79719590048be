#include "tools/view/viewer.h"

#include "tools/cli/command.h"
#include "tools/cli/drawn.h"
#include "tools/cli/inputs.h"
#include "tools/view/commands.h"
#include "tools/view/panels.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <optional>
#include <type_traits>
#include <utility>

namespace throng::view {
namespace {

using tools::CommandError;
using tools::unwrap;

constexpr float kLongestStep_s = 0.1f;  // after a pause of any kind the crowd goes on where it was
constexpr float kScriptedStep_s = 1 / 60.0f;

Cast make_cast(const tools::SceneOptions& options) {
    tools::SceneCast files(options);
    Cast cast(std::move(files.characters));
    cast.controllers = std::move(files.controllers);
    cast.looks = std::move(files.looks);
    if (!options.counts.empty()) cast.shares = options.counts;
    cast.heights = options.sizes;
    return cast;
}

SceneSettings make_settings(const tools::SceneOptions& options) {
    const std::vector<uint32_t> counts = tools::counts_of(options);
    const uint32_t count = std::accumulate(counts.begin(), counts.end(), 0u);
    if (count > kMaxCharacters)
        throw tools::UsageError(std::to_string(count) + " characters: a window shows at most " +
                                std::to_string(kMaxCharacters) + "; 'throng render' draws more");
    return {.count = count,
            .seed = options.seed,
            .formation = options.formation,
            .spacing = static_cast<float>(options.spacing),
            .scan = options.scan,
            .path = options.path};
}

// A software device takes half the time without multisampling; runs of a fixed number of frames keep it for pictures.
RendererSettings renderer_settings(const ViewOptions& options, const Device& device, VkFormat display_format) {
    RendererSettings settings = options.size;
    settings.blue_first = display_format == VK_FORMAT_B8G8R8A8_UNORM;
    if (device.info().type == "cpu" && !options.frames) settings.samples = 1;
    return settings;
}

// The first file name that does not exist yet.
std::string free_name() {
    for (int number = 1;; ++number) {
        const std::string name = "throng_" + std::to_string(number) + ".png";
        if (!std::filesystem::exists(name)) return name;
    }
}

// Throws a CommandError if an output is also an input, and a UsageError if the screenshot is not a picture.
std::vector<std::string> checked_inputs(const ViewOptions& options) {
    std::vector<std::string> inputs = tools::input_files(options.scene);
    inputs.push_back(options.script);
    tools::protect_inputs(inputs, {options.screenshot, options.dump});
    if (!options.screenshot.empty()) tools::check_png_name("--screenshot", options.screenshot);
    return inputs;
}

// What `make` returns for each character; empty where it throws a CommandError. Throws one of these errors if it fails
// for all characters.
template <class Make>
auto for_fitting(const std::vector<Character>& characters, const Make& make) {
    std::vector<std::optional<std::invoke_result_t<Make, const Character&>>> made(characters.size());
    std::optional<CommandError> why;
    for (size_t k = 0; k < characters.size(); ++k) {
        try {
            made[k] = make(characters[k]);
        } catch (const CommandError& error) {
            why = error;
        }
    }
    if (std::ranges::none_of(made, [](const auto& one) { return one.has_value(); })) throw *why;
    return made;
}

// Null if no instance is watched.
nlohmann::json controller_dump(const WatchedInstance* watched) {
    if (!watched) return nullptr;
    nlohmann::json leading = nlohmann::json::array();
    for (const std::span<const PlayedMotion> layer : watched->layers)
        leading.push_back(layer.empty() ? kNone : layer.front().motion);
    return {{"parameters", std::vector(watched->parameters.begin(), watched->parameters.end())}, {"leading", leading}};
}

}  // namespace

Viewer::Viewer(const ViewOptions& options)
    : options_(options),
      inputs_(checked_inputs(options)),
      window_(options.size.width, options.size.height),
      context_(window_, options.device),
      device_(unwrap(Device::adopt(context_.adopted()))),
      display_(context_),
      canvas_(context_, display_.format()),
      gui_(window_, context_, canvas_.render_pass()),
      renderer_(unwrap(Renderer::create(device_, renderer_settings(options, device_, display_.format())))),
      scene_(device_, make_cast(options.scene), make_settings(options.scene)) {
    if (!options.script.empty()) script_.emplace(options.script);
    state_.wanted = scene_.settings();
    state_.drawing = renderer_.options();
    state_.drawing.full_rate_pixels = 100;
    measured_.device = device_.info().name;
    measured_.is_software = device_.info().type == "cpu";
    const tools::CameraPath path = tools::make_camera_path(options.camera);
    if (!options.camera.eye.empty()) {
        state_.orbit.reset(path.at(0, {}));
        state_.resets_view = false;
    } else if (options.camera.path != "fit") {
        state_.camera = options.camera.path;
        if (path.follows() && path.followed_character() >= scene_.settings().count)
            throw tools::UsageError("--camera " + options.camera.path + ": there are " +
                                    std::to_string(scene_.settings().count) + " characters, numbered from 0");
    }
}

Viewer::~Viewer() { display_.abandon(); }

void Viewer::run() {
    window_.show();
    while (!is_done()) {
        if (state_.paused && !is_scripted())
            glfwWaitEventsTimeout(0.1);  // only input changes anything
        else
            glfwPollEvents();
        if (window_.size().width == 0 || window_.size().height == 0) {  // minimised
            glfwWaitEvents();
            continue;
        }
        take_dropped();
        take_loaded();
        show_frame();
        take_settings();
    }
    display_.finish();
    if (!options_.dump.empty()) write_dump();
}

bool Viewer::is_done() const {
    return window_.closes() || state_.closes || (options_.frames && frame_ >= *options_.frames) ||
           (script_ && script_->ends_by(frame_));
}

void Viewer::show_frame() {
    if (display_.is_stale(window_.size())) resize();
    gui_.take_input(display_.extent(), window_.presses().all());
    if (script_) shot_ = script_->play(frame_, window_).value_or("");
    if (is_scripted()) ImGui::GetIO().DeltaTime = kScriptedStep_s;
    ImGui::NewFrame();
    draw_panels();
    ImGui::Render();
    const bool is_last = options_.frames && frame_ + 1 == *options_.frames && !options_.screenshot.empty();
    if (std::exchange(state_.takes_screenshot, false) || is_last)
        shot_ = options_.screenshot.empty() ? free_name() : options_.screenshot;

    record();
    if (!shows_later()) display_.finish();
    if (!shot_.empty()) save_shot();
    measure();
    ++frame_;
}

void Viewer::resize() {
    display_.finish();
    display_.resize(window_.size());
    const VkExtent2D extent = display_.extent();
    canvas_.resize(extent);
    unwrap(renderer_.resize(extent.width, extent.height));
}

// A path leads the camera until the user takes over, and the user goes on from there.
void Viewer::move_camera(float aspect_ratio) {
    if (std::exchange(state_.resets_view, false)) state_.orbit.fit(scene_.bounds(), state_.free_part, aspect_ratio);
    state_.orbit.stand_on(scene_.bounds().min.y);
    if (state_.camera == kByHand) {
        path_.reset();
        return;
    }
    if (!path_ || path_name_ != state_.camera) {
        path_name_ = state_.camera;
        path_.emplace(path_name_);
        path_time_s_ = 0;
    }
    const PlacedBox followed = scene_.box_of(
        state_.selected.value_or(std::min(path_->followed_character(), scene_.settings().count - 1)));
    const float ratio_of_part = aspect_ratio * state_.free_part.width() / state_.free_part.height();
    state_.orbit.reset(path_->at(
        path_time_s_, {scene_.bounds(), ratio_of_part, followed.world_from_model, {followed.min, followed.max}}));
    path_time_s_ += double{ImGui::GetIO().DeltaTime};
}

void Viewer::draw_panels() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float aspect_ratio = display.x / display.y;
    if (const std::optional<Click> click = take_commands(state_, window_.presses().take()))
        state_.selected = scene_.pick(Projection(state_.picture_camera, aspect_ratio).ray(click->x, click->y));
    state_.free_part = state_.shows_panels ? part_without_panels() : PicturePart();
    move_camera(aspect_ratio);
    state_.picture_camera = camera_around(state_.orbit.camera(), state_.free_part, aspect_ratio);
    if (state_.selected) draw_selection(state_, scene_);
    if (state_.shows_panels) {
        draw_settings(state_, scene_, measured_);
        draw_graph(measured_);
        if (state_.selected) draw_inspector(state_, scene_, measured_);
    }
    if (state_.shows_keys) draw_keys(state_);
    draw_messages(state_);
}

void Viewer::record() {
    const float time_step_s = next_time_step();
    scene_.advance(time_step_s);
    DrawOptions drawing = state_.drawing;
    drawing.skeletons = scene_.settings().keeps_joints;  // a crowd that keeps joints is made only after this frame
    unwrap(renderer_.set_options(drawing));
    if (watches()) unwrap(scene_.crowd().watch(InstanceHandle{*state_.selected}));
    const Camera& camera = state_.picture_camera;
    const bool is_native = unwrap(scene_.crowd().path(0)).is_native;
    measured_.is_drawn_natively = is_native && renderer_.is_native();  // a recorded update is drawn by the device
    if (!measured_.is_drawn_natively) display_.finish();
    if (is_native) unwrap(renderer_.update(scene_.crowd(), time_step_s, camera));  // occlusion has no effect here
    display_.start();  // after the update, which uses the queue
    const VkCommandBuffer commands = display_.begin();
    unwrap(is_native ? renderer_.record_drawing(commands, scene_.crowd(), camera)
                     : renderer_.record(commands, scene_.crowd(), time_step_s, camera));
    canvas_.record_picture(commands, renderer_.picture());
    canvas_.record_panels(commands);
    if (!shot_.empty()) canvas_.record_read_back(commands);
    display_.end(canvas_);
}

// Whether this frame is shown while the next one is drawn. That is done only if the next one comes soon, and if it
// changes nothing that the device still reads for this one.
bool Viewer::shows_later() const {
    return measured_.is_drawn_natively && shot_.empty() && (is_scripted() || !state_.paused);
}

float Viewer::next_time_step() {
    const auto now = std::chrono::steady_clock::now();
    const float passed_s = std::chrono::duration<float>(now - std::exchange(last_frame_, now)).count();
    measured_.frame_ms += (passed_s * 1000 - measured_.frame_ms) * 0.1f;
    if (std::exchange(state_.steps, false)) return kScriptedStep_s;
    if (state_.paused) return 0;
    return (is_scripted() ? kScriptedStep_s : std::min(passed_s, kLongestStep_s)) * state_.time_factor;
}

void Viewer::measure() {
    if (const Result<StageTimes> times = scene_.crowd().stage_times())
        measured_.history.add(*times, renderer_.draw_ms());
    measured_.feedback = {};
    if (watches())
        for (Feedback& feedback : unwrap(scene_.crowd().feedback()))
            if (!feedback.watched.empty()) measured_.feedback = std::move(feedback);
    constexpr uint64_t kEvery = 15;  // frames: it waits for the device
    if (!scene_.settings().culls) return measured_.drawn.assign(1, scene_.settings().count);
    if (frame_ % kEvery != 0) return;
    measured_.drawn = tools::count_by_lod(unwrap(scene_.crowd().read_drawn()));
}

void Viewer::save_shot() {
    try {
        tools::protect_inputs(inputs_, {shot_});
        unwrap(write_png(shot_, canvas_.read()));
        if (!is_scripted()) state_.say("saved " + shot_.string());
    } catch (const CommandError& error) {
        if (is_scripted()) throw;
        state_.complain(error.what());
    }
    shot_.clear();
}

void Viewer::take_dropped() {
    std::vector<std::string> files, json;
    for (std::string& file : window_.take_dropped()) {
        inputs_.push_back(file);
        (file.ends_with(".json") ? json : files).push_back(std::move(file));
    }
    if (!files.empty()) dropped_json_.clear();  // the new characters replace those that it was meant for
    dropped_json_.insert(dropped_json_.end(), json.begin(), json.end());
    if (files.empty()) return;
    reading_ = "reading " + std::filesystem::path(files.front()).filename().string() + (files.size() > 1 ? " …" : "");
    state_.message.clear();  // about what was there before
    loader_.start(std::move(files), options_.scene.compile);
}

// If a file or a setting is wrong, the window and stderr say so, and the scene stays.
void Viewer::take_loaded() {
    state_.progress.clear();
    try {
        if (std::optional<std::vector<Character>> characters = loader_.take(is_scripted())) {
            scene_.set_cast(Cast(std::move(*characters)));
            measured_.feedback = {};
            state_.selected.reset();
            state_.resets_view = true;
        }
    } catch (const CommandError& error) {
        dropped_json_.clear();  // meant for characters that have not come
        return state_.complain(error.what());
    }
    if (loader_.is_busy()) {
        const int percent = static_cast<int>(100 * loader_.part_done());
        state_.progress = reading_ + ", " + std::to_string(percent) + " %";
        return;
    }
    for (const std::string& file : std::exchange(dropped_json_, {})) {
        try {
            use_json(file);
        } catch (const CommandError& error) {
            state_.complain(error.what());
        }
    }
}

// Uses a controller or looks for the characters that it fits.
void Viewer::use_json(const std::string& file) {
    const std::vector<Character>& characters = scene_.cast().characters;
    if (tools::is_looks_file(file)) {
        scene_.set_looks(
            for_fitting(characters, [&](const Character& character) { return tools::Looks(file, character); }));
    } else {
        const Controller controller = unwrap(load_controller(file));
        scene_.set_controllers(for_fitting(characters, [&](const Character& character) {
            unwrap(check_controller(controller, character));
            return controller;
        }));
    }
    measured_.feedback = {};
}

void Viewer::take_settings() {
    state_.wanted.keeps_joints = state_.drawing.skeletons;
    if (state_.wanted == scene_.settings()) return;
    const bool moves = state_.wanted.count != scene_.settings().count ||
                       state_.wanted.formation != scene_.settings().formation;
    try {
        const auto selected = state_.selected ? std::optional(scene_.place_of(*state_.selected)) : std::nullopt;
        scene_.set_settings(state_.wanted);
        if (selected) state_.selected = scene_.instance_at(*selected);
        measured_.feedback = {};
        if (moves) state_.resets_view = true;
    } catch (const CommandError& error) {
        state_.complain(error.what());
    }
    state_.wanted = scene_.settings();
    state_.drawing.skeletons = state_.wanted.keeps_joints;
}

void Viewer::write_dump() const {
    const Camera camera = state_.orbit.camera();
    nlohmann::json files = nlohmann::json::array();
    for (const Character& character : scene_.cast().characters) files.push_back(character.name);
    const nlohmann::json dump{{"frames", frame_},
                              {"files", files},
                              {"count", scene_.settings().count},
                              {"seed", scene_.settings().seed},
                              {"scan", scene_.settings().scan},
                              {"culls", scene_.settings().culls},
                              {"skips_updates", scene_.settings().skips_updates},
                              {"occlusion", state_.drawing.occlusion},
                              {"skeletons", scene_.settings().keeps_joints},
                              {"directs", scene_.directs()},
                              {"controller", controller_dump(measured_.watched())},
                              {"selected", state_.selected ? nlohmann::json(*state_.selected) : nlohmann::json()},
                              {"paused", state_.paused},
                              {"shows_keys", state_.shows_keys},
                              {"message", state_.message},
                              {"size", {display_.extent().width, display_.extent().height}},
                              {"eye", {camera.eye.x, camera.eye.y, camera.eye.z}},
                              {"target", {camera.target.x, camera.target.y, camera.target.z}},
                              {"drawn", measured_.drawn}};
    const std::string text = dump.dump(2) + "\n";
    tools::write_file(options_.dump, std::as_bytes(std::span(text)));
}

}  // namespace throng::view
