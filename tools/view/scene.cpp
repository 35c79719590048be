#include "tools/cli/command.h"
#include "tools/view/scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace throng::view {
namespace {

std::vector<float> initial_parameters(const Controller& controller) {
    std::vector<float> values;
    for (const ControllerParameter& parameter : controller.parameters) values.push_back(parameter.initial);
    return values;
}

// Deals `count` out in proportion to the shares.
std::vector<uint32_t> deal_out(uint32_t count, std::span<const uint32_t> shares) {
    const uint64_t whole = std::accumulate(shares.begin(), shares.end(), uint64_t{0});
    std::vector<uint32_t> counts;
    uint64_t before = 0;
    for (const uint32_t share : shares) {
        counts.push_back(static_cast<uint32_t>(count * (before + share) / whole - count * before / whole));
        before += share;
    }
    return counts;
}

// Loops stay within their duration, so that time is as exact after hours as after seconds.
double moved_on(const Character& character, const ClipPlayback& clip, double seconds) {
    const double time_s = clip.time_s + seconds * double{clip.speed};
    const double duration_s = clip.clip == kNone ? 0 : double{character.clips[clip.clip].duration_s};
    if (!clip.loop || duration_s <= 0) return std::clamp(time_s, 0.0, duration_s);
    return time_s - std::floor(time_s / duration_s) * duration_s;
}

}  // namespace

Scene::Shown::Shown(Cast of, const SceneSettings& made_so)
    : settings(made_so), playback(of.characters.size()), parameters(of.characters.size()) {
    for (size_t group = 0; group < of.controllers.size(); ++group)
        if (of.controllers[group]) parameters[group] = initial_parameters(*of.controllers[group]);
    cast = std::make_shared<const Cast>(std::move(of));
}

Scene::Scene(const Device& device, Cast cast, const SceneSettings& settings)
    : device_(device), shown_(std::move(cast), settings) {
    make_field();
    begin_playing();
    make_crowd();
}

void Scene::set_settings(const SceneSettings& settings) {
    Shown wanted = shown_;
    wanted.settings = settings;
    rebuild(std::move(wanted));
}

void Scene::set_cast(Cast cast) { rebuild({std::move(cast), settings()}); }

void Scene::set_controllers(std::vector<std::optional<Controller>> controllers) {
    Shown wanted = shown_;
    Cast with_them = cast();
    for (size_t group = 0; group < controllers.size(); ++group) {
        if (!controllers[group]) continue;
        wanted.parameters[group] = initial_parameters(*controllers[group]);
        with_them.controllers[group] = std::move(controllers[group]);
    }
    wanted.cast = std::make_shared<const Cast>(std::move(with_them));
    rebuild(std::move(wanted));
}

void Scene::set_looks(std::vector<std::optional<tools::Looks>> looks) {
    Shown wanted = shown_;
    Cast with_them = cast();
    for (size_t group = 0; group < looks.size(); ++group)
        if (looks[group]) with_them.looks[group] = std::move(looks[group]);
    wanted.cast = std::make_shared<const Cast>(std::move(with_them));
    rebuild(std::move(wanted));
}

void Scene::rebuild(Shown wanted) {
    std::swap(shown_, wanted);
    Shown& before = wanted;
    const auto places = [](const SceneSettings& of) { return std::tie(of.count, of.seed, of.formation, of.spacing); };
    const bool same_places = !shown_.playing.empty() && places(shown_.settings) == places(before.settings);
    try {
        if (!same_places || shown_.cast != before.cast) make_field();
        if (!same_places) begin_playing();
        make_crowd();
    } catch (const tools::CommandError& error) {
        std::swap(shown_, before);
        try {
            make_crowd();
        } catch (const tools::CommandError& again) {
            throw std::runtime_error(std::string(error.what()) +
                                     "; and the previous crowd cannot be restored: " + again.what());
        }
        throw;
    }
}

void Scene::make_field() {
    const SceneSettings& of = settings();
    shown_.field = tools::scatter(cast().characters, {deal_out(of.count, cast().shares), cast().heights, of.formation,
                                                      double{of.spacing}, of.seed});
    for (size_t group = 0; group < shown_.field.groups.size(); ++group) {
        shown_.field.groups[group].controller = controller_of(static_cast<uint32_t>(group));
        if (cast().looks[group]) shown_.field.groups[group].outfits = cast().looks[group]->outfits();
        shown_.field.groups[group].moves_placements = false;  // so that places are known here when one is clicked
    }
}

void Scene::begin_playing() {
    shown_.playing.assign(shown_.field.playback.size(), {});
    uint32_t instance = 0;
    for (uint32_t group = 0; group < shown_.field.groups.size(); ++group)
        for (uint32_t i = 0; i < instance_count_of(group); ++i, ++instance)
            shown_.playing[instance] = {chosen(group, instance), clock_s_};
}

