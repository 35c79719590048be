#include "import/readers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace throng::gltf {
namespace {

// A sampler as decoded and mended.
struct Keys {
    std::vector<float> times_s;  // strictly increasing
    std::vector<uint32_t> kept;  // which keys of the file these are
    uint32_t file_count = 0;
    uint32_t back_count = 0, doubled_count = 0;  // keys of the file that were mended
};

Interpolation read_interpolation(const JsonView& sampler) {
    const std::string* name = sampler.optional_string("interpolation");
    if (!name || *name == "LINEAR") return Interpolation::kLinear;
    if (*name == "STEP") return Interpolation::kStep;
    if (*name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    sampler.fail_at("interpolation", "'", printable(*name), "' is unknown");
}

// glTF 2.0, 3.11, wants times that increase strictly. Keys that go back in time are sorted, as Filament (gltfio,
// Animator.cpp: a std::map) and Blender (FCurve.update() after the import) do; three.js (Interpolant.js) and Khronos'
// viewer (interpolator.js) search them as if they were sorted, and what they find depends on the time shown before.
// Where several keys have one time, the value arrives at the first and goes on from the last, as in three.js and
// Khronos' viewer.
Keys read_times(Reading& reading, const JsonView& sampler, Interpolation interpolation) {
    const AccessorView input = reading.accessors.open(sampler, "input");
    const std::string place = sampler.place_of("input");
    if (input.format.type != "SCALAR" || !input.format.is_float())
        sampler.fail_at("input", "must be SCALAR of floats, but is ", input.format.text());
    reading.budget.charge(input.count(), sizeof(float) + sizeof(uint32_t), place);
    const auto time_of = [&](uint32_t key) { return input.number(key, 0); };
    Keys out;
    out.file_count = input.count();
    for (uint32_t key = 0; key < input.count(); ++key) {
        reading.budget.poll_at(key);
        const auto fail = [&](const char* what) { sampler.fail_at("input", "the time of key ", key, " ", what); };
        if (!std::isfinite(time_of(key))) fail("is not finite");
        if (time_of(key) < 0) fail("is negative");
        if (key > 0 && time_of(key) < time_of(key - 1)) ++out.back_count;
    }
    out.kept.resize(input.count());
    std::iota(out.kept.begin(), out.kept.end(), 0u);
    if (out.back_count > 0) {
        reading.budget.charge(input.count(), sizeof(uint32_t), place);
        std::stable_sort(out.kept.begin(), out.kept.end(),
                         [&](uint32_t a, uint32_t b) { return time_of(a) < time_of(b); });
    }

    out.times_s.reserve(input.count());
    const auto add = [&](float time_s, uint32_t key) {
        out.kept[out.times_s.size()] = key;
        out.times_s.push_back(time_s);
    };
    for (size_t begin = 0, end = 0; begin < out.kept.size(); begin = end) {
        const uint32_t first = out.kept[begin];
        const float time_s = time_of(first);
        for (end = begin + 1; end < out.kept.size() && time_of(out.kept[end]) == time_s; ++end) ++out.doubled_count;
        const uint32_t last = out.kept[end - 1];
        // The first of several goes to the float before, so that times still differ. It is left out where nothing would
        // show it (steps; at 0), and where the difference is no normal float, which a device may take for 0.
        const float before_s = std::nextafter(time_s, 0.0f);
        const bool has_room = out.times_s.empty() || out.times_s.back() < before_s;
        if (first != last && interpolation != Interpolation::kStep && has_room && std::isnormal(time_s - before_s))
            add(before_s, first);
        add(time_s, last);
    }
    out.kept.resize(out.times_s.size());
    return out;
}

// What a channel animates: a property of a node, or the weights of its morph targets.
struct Animated {
    std::string_view type;  // of its accessor: "VEC4" is a rotation, "SCALAR" are weights
    uint32_t count = 1;     // elements per key
};

// [key][element]; for cubic splines [key][3][element].
std::vector<float> read_values(Reading& reading, const JsonView& sampler, const Keys& keys, const Animated& animated,
                               Interpolation interpolation) {
    const AccessorView output = reading.accessors.open(sampler, "output");
    const AccessorFormat& format = output.format;
    const auto fail = [&](const auto&... what) { sampler.fail_at("output", what...); };
    if (format.type != animated.type) fail("must be ", animated.type, ", but is ", format.type);
    if (!format.is_float() && (!format.normalized || format.component_type == ComponentType::kUint32))
        fail("must be floats or normalised integers, but is ", format.component_text());
    const uint64_t per_key = uint64_t(animated.count) * (interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (output.count() != keys.file_count * per_key)
        fail("has ", output.count(), " values, but must have ", keys.file_count * per_key, ", for ", keys.file_count,
             " key times", animated.type == "SCALAR" ? joined(" and ", animated.count, " morph targets") : "");

    reading.budget.charge(uint64_t(output.count()) * format.component_count, sizeof(float), sampler.place_of("output"));
    std::vector<float> out;
    out.reserve(keys.kept.size() * per_key * format.component_count);
    const bool is_rotation = animated.type == "VEC4";
    bool has_zero = false;
    for (const uint32_t key : keys.kept)
        for (uint64_t part = 0; part < per_key; ++part) {
            reading.budget.poll_at(key * per_key + part);
            float length_squared = 0;
            for (uint32_t c = 0; c < format.component_count; ++c) {
                const float value = output.number(uint32_t(key * per_key + part), c);
                if (!std::isfinite(value)) fail("the value of key ", key, " is not finite");
                length_squared += value * value;
                out.push_back(value);
            }
            const bool is_tangent = per_key == 3 && part != 1;
            has_zero = has_zero || (is_rotation && !is_tangent && length_squared == 0);
        }
    if (has_zero)
        reading.warnings.add(sampler.place_of("output"),
                             "has a quaternion of length zero: it is taken as the identity");
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
        warn_of_times(back_count_, "are earlier than the key before them: the keys are sorted by time");
        warn_of_times(doubled_count_,
                      "have the time of another one: the value jumps there, from the first to the last of them");
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
    void read_track(const JsonView& channel, const JsonView& sampler, const Animated& animated, Track track,
                    const Key& key, std::map<Key, size_t>& index_of, std::vector<Track>& tracks) {
        track.interpolation = read_interpolation(sampler);
        Keys keys = read_keys(sampler, track.interpolation);
        if (!keys.times_s.empty()) clip_.duration_s = std::max(clip_.duration_s, double(keys.times_s.back()));
        if (animated.count == 0) return ignore(channel, "its node has no morph targets: the channel is ignored");
        track.values = read_values(reading_, sampler, keys, animated, track.interpolation);
        track.times_s = std::move(keys.times_s);
        if (track.times_s.empty()) return ignore(channel, "has no keys: the channel is ignored");

        reading_.budget.charge(sizeof(Track), channel.place());
        const auto [known, is_new] = index_of.emplace(key, tracks.size());
        if (is_new) return tracks.push_back(std::move(track));
        ignore(channel, "animates what another channel of the clip animates: the last one is used");
        tracks[known->second] = std::move(track);
    }

    // A sampler counts once, however many channels use it.
    Keys read_keys(const JsonView& sampler, Interpolation interpolation) {
        Keys keys = read_times(reading_, sampler, interpolation);
        if (!counted_samplers_.insert(sampler.place()).second) return keys;
        key_count_ += keys.file_count;
        back_count_ += keys.back_count;
        doubled_count_ += keys.doubled_count;
        const bool mended = keys.back_count > 0 || keys.doubled_count > 0;
        if (mended && first_mended_.empty()) first_mended_ = sampler.place_of("input");
        return keys;
    }

    // One line a clip, at the first of the samplers: exporters that break times do so in all of them.
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
    uint64_t key_count_ = 0, back_count_ = 0, doubled_count_ = 0, without_node_count_ = 0;
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
