#include "tools/scene/crowd_scene.h"

#include "json/known_names.h"
#include "tools/scene/agents.h"
#include "tools/cli/options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <span>

namespace throng::tools {
namespace {

constexpr uint32_t kMaxCharacters = 10'000'000;

void check_length(const char* option, size_t given, size_t files) {
    if (given != 0 && given != files)
        throw UsageError(std::string(option) + ": " + std::to_string(given) + " numbers for " + std::to_string(files) +
                         " files; give one for each");
}

bool is_called(const std::string& file, const std::string& name) {
    return file == name || std::filesystem::path(file).filename() == name;
}

// Which of the files has this name: with its folder, or without it if that is unambiguous.
size_t file_named(const std::vector<std::string>& files, const std::string& name, const std::string& option) {
    size_t found = files.size(), count = 0;
    KnownNames known("file");
    for (size_t i = 0; i < files.size(); ++i) {
        if (files[i] == name) return i;
        if (is_called(files[i], name)) found = i, ++count;
        known.add(files[i]);
    }
    if (count == 1) return found;
    if (count > 1) throw UsageError(option + ": several of the files are called '" + name + "'; name its folder too");
    throw UsageError(option + ": " + known.unknown(name));
}

// The '=' of "FILE=VALUE". Names may contain '=' too: takes the last one that follows the name of a file, or else the
// first.
size_t equals_sign(const std::vector<std::string>& files, const std::string& one) {
    size_t found = one.find('=');
    for (size_t at = found; at != std::string::npos; at = one.find('=', at + 1)) {
        const std::string name = one.substr(0, at);
        if (std::ranges::any_of(files, [&](const std::string& file) { return is_called(file, name); })) found = at;
    }
    return found;
}

// The values of an option: "VALUE" for all files, "FILE=VALUE" for one. Empty where there is none.
struct GivenValues {
    std::string of_all;
    std::vector<std::string> of_one;  // [files]

    std::vector<std::string> of_each() const {
        std::vector<std::string> values = of_one;
        for (std::string& value : values)
            if (value.empty()) value = of_all;
        return values;
    }
};

GivenValues given_values(const std::vector<std::string>& files, const std::vector<std::string>& given,
                         const std::string& option) {
    GivenValues values{.of_all = {}, .of_one = std::vector<std::string>(files.size())};
    const auto set = [&](std::string& value, const std::string& one, const std::string& given_value) {
        if (one.empty()) throw UsageError(option + ": the value is empty");
        if (given_value.empty()) throw UsageError(option + " " + one + ": nothing is given after '='");
        if (!value.empty()) throw UsageError(option + " " + one + ": '" + value + "' is given already");
        value = given_value;
    };
    for (const std::string& one : given) {
        const size_t equals = equals_sign(files, one);
        if (equals == std::string::npos) {
            set(values.of_all, one, one);
            continue;
        }
        set(values.of_one[file_named(files, one.substr(0, equals), option + " " + one)], one, one.substr(equals + 1));
    }
    return values;
}

// The clips that the characters of each file are to play. Empty: random ones as the first, none as the second.
struct WantedClips {
    // Throws UsageError if a clip that was asked for would not be played. A second clip that is given for all files is
    // played by the files that have a first.
    explicit WantedClips(const SceneOptions& options)
        : first(given_values(options.files, options.clips, "--clip").of_each()) {
        const GivenValues blends = given_values(options.files, options.blends, "--blend");
        second = blends.of_each();
        const std::vector<std::string> controller_of = controller_files(options);
        for (size_t k = 0; k < options.files.size(); ++k) {
            if (!controller_of[k].empty() && !first[k].empty())
                throw UsageError("--clip " + first[k] + ": " + options.files[k] +
                                 " has a controller, which chooses the clips");
            if (!blends.of_one[k].empty() && first[k].empty())
                throw UsageError("--blend " + blends.of_one[k] + ": " + options.files[k] +
                                 " has no --clip to blend it with");
        }
    }