void Scene::make_crowd() {
    crowd_.reset();  // first: two large ones need not fit into the device's memory together
    const SceneSettings& of = settings();
    crowd_.emplace(tools::unwrap(Crowd::create(
        device_, {.groups = shown_.field.groups,
                  .path = of.path,
                  .skin_format = of.format,
                  .scan = of.scan,
                  .keep_model_matrices = of.keeps_joints,
                  .culling = of.culls ? std::optional(Culling{.skips_updates = of.skips_updates && !of.keeps_joints,
                                                              .reduces_joints = !of.keeps_joints})
                                      : std::nullopt,
                  .skin_blend = of.blend,
                  .skins_once = of.skins_once})));
    director_.emplace(shown_.field.groups, of.seed);
    for (uint32_t group = 0; group < shown_.field.groups.size(); ++group) {
        const Instances instances = *crowd_->instances(group);
        if (!controller_of(group)) send_playback(group);
        if (cast().looks[group])
            tools::unwrap(crowd_->set_look(
                instances,
                cast().looks[group]->of_instances(
                    cast().characters[group],
                    std::span(shown_.field.placement).subspan(instances.first(), instances.size()), of.seed + group)));
        for (uint32_t p = 0; p < parameters(group).size(); ++p)
            if (parameters(group)[p] != controller_of(group)->parameters[p].initial)
                set_parameter(group, p, parameters(group)[p]);
    }
    tools::unwrap(crowd_->set_placement(crowd_->instances(), shown_.field.placement));
    bounds_ = tools::reached_bounds(main_bounds(*crowd_), shown_.field);
}

std::optional<uint32_t> Scene::instance_at(const InGroup& place) const {
    if (place.number >= instance_count_of(place.group)) return std::nullopt;
    return first_instance_of(place.group) + place.number;
}

Scene::InGroup Scene::place_of(uint32_t instance) const {
    const uint32_t group = group_of(instance);
    return {group, instance - first_instance_of(group)};
}

void Scene::advance(float time_step_s) {
    if (directs_) director_->direct(*crowd_, time_step_s);
    clock_s_ += double{time_step_s};
}

uint32_t Scene::group_of(uint32_t instance) const {
    uint32_t group = 0;
    for (uint32_t end = instance_count_of(0); instance >= end; end += instance_count_of(group)) ++group;
    return group;
}

uint32_t Scene::first_instance_of(uint32_t group) const {
    return std::accumulate(shown_.field.groups.begin(), shown_.field.groups.begin() + group, 0u,
                           [](uint32_t sum, const CrowdGroup& one) { return sum + one.instance_count; });
}

Playback Scene::chosen(uint32_t group, uint32_t instance) const {
    Playback playback = shown_.field.playback[instance];
    const GroupPlayback& wanted = group_playback(group);
    if (wanted.own) return playback;
    const Character& character = cast().characters[group];
    playback.first.clip = wanted.first;
    playback.second.clip = wanted.second;
    playback.weight = wanted.weight;
    for (ClipPlayback* clip : {&playback.first, &playback.second}) clip->time_s = moved_on(character, *clip, 0);
    return playback;
}

void Scene::set_group_playback(uint32_t group, const GroupPlayback& playback) {
    shown_.playback[group] = playback;
    const uint32_t first = first_instance_of(group);
    for (uint32_t i = first; i < first + instance_count_of(group); ++i) {
        const Playback wanted = chosen(group, i), now = playback_of(i);
        Playback& next = shown_.playing[i].from;
        next = wanted;
        // Clips that go on playing continue from where they are.
        if (now.first.clip == next.first.clip) next.first.time_s = now.first.time_s;
        if (now.second.clip == next.second.clip) next.second.time_s = now.second.time_s;
        shown_.playing[i].since_s = clock_s_;
    }
    send_playback(group);
}

void Scene::send_playback(uint32_t group) {
    const uint32_t first = first_instance_of(group);
    std::vector<Playback> now(instance_count_of(group));
    for (uint32_t i = 0; i < now.size(); ++i) now[i] = playback_of(first + i);
    tools::unwrap(crowd_->set_playback(Instances::numbered(first, instance_count_of(group)), now));
}

Playback Scene::playback_of(uint32_t instance) const {
    const Playing& playing = shown_.playing[instance];
    const Character& character = cast().characters[group_of(instance)];
    Playback now = playing.from;
    for (ClipPlayback* clip : {&now.first, &now.second})
        clip->time_s = moved_on(character, *clip, clock_s_ - playing.since_s);
    return now;
}

void Scene::set_playback_of(uint32_t instance, const Playback& playback) {
    tools::unwrap(crowd_->set_playback(InstanceHandle{instance}, playback));
    shown_.playing[instance] = {playback, clock_s_};
}

void Scene::set_parameter(uint32_t group, uint32_t parameter, float value) {
    const bool lasts = controller_of(group)->parameters[parameter].type != ParameterType::kTrigger;
    if (lasts) shown_.parameters[group][parameter] = value;
    const uint32_t first = first_instance_of(group);
    for (uint32_t i = first; i < first + instance_count_of(group); ++i) set_parameter_of(i, parameter, value);
}

void Scene::set_parameter_of(uint32_t instance, uint32_t parameter, float value) {
    tools::unwrap(crowd_->set_parameter(InstanceHandle{instance}, parameter, value));
}

PlacedBox Scene::box_of(uint32_t instance) const {
    const Character& character = cast().characters[group_of(instance)];
    return {character.bounds_min, character.bounds_max, shown_.field.placement[instance]};
}

std::optional<uint32_t> Scene::pick(const Projection::Ray& ray) const {
    std::optional<uint32_t> nearest;
    float least = 0;
    for (uint32_t instance = 0; instance < shown_.field.placement.size(); ++instance) {
        const std::optional<float> distance = distance_to(box_of(instance), ray);
        if (!distance || (nearest && *distance >= least)) continue;
        nearest = instance;
        least = *distance;
    }
    return nearest;
}

}  // namespace throng::view
