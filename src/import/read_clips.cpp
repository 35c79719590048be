#include "base/finite.h"
#include "import/cut_keys.h"
#include "import/readers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace throng::gltf {
namespace {

// What a channel animates: a property of a node, or the weights of its morph targets.
struct Animated {
    std::string_view type;  // of its accessor: "VEC4" is a rotation, "SCALAR" are weights
    uint32_t count = 1;     // elements per key

    bool is_rotation() const { return type == "VEC4"; }
};

// A sampler of the file. If one of its accessors is cut short, the keys are those that both have.
struct Sampler {
    JsonView json;
    Interpolation interpolation;
    AccessorView input{}, output{};  // no output for weights of a node without morph targets
    uint64_t values_per_key = 0;
    uint32_t key_count = 0;
};

// Key times as decoded and mended.
struct Keys {
    std::vector<float> times_s;                                    // strictly increasing
    std::vector<uint32_t> kept;                                    // which keys of the file these are
    uint32_t before_count = 0, back_count = 0, doubled_count = 0;  // keys of the file that were mended
};

Interpolation read_interpolation(const JsonView& sampler) {
    const std::string* name = sampler.optional_string("interpolation");
    if (!name || *name == "LINEAR") return Interpolation::kLinear;
    if (*name == "STEP") return Interpolation::kStep;
    if (*name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    sampler.fail_at("interpolation", "'", printable(*name), "' is unknown");
}

Sampler open_sampler(Reading& reading, const JsonView& json, const Animated& animated) {
    Sampler out{.json = json, .interpolation = read_interpolation(json)};
    const AccessorFormat input = reading.accessors.format(json, "input");
    if (input.type != "SCALAR" || !input.is_float())
        json.fail_at("input", "must be SCALAR of floats, but is ", input.text());
    out.input = reading.accessors.open(input, Missing::kAreLeftOut);
    out.key_count = out.input.count();
    if (animated.count == 0) return out;

    const AccessorFormat output = reading.accessors.format(json, "output");
    const auto fail = [&](const auto&... what) { json.fail_at("output", what...); };
    if (output.type != animated.type) fail("must be ", animated.type, ", but is ", output.type);
    if (!output.is_float() && (!output.normalized || output.component_type == ComponentType::kUint32))
        fail("must be floats or normalised integers, but is ", output.component_text());
    out.values_per_key = uint64_t(animated.count) * (out.interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (output.count != input.count * out.values_per_key)
        fail("has ", output.count, " values, but must have ", input.count * out.values_per_key, ", for ", input.count,
             " key times", animated.type == "SCALAR" ? joined(" and ", animated.count, " morph targets") : "");
    out.output = reading.accessors.open(output, Missing::kAreLeftOut);
    out.key_count = uint32_t(std::min<uint64_t>(out.key_count, out.output.count() / out.values_per_key));
    return out;
}

// glTF 2.0, 3.11, wants times that increase strictly. Keys that go back in time are sorted, as in Filament (gltfio,
// Animator.cpp: a std::map) and Blender (FCurve.update() after the import). three.js (Interpolant.js) and Khronos'
// viewer (interpolator.js) search them as if they were sorted, and what they find depends on the time shown before.
//
// If several keys have one time, the value arrives at the first and goes on from the last, as in three.js and Khronos'
// viewer. Times before 0 stay here: they are cut off later, together with their values.
Keys read_times(Reading& reading, const Sampler& sampler, TemporaryCharge& of_kept) {
    const std::string place = sampler.json.place_of("input");
    reading.budget.charge(sampler.key_count, sizeof(float), place);
    of_kept.add(sampler.key_count, sizeof(uint32_t), place);
    const auto time_of = [&](uint32_t key) { return sampler.input.number(key, 0); };
    Keys out;
    for (uint32_t key = 0; key < sampler.key_count; ++key) {
        reading.budget.poll_at(key);
        if (!std::isfinite(time_of(key))) sampler.json.fail_at("input", "the time of key ", key, " is not finite");
        if (time_of(key) < 0) ++out.before_count;
        if (key > 0 && time_of(key) < time_of(key - 1)) ++out.back_count;
    }
    out.kept.resize(sampler.key_count);
    std::iota(out.kept.begin(), out.kept.end(), 0u);
    if (out.back_count > 0) {
        TemporaryCharge of_sort(reading.budget);
        of_sort.add(sampler.key_count, sizeof(uint32_t), place);
        std::stable_sort(out.kept.begin(), out.kept.end(),
                         [&](uint32_t a, uint32_t b) { return time_of(a) < time_of(b); });
    }

    out.times_s.reserve(sampler.key_count);
    const auto add = [&](float time_s, uint32_t key) {
        out.kept[out.times_s.size()] = key;
        out.times_s.push_back(time_s);
    };
    for (size_t begin = 0, end = 0; begin < out.kept.size(); begin = end) {
        const uint32_t first = out.kept[begin];
        const float time_s = time_of(first);
        for (end = begin + 1; end < out.kept.size() && time_of(out.kept[end]) == time_s; ++end) ++out.doubled_count;
        const uint32_t last = out.kept[end - 1];
        // The first of several keys moves to the next float below, so that times still differ. It is left out if
        // nothing would show it (steps; at 0), or if the difference is a denormal float, which a device may take for 0.
        const float before_s = std::nextafter(time_s, -std::numeric_limits<float>::infinity());
        const bool has_room = out.times_s.empty() || out.times_s.back() < before_s;
        const bool steps = sampler.interpolation == Interpolation::kStep;
        if (first != last && !steps && has_room && std::isnormal(time_s - before_s)) add(before_s, first);
        add(time_s, last);
    }
    out.kept.resize(out.times_s.size());
    return out;
}

// [key][element]; for cubic splines [key][3][element].
std::vector<float> read_values(Reading& reading, const Sampler& sampler, const Keys& keys, const Animated& animated) {
    const AccessorView& output = sampler.output;
    const std::string place = sampler.json.place_of("output");
    const uint64_t per_key = sampler.values_per_key;
    reading.budget.charge(uint64_t(output.count()) * output.format.component_count, sizeof(float), place);
    std::vector<float> out;
    out.reserve(keys.kept.size() * per_key * output.format.component_count);
    bool has_zero = false;
    for (const uint32_t key : keys.kept)
        for (uint64_t part = 0; part < per_key; ++part) {
            reading.budget.poll_at(key * per_key + part);
            float length_squared = 0;
            for (uint32_t c = 0; c < output.format.component_count; ++c) {
                const float value = output.number(uint32_t(key * per_key + part), c);
                if (!std::isfinite(value)) sampler.json.fail_at("output", "the value of key ", key, " is not finite");
                length_squared += value * value;
                out.push_back(value);
            }
            const bool is_tangent = per_key == 3 && part != 1;
            has_zero = has_zero || (animated.is_rotation() && !is_tangent && length_squared == 0);
        }
    if (has_zero) reading.warnings.add(place, "has a quaternion of length zero: it is taken as the identity");
    return out;
}

class ClipReader {
public:
    ClipReader(Reading& reading, const JsonView& json, size_t node_count)
        : reading_(reading), samplers_(json.optional_array("samplers")), node_count_(node_count) {
        clip_.name = read_name(reading, json);
        const JsonView channels = json.optional_array("channels");
        if (channels.size() == 0) reading.warnings.add(json.place(), "has no channels");
        for (const JsonView channel : channels) read_channel(channel);
        if (without_node_count_ > 0)
            reading.warnings.add(json.place(), without_node_count_, " of ", channels.size(),
                                 " channels have no target node: they are ignored");
        warn_of_times(before_count_, "are before time 0: the clip is cut there");
        warn_of_times(back_count_, "are earlier than the key before them: the keys are sorted by time");
        warn_of_times(doubled_count_,
                      "have the time of another key: the value jumps there, from the first to the last of them");
    }

    AssetClip take() { return std::move(clip_); }

private:
    void read_channel(const JsonView& channel) {
        const JsonView target = channel.required_object("target");
        if (target.extension("KHR_animation_pointer"))
            return ignore(channel, "KHR_animation_pointer is not supported: the channel is ignored");
        const std::string& path = target.required_string("path");
        const uint32_t node = target.optional_index("node", node_count_, "nodes");
        if (node == kNone) {
            ++without_node_count_;
            return;
        }
        const JsonView sampler = samplers_[channel.required_index("sampler", samplers_.size(), "samplers")].as_object();
        constexpr std::pair<std::string_view, TrackTarget> kTargets[] = {{"translation", TrackTarget::kTranslation},
                                                                         {"rotation", TrackTarget::kRotation},
                                                                         {"scale", TrackTarget::kScale}};
        if (path == "weights")
            return read_track(channel, sampler, {"SCALAR", target_count(node)}, AssetMorphTrack{.node = node}, node,
                              morph_track_of_, clip_.morph_tracks);
        for (const auto& [name, property] : kTargets) {
            if (path != name) continue;
            return read_track(channel, sampler, {property == TrackTarget::kRotation ? "VEC4" : "VEC3"},
                              AssetTrack{.node = node, .target = property}, std::pair(node, property), track_of_,
                              clip_.tracks);
        }
        ignore(channel, "target path '", printable(path), "' is unknown: the channel is ignored");
    }

    uint32_t target_count(uint32_t node) const {
        const JsonView meshes = reading_.root.optional_array("meshes");
        const uint32_t mesh = reading_.root.optional_array("nodes")[node].optional_index("mesh", meshes.size(),
                                                                                         "meshes");
        return mesh == kNone ? 0 : morph_target_count(meshes[mesh]);
    }

    // `key` is what the track animates.
    template <class Track, class Key>
    void read_track(const JsonView& channel, const JsonView& sampler_json, const Animated& animated, Track track,
                    const Key& key, std::map<Key, size_t>& index_of, std::vector<Track>& tracks) {
        const Sampler sampler = open_sampler(reading_, sampler_json, animated);
        track.interpolation = sampler.interpolation;
        TemporaryCharge of_kept(reading_.budget);  // for keys.kept
        Keys keys = read_keys(sampler, of_kept);
        if (!keys.times_s.empty()) clip_.duration_s = std::max(clip_.duration_s, double(keys.times_s.back()));
        if (animated.count == 0) return ignore(channel, "its node has no morph targets: the channel is ignored");
        track.values = read_values(reading_, sampler, keys, animated);
        track.times_s = std::move(keys.times_s);
        if (track.times_s.empty()) return ignore(channel, "has no keys: the channel is ignored");
        if (keys.before_count > 0) cut(track, sampler_json, animated);

        reading_.budget.charge(sizeof(Track), channel.place());
        const auto [known, is_new] = index_of.emplace(key, tracks.size());
        if (is_new) return tracks.push_back(std::move(track));
        ignore(channel, "animates what another channel of the clip animates: the last one is used");
        tracks[known->second] = std::move(track);
    }

    // Between its keys, and so at time 0, a cubic track can exceed the range of floats.
    template <class Track>
    void cut(Track& track, const JsonView& sampler_json, const Animated& animated) const {
        cut_before_zero({track.interpolation, animated.is_rotation(), track.times_s, track.values});
        if (!all_finite(track.values))
            sampler_json.fail_at("output", "the curve at time 0, where it is cut, is not finite");
    }

    // A sampler counts once, however many channels use it.
    Keys read_keys(const Sampler& sampler, TemporaryCharge& of_kept) {
        Keys keys = read_times(reading_, sampler, of_kept);
        if (!counted_samplers_.insert(sampler.json.place()).second) return keys;
        key_count_ += sampler.key_count;
        before_count_ += keys.before_count;
        back_count_ += keys.back_count;
        doubled_count_ += keys.doubled_count;
        const bool mended = keys.before_count > 0 || keys.back_count > 0 || keys.doubled_count > 0;
        if (mended && first_mended_.empty()) first_mended_ = sampler.json.place_of("input");
        return keys;
    }

    // One warning per clip, at the first such sampler: exporters that break times do so in all samplers.
    void warn_of_times(uint64_t count, const char* what) {
        if (count == 0) return;
        reading_.warnings.add(first_mended_, count, " of the clip's ", key_count_, " keys ", what);
    }

    template <class... Parts>
    void ignore(const JsonView& channel, const Parts&... why) {
        reading_.warnings.add(channel.place(), why...);
    }

    Reading& reading_;
    JsonView samplers_;
    size_t node_count_;
    AssetClip clip_;
    std::map<std::pair<uint32_t, TrackTarget>, size_t> track_of_;
    std::map<uint32_t, size_t> morph_track_of_;  // by node
    std::set<std::string> counted_samplers_;     // by place
    uint64_t key_count_ = 0, before_count_ = 0, back_count_ = 0, doubled_count_ = 0, without_node_count_ = 0;
    std::string first_mended_;  // place of the first sampler's times that were mended
};

}  // namespace

void read_clips(Reading& reading, Asset& asset) {
    const JsonView animations = reading.charged_array("animations", sizeof(AssetClip));
    asset.clips.reserve(animations.size());
    for (const JsonView animation : animations) {
        reading.progress.report(asset.clips.size(), animations.size());
        asset.clips.push_back(ClipReader(reading, animation, asset.nodes.size()).take());
    }
}

}  // namespace throng::gltf