    std::vector<std::string> first, second;  // [files]
};

// Replaces the random clips by those that were asked for; their times stay.
void choose_clips(std::span<Playback> playback, const Character& character, const std::string& clip,
                  const std::string& blend, double weight) {
    if (clip.empty()) return;
    const uint32_t first = find_clip(character, clip), second = blend.empty() ? kNone : find_clip(character, blend);
    for (Playback& one : playback) {
        one.first.clip = first;
        one.second.clip = second;
        one.weight = blend.empty() ? 1 : static_cast<float>(weight);
    }
}

}  // namespace

void add_scene_options(Command app, SceneOptions& options) {
    const std::map<std::string, Formation> formations{{"grid", Formation::kGrid},
                                                      {"disc", Formation::kDisc},
                                                      {"path", Formation::kPath},
                                                      {"random", Formation::kRandom}};
    app.add_option("files", options.files,
                   "glTF 2.0 or .throng files; several are mixed, scaled to one size unless --sizes says otherwise")
        .required();
    Option count = app.add_option("--count", options.count, "characters in all, at least one of each file")
                       .check(range(1u, kMaxCharacters))
                       .default_str(std::to_string(options.usual_count));
    app.add_option("--counts", options.counts,
                   "characters of each file, comma-separated (default: --count, dealt out evenly)")
        .delimiter(',')
        .excludes(count);
    app.add_option(
           "--sizes", options.sizes,
           "height of each file's character, metres, comma-separated; then each takes only the room that it needs")
        .delimiter(',')
        .check(finite())
        .check(range(0.001, 100000.0));
    app.add_choice("--placement", options.formation, formations,
                   "grid, disc (facing outwards), path (a parade) or random (but apart)");
    app.add_option("--spacing", options.spacing, "room for each character, as a multiple of its width")
        .check(finite())
        .check(range(0.1, 100.0))
        .capture_default_str();
    app.add_option("--controller", options.controllers,
                   "a controller's .json for all files, or FILE=CONTROLLER.json for one; its parameters are set at "
                   "random for each character. Without a controller, each character blends two clips");
    app.add_option("--looks", options.looks,
                   "a .json of colours and clothing, chosen at random for each character; for all files, or "
                   "FILE=LOOKS.json for one");
    app.add_option("--seed", options.seed, "seed of clips, times, blends, places, looks and controller parameters")
        .capture_default_str();
    add_scan_option(app, options.scan);
    add_path_option(app, options.path);
    add_error_option(app, options.compile);
}

void add_clip_options(Command app, SceneOptions& options) {
    Option clip = app.add_option("--clip", options.clips,
                                 "name or number of the clip that all characters play, each from its own time, or "
                                 "FILE=CLIP for one file (default: two at random, blended)");
    Option blend =
        app.add_option("--blend", options.blends, "a second clip to blend with, or FILE=CLIP for one file").needs(clip);
    app.add_option("--weight", options.weight, "weight of --clip; the second clip has the rest")
        .needs(blend)
        .check(range(0.0, 1.0))
        .capture_default_str();
}

std::vector<uint32_t> counts_of(const SceneOptions& options) {
    const size_t files = options.files.size();
    if (options.counts.empty()) {
        const uint32_t count = options.count.value_or(std::max(options.usual_count, static_cast<uint32_t>(files)));
        if (count < files)
            throw UsageError("--count " + std::to_string(count) + ": there are " + std::to_string(files) +
                             " files; give at least one character for each, or leave files out");
        return deal_out(count, files);
    }
    check_length("--counts", options.counts.size(), files);
    const uint64_t sum = std::accumulate(options.counts.begin(), options.counts.end(), uint64_t{0});
    if (sum == 0 || sum > kMaxCharacters)
        throw UsageError("--counts: " + std::to_string(sum) + " characters in all; give from 1 to 10000000");
    return options.counts;
}

std::vector<std::string> controller_files(const SceneOptions& options) {
    return given_values(options.files, options.controllers, "--controller").of_each();
}

std::vector<std::string> look_files(const SceneOptions& options) {
    return given_values(options.files, options.looks, "--looks").of_each();
}

std::vector<std::string> input_files(const SceneOptions& options) {
    std::vector<std::string> files = options.files;
    for (const std::string& controller : controller_files(options)) files.push_back(controller);
    for (const std::string& looks : look_files(options)) files.push_back(looks);
    return files;
}

SceneCast::SceneCast(const SceneOptions& options) : counts(counts_of(options)) {
    check_length("--sizes", options.sizes.size(), options.files.size());
    const std::vector<std::string> controller_of = controller_files(options), looks_of = look_files(options);
    characters = load_characters(options.files, options.compile);
    controllers.resize(characters.size());
    looks.resize(characters.size());
    for (size_t k = 0; k < characters.size(); ++k) {
        if (characters[k].indices.empty())
            print_warnings({characters[k].name + ": has no mesh: only its skeleton can be drawn (--skeletons)"});
        if (!looks_of[k].empty()) looks[k].emplace(looks_of[k], characters[k]);
        if (controller_of[k].empty()) continue;
        controllers[k] = unwrap(load_controller(controller_of[k]));
        unwrap(check_controller(*controllers[k], characters[k]));
    }
}

CrowdScene::CrowdScene(const Device& device, const SceneOptions& options, CrowdSettings settings)
    : culls_(settings.culling.has_value()) {
    const WantedClips clips(options);
    const SceneCast cast(options);
    const std::vector<Character>& characters = cast.characters;
    Scatter field = scatter(characters, {cast.counts, options.sizes, options.formation, options.spacing, options.seed});
    for (size_t k = 0; k < characters.size(); ++k) {
        kinds_.push_back({field.groups[k].instance_count, {characters[k].bounds_min, characters[k].bounds_max}});
        if (options.steer)
            field.groups[k].steering = steering_of(characters[k], cast.controllers[k] ? &*cast.controllers[k] : nullptr,
                                                   field.scales[k]);
        if (cast.looks[k]) field.groups[k].outfits = cast.looks[k]->outfits();
        if (!cast.controllers[k]) continue;
        field.groups[k].controller = &*cast.controllers[k];
        has_controllers_ = true;
    }
    print_progress("placing " + std::to_string(field.placement.size()) + " characters");
    if (options.own_poses > 0)
        for (CrowdGroup& group : field.groups) group.skin_pool = SkinPool{.capacity = options.own_poses};
    settings.groups = field.groups;
    settings.scan = options.scan;
    settings.path = options.path;
    crowd_.emplace(unwrap(Crowd::create(device, settings)));
    director_.emplace(field.groups, options.seed);
    uint32_t first = 0;
    for (size_t k = 0; k < characters.size(); ++k) {
        const CrowdGroup& group = field.groups[k];
        choose_clips(std::span(field.playback).subspan(first, group.instance_count), characters[k], clips.first[k],
                     clips.second[k], options.weight);
        if (!group.controller)
            unwrap(crowd_->set_playback(Instances::numbered(first, group.instance_count),
                                        std::span(field.playback).subspan(first, group.instance_count)));
        if (cast.looks[k])
            unwrap(crowd_->set_look(
                Instances::numbered(first, group.instance_count),
                cast.looks[k]->of_instances(
                    characters[k], std::span(field.placement).subspan(first, group.instance_count), options.seed + k)));
        first += group.instance_count;
    }
    unwrap(crowd_->set_placement(crowd_->instances(), field.placement));
    if (options.steer) destinations_ = each_others_places(field.groups, field.placement, options.seed);
    bounds_ = reached_bounds(main_bounds(*crowd_), field);
    placement_ = std::move(field.placement);
    follow(0);
}

void CrowdScene::follow(uint32_t character) {
    if (character >= placement_.size())
        throw UsageError("character " + std::to_string(character) + " cannot be followed: there are " +
                         std::to_string(placement_.size()) + " characters, numbered from 0");
    world_from_followed_ = placement_[character];
    uint32_t end = 0;
    followed_bounds_ = std::ranges::find_if(kinds_, [&](const Kind& kind) {
                           return character < (end += kind.count);
                       })->model_bounds;
    if (may_move()) unwrap(crowd_->watch(InstanceHandle{character}));
}

CameraSubject CrowdScene::subject(float aspect_ratio) const {
    return {bounds_, aspect_ratio, world_from_followed_, followed_bounds_};
}

void CrowdScene::start() {
    print_progress("preparing");
    unwrap(crowd_->update(0));
    constexpr int kSteps = 120;
    for (int i = 0; has_controllers_ && i < kSteps; ++i) step_unseen(0.1f);
    if (!destinations_.empty()) unwrap(crowd_->set_destination(crowd_->instances(), destinations_));
}

void CrowdScene::step(float step_s, const std::function<void(float part_s)>& update_shown) {
    constexpr float kMax_s = 0.05f;
    const float parts = destinations_.empty() ? 1 : std::max(std::ceil(step_s / kMax_s), 1.0f);
    const float part_s = step_s / parts;
    for (float k = 1; k <= parts; ++k) {
        director_->direct(*crowd_, part_s);
        if (k < parts)
            update_unseen(part_s);
        else
            update_shown(part_s);
        take_feedback();
    }
}

void CrowdScene::step_unseen(float step_s) {
    step(step_s, [this](float part_s) { update_unseen(part_s); });
}

// A crowd that culls is updated for a view that sees nothing.
void CrowdScene::update_unseen(float step_s) {
    // W is -1 everywhere
    static constexpr CrowdView kNothing{.clip_from_world = {{{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, -1}}}};
    unwrap(crowd_->update(step_s, culls_ ? &kNothing : nullptr));
}

void CrowdScene::take_feedback() {
    for (const Feedback& feedback : unwrap(crowd_->feedback()))
        for (const WatchedInstance& watched : feedback.watched) world_from_followed_ = watched.world_from_model;
}

}  // namespace throng::tools
