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
    uint32_t back_count = 0, doubled_count = 0;  // of the file's, what was mended
};

Interpolation read_interpolation(const JsonView& sampler) {
    const std::string* name = sampler.optional_string("interpolation");
    if (!name || *name == "LINEAR") return Interpolation::kLinear;
    if (*name == "STEP") return Interpolation::kStep;
    if (*name == "CUBICSPLINE") return Interpolation::kCubicSpline;
    throw Failure(ErrorCode::kInvalidFile, sampler.place_of("interpolation"), "'" + printable(*name) + "' is unknown");
}

// glTF 2.0, 3.11, wants times that increase strictly. Keys that go back in time are sorted, as Filament (gltfio,
// Animator.cpp: a std::map) and Blender (FCurve.update() after the import) do; three.js (Interpolant.js) and Khronos'
// viewer (interpolator.js) search them as if they were sorted, and what they find depends on the time shown before.
// Of keys at one time the value goes to the first and goes on from the last, as in three.js and Khronos' viewer.
Keys read_times(Reading& reading, const JsonView& sampler, Interpolation interpolation) {
    const AccessorView input = reading.accessors.open(sampler, "input");
    const std::string place = sampler.place_of("input");
    if (input.format.type != "SCALAR" || !input.format.is_float())
        throw Failure(
            ErrorCode::kInvalidFile, place,
            "must be SCALAR of floats, but is " + input.format.type + " of " + name_of(input.format.component_type));
    reading.budget.charge(input.count(), sizeof(float) + sizeof(uint32_t), place);
    const auto time_of = [&](uint32_t key) { return input.number(key, 0); };
    Keys out;
    out.file_count = input.count();
    for (uint32_t key = 0; key < input.count(); ++key) {
        const auto fail = [&](const char* what) {
            throw Failure(ErrorCode::kInvalidFile, place, "the time of key " + std::to_string(key) + " " + what);
        };
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

std::vector<float> read_values(Reading& reading, const JsonView& sampler, const Keys& keys, TrackTarget target,
                               Interpolation interpolation) {
    const AccessorView output = reading.accessors.open(sampler, "output");
    const std::string place = sampler.place_of("output");
    const auto fail = [&](const std::string& what) { throw Failure(ErrorCode::kInvalidFile, place, what); };
    const bool rotation = target == TrackTarget::kRotation;
    const std::string type = rotation ? "VEC4" : "VEC3";
    if (output.format.type != type) fail("must be " + type + ", but is " + output.format.type);
    const bool number = output.format.is_float() ||
                        (output.format.normalized && output.format.component_type != ComponentType::kUint32);
    if (!number)
        fail(std::string("must be floats or normalised integers, but is ") + name_of(output.format.component_type));
    const uint32_t values_per_key = interpolation == Interpolation::kCubicSpline ? 3 : 1;
    if (output.count() != uint64_t(keys.file_count) * values_per_key)
        fail("has " + std::to_string(output.count()) + " values, but must have " +
             std::to_string(uint64_t(keys.file_count) * values_per_key) + ", for " + std::to_string(keys.file_count) +
             " key times");

    const uint32_t component_count = output.format.component_count;
    reading.budget.charge(uint64_t(output.count()) * component_count, sizeof(float), place);
    std::vector<float> out;
    out.reserve(keys.kept.size() * values_per_key * component_count);
    bool has_zero = false;
    for (const uint32_t key : keys.kept)
        for (uint32_t part = 0; part < values_per_key; ++part) {
            float length_squared = 0;
            for (uint32_t c = 0; c < component_count; ++c) {
                const float value = output.number(key * values_per_key + part, c);
                if (!std::isfinite(value)) fail("the value of key " + std::to_string(key) + " is not finite");
                length_squared += value * value;
                out.push_back(value);
            }
            const bool is_tangent = values_per_key == 3 && part != 1;
            has_zero = has_zero || (rotation && !is_tangent && length_squared == 0);
        }
    if (has_zero) reading.warnings.add(place, "has a quaternion of length zero: it is taken as the identity");
    return out;
}

// [key][target], of cubic splines [key][3][target].
std::vector<float> read_morph_values(Reading& reading, const JsonView& sampler, const Keys& keys, uint32_t target_count,
                                     Interpolation interpolation) {
    const AccessorView output = reading.accessors.open(sampler, "output");
    const std::string place = sampler.place_of("output");
    const auto fail = [&](const std::string& what) { throw Failure(ErrorCode::kInvalidFile, place, what); };
    if (output.format.type != "SCALAR") fail("must be SCALAR, but is " + output.format.type);
    if (!output.format.is_float() &&
        (!output.format.normalized || output.format.component_type == ComponentType::kUint32))
        fail(std::string("must be floats or normalised integers, but is ") + name_of(output.format.component_type));
    const uint64_t values_per_key = uint64_t(target_count) * (interpolation == Interpolation::kCubicSpline ? 3 : 1);
    if (output.count() != keys.file_count * values_per_key)
        fail("has " + std::to_string(output.count()) + " values, but must have " +
             std::to_string(keys.file_count * values_per_key) + ", for " + std::to_string(keys.file_count) +
             " key times and " + std::to_string(target_count) + " morph targets");
    reading.budget.charge(output.count(), sizeof(float), place);
    std::vector<float> out;
    out.reserve(keys.kept.size() * values_per_key);
    for (const uint32_t key : keys.kept)
        for (uint64_t i = 0; i < values_per_key; ++i) {
            out.push_back(output.number(uint32_t(key * values_per_key + i), 0));
            if (!std::isfinite(out.back())) fail("the value of key " + std::to_string(key) + " is not finite");
        }
    return out;
}

class ClipReader {
public:
    ClipReader(Reading& reading, const JsonView& json, size_t node_count)
        : reading_(reading), samplers_(json.optional_array("samplers")), node_count_(node_count) {
        clip_.name = read_name(reading, json);
        const JsonView channels = json.optional_array("channels");
        if (channels.size() == 0) reading.warnings.add(json.place(), "has no channels");
        for (size_t i = 0; i < channels.size(); ++i) read_channel(channels[i]);
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
        if (node == kNone) return ignore(channel, "has no target node: the channel is ignored");
        const JsonView sampler = samplers_[channel.required_index("sampler", samplers_.size(), "samplers")].as_object();
        if (path == "weights") {
            read_morph_track(channel, sampler, node);
        } else if (path == "translation") {
            read_track(channel, sampler, node, TrackTarget::kTranslation);
        } else if (path == "rotation") {
            read_track(channel, sampler, node, TrackTarget::kRotation);
        } else if (path == "scale") {
            read_track(channel, sampler, node, TrackTarget::kScale);
        } else {
            ignore(channel, "target path '" + printable(path) + "' is unknown: the channel is ignored");
        }
    }

    void read_track(const JsonView& channel, const JsonView& sampler, uint32_t node, TrackTarget target) {
        AssetTrack track;
        track.node = node;
        track.target = target;
        track.interpolation = read_interpolation(sampler);
        Keys keys = read_keys(sampler, track.interpolation);
        track.values = read_values(reading_, sampler, keys, target, track.interpolation);
        track.times_s = std::move(keys.times_s);
        if (track.times_s.empty()) return ignore(channel, "has no keys: the channel is ignored");
        clip_.duration_s = std::max(clip_.duration_s, double(track.times_s.back()));

        keep(channel, std::move(track), std::pair(node, target), track_of_, clip_.tracks);
    }

    void read_morph_track(const JsonView& channel, const JsonView& sampler, uint32_t node) {
        const JsonView meshes = reading_.root.optional_array("meshes");
        const uint32_t mesh = reading_.root.optional_array("nodes")[node].optional_index("mesh", meshes.size(),
                                                                                         "meshes");
        const uint32_t target_count = mesh == kNone ? 0 : morph_target_count(meshes[mesh]);
        AssetMorphTrack track{.node = node, .interpolation = read_interpolation(sampler), .times_s = {}, .values = {}};
        Keys keys = read_keys(sampler, track.interpolation);
        if (!keys.times_s.empty()) clip_.duration_s = std::max(clip_.duration_s, double(keys.times_s.back()));
        if (target_count == 0) return ignore(channel, "its node has no morph targets: the channel is ignored");
        track.values = read_morph_values(reading_, sampler, keys, target_count, track.interpolation);
        track.times_s = std::move(keys.times_s);
        if (track.times_s.empty()) return ignore(channel, "has no keys: the channel is ignored");
        keep(channel, std::move(track), node, morph_track_of_, clip_.morph_tracks);
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
        reading_.warnings.add(first_mended_,
                              std::to_string(count) + " of the clip's " + std::to_string(key_count_) + " keys " + what);
    }

    // `key` is what the track animates.
    template <class Track, class Key>
    void keep(const JsonView& channel, Track track, const Key& key, std::map<Key, size_t>& index_of,
              std::vector<Track>& tracks) {
        reading_.budget.charge(sizeof(Track), channel.place());
        const auto [known, is_new] = index_of.emplace(key, tracks.size());
        if (is_new) {
            tracks.push_back(std::move(track));
        } else {
            reading_.warnings.add(channel.place(),
                                  "animates what another channel of the clip animates: the last one is used");
            tracks[known->second] = std::move(track);
        }
    }

    void ignore(const JsonView& channel, const std::string& why) { reading_.warnings.add(channel.place(), why); }

    Reading& reading_;
    JsonView samplers_;
    size_t node_count_;
    AssetClip clip_;
    std::map<std::pair<uint32_t, TrackTarget>, size_t> track_of_;
    std::map<uint32_t, size_t> morph_track_of_;  // by node
    std::set<std::string> counted_samplers_;     // by place
    uint64_t key_count_ = 0, back_count_ = 0, doubled_count_ = 0;
    std::string first_mended_;  // place of the first sampler's times that were mended
};

}  // namespace

void read_clips(Reading& reading, Asset& asset) {
    const JsonView animations = reading.root.optional_array("animations");
    reading.budget.charge(animations.size(), sizeof(AssetClip), animations.place());
    asset.clips.reserve(animations.size());
    for (size_t i = 0; i < animations.size(); ++i)
        asset.clips.push_back(ClipReader(reading, animations[i], asset.nodes.size()).take());
}

}  // namespace throng::gltf
