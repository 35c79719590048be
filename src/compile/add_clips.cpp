// Clips of another file, for the nodes that have the same names.
#include <throng/asset.h>

#include "base/failure.h"
#include "base/find_name.h"
#include "compile/asset_check.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numeric>
#include <unordered_map>

namespace throng {
namespace {

// "mixamorig:Left Hand" as "lefthand": exporters put a namespace in front of names, and take characters out of them.
std::string loose_name(std::string_view name) {
    std::string out;
    for (const char c : name.substr(name.rfind(':') + 1)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte >= 0x80 || std::isalnum(byte)) out += static_cast<char>(std::tolower(byte));
    }
    return out;
}

// Joints of skins; all nodes, where there is no skin.
std::vector<bool> joints_of(const Asset& asset) {
    std::vector<bool> is_joint(asset.nodes.size(), asset.skins.empty());
    for (const AssetSkin& skin : asset.skins)
        for (const uint32_t node : skin.joints) is_joint[node] = true;
    return is_joint;
}

size_t components(const AssetTrack& track) { return track.target == TrackTarget::kRotation ? 4 : 3; }

bool is_tangent(const AssetTrack& track, size_t value) {
    return track.interpolation == Interpolation::kCubicSpline && value % 3 != 1;
}

// Whether its node stays in its rest pose, as far as exporters' rounding goes.
bool holds_rest(const Asset& asset, const AssetTrack& track) {
    constexpr double kRounding = 1e-4;
    const auto& [q, t, s] = asset.nodes[track.node].parent_from_node;
    std::array<double, 4> rest{q.x, q.y, q.z, q.w};
    if (track.target == TrackTarget::kTranslation) rest = {t.x, t.y, t.z, 0};
    if (track.target == TrackTarget::kScale) rest = {s.x, s.y, s.z, 0};
    const size_t width = components(track);
    const auto differs = [&](const float* value, double sign) {
        double difference = 0, size = 1;
        for (size_t c = 0; c < width; ++c) {
            difference = std::max(difference, std::abs(sign * value[c] - rest[c]));
            size = std::max(size, std::abs(rest[c]));
        }
        return difference > kRounding * size;
    };
    for (size_t i = 0; i < track.values.size() / width; ++i) {
        const float* value = &track.values[i * width];
        if (is_tangent(track, i) || !differs(value, 1)) continue;
        if (track.target != TrackTarget::kRotation || differs(value, -1)) return false;  // -q is the rotation of q
    }
    return true;
}

// Moved away from their rest pose by some clip.
std::vector<bool> animated_nodes(const Asset& asset) {
    std::vector<bool> is_animated(asset.nodes.size(), false);
    for (const AssetClip& clip : asset.clips) {
        for (const AssetTrack& track : clip.tracks)
            if (!holds_rest(asset, track)) is_animated[track.node] = true;
        for (const AssetMorphTrack& track : clip.morph_tracks) is_animated[track.node] = true;
    }
    return is_animated;
}

std::vector<bool> nodes_with_morph_tracks(const Asset& asset) {
    std::vector<bool> has_track(asset.nodes.size(), false);
    for (const AssetClip& clip : asset.clips)
        for (const AssetMorphTrack& track : clip.morph_tracks) has_track[track.node] = true;
    return has_track;
}

// Those that are chosen, then the others.
std::vector<uint32_t> first_of_all(const std::vector<bool>& is_chosen) {
    std::vector<uint32_t> nodes(is_chosen.size());
    std::iota(nodes.begin(), nodes.end(), 0u);
    std::ranges::stable_partition(nodes, [&](uint32_t node) { return is_chosen[node]; });
    return nodes;
}

// [node of `from`] The node of `to` with its name, or kNone; each at most once. Where several have one name, joints and
// what is animated come first.
std::vector<uint32_t> matched_nodes(const Asset& from, const std::vector<bool>& is_animated, const Asset& to,
                                    const std::vector<bool>& is_joint) {
    std::vector<uint32_t> match(from.nodes.size(), kNone);
    std::vector<bool> is_taken(to.nodes.size(), false);
    for (const bool exact : {true, false}) {
        const auto key = [&](const AssetNode& node) { return exact ? node.name : loose_name(node.name); };
        std::unordered_map<std::string, uint32_t> free;
        for (const uint32_t node : first_of_all(is_joint))
            if (!is_taken[node] && !key(to.nodes[node]).empty()) free.emplace(key(to.nodes[node]), node);
        for (const uint32_t node : first_of_all(is_animated)) {
            const auto found = free.find(key(from.nodes[node]));
            if (match[node] != kNone || found == free.end() || is_taken[found->second]) continue;
            match[node] = found->second;
            is_taken[found->second] = true;
        }
    }
    return match;
}

Quaternion<double> conjugate(const Quaternion<double>& q) { return {-q.x, -q.y, -q.z, q.w}; }

Quaternion<double> model_rotation(const Asset& asset, uint32_t node) {
    Quaternion<double> rotation;
    for (; node != kNone; node = asset.nodes[node].parent)
        rotation = asset.nodes[node].parent_from_node.rotation * rotation;
    return rotation;
}

// What keys of one node of `from` become on its match.
struct NodeChange {
    // Of translations. All but the roots of skeletons go by their rest pose, where the skeletons differ.
    double scale = 1;
    Vec3<double> old_rest{}, new_rest{};
    // Of roots, whose ancestors may be turned in another way: new_parent_from_old_parent
    bool is_turned = false;
    Quaternion<double> turn{};
};

class ClipAdder {
public:
    ClipAdder(const Asset& from, const Asset& to)
        : from_(from),
          to_(to),
          is_animated_(animated_nodes(from)),
          has_morph_track_(nodes_with_morph_tracks(from)),
          is_joint_(joints_of(to)),
          match_(matched_nodes(from, is_animated_, to, is_joint_)) {
        compare_bones();
    }

    // The clips as they are on `to`, without those that nothing is left of.
    std::vector<AssetClip> clips() const {
        std::vector<AssetClip> out;
        for (const AssetClip& clip : from_.clips) {
            AssetClip changed{.name = clip.name, .duration_s = clip.duration_s};
            for (const AssetTrack& track : clip.tracks)
                if (is_of_use(track)) changed.tracks.push_back(changed_track(track));
            for (const AssetMorphTrack& track : clip.morph_tracks) {
                if (!has_same_targets(track.node)) continue;
                changed.morph_tracks.push_back(track);
                changed.morph_tracks.back().node = match_[track.node];
            }
            if (!changed.tracks.empty() || !changed.morph_tracks.empty()) out.push_back(std::move(changed));
        }
        return out;
    }

    // What is animated and has no match, the first few; nothing where all have one.
    std::string without_match() const {
        constexpr size_t kShown = 5;
        std::string list;
        size_t count = 0;
        for (uint32_t node = 0; node < match_.size(); ++node) {
            const bool has_morphs = has_morph_track_[node] && !has_same_targets(node);
            if (!is_animated_[node] || (match_[node] != kNone && !has_morphs) || count++ >= kShown) continue;
            list += joined(list.empty() ? "'" : ", '", printable(from_.nodes[node].name), "'");
            if (has_morphs) list += joined(" (", target_count(from_, node), " morph targets)");
        }
        return count > kShown ? joined(list, " and ", count - kShown, " more") : list;
    }

private:
    // What holds a skeleton may be turned and scaled in another way than in `from`, and stays as it is.
    bool is_of_use(const AssetTrack& track) const {
        const uint32_t match = match_[track.node];
        return match != kNone && (is_joint_[match] || !holds_rest(from_, track));
    }

    // Whether it hangs on a joint as its match does, so that the distance between the two is the length of a bone.
    bool is_bone(uint32_t node) const {
        const uint32_t match = match_[node], parent = from_.nodes[node].parent;
        if (match == kNone || parent == kNone || !is_joint_[match]) return false;
        const uint32_t new_parent = to_.nodes[match].parent;
        return new_parent != kNone && is_joint_[new_parent] && match_[parent] == new_parent;
    }

    // Bones keep their length in nearly all clips, so the rest pose tells it even where it is a frame of a clip.
    void compare_bones() {
        constexpr double kSameLength = 0.01;  // as a part of the mean length; exporters round less
        constexpr double kMostBones = 0.9;    // hips and faces move, and a rest pose may be a frame of a clip
        std::vector<double> differences;
        double old_sum = 0, new_sum = 0;
        for (uint32_t node = 0; node < match_.size(); ++node) {
            if (!is_bone(node)) continue;
            const Vec3<double>& old_rest = from_.nodes[node].parent_from_node.translation;
            const Vec3<double>& new_rest = to_.nodes[match_[node]].parent_from_node.translation;
            differences.push_back(length(new_rest - old_rest));
            old_sum += length(old_rest);
            new_sum += length(new_rest);
        }
        const auto count = static_cast<double>(differences.size());
        const auto same = std::ranges::count_if(
            differences, [&](double difference) { return difference * count <= kSameLength * new_sum; });
        is_same_skeleton_ = static_cast<double>(same) >= kMostBones * count;
        if (!is_same_skeleton_ && old_sum > 0 && new_sum > 0) scale_ = new_sum / old_sum;
    }

    NodeChange change_of(uint32_t node) const {
        NodeChange change;
        if (!is_same_skeleton_) change.scale = scale_;
        if (is_bone(node)) {
            if (is_same_skeleton_) return change;
            change.old_rest = from_.nodes[node].parent_from_node.translation;
            change.new_rest = to_.nodes[match_[node]].parent_from_node.translation;
            return change;
        }
        const auto has_ancestor = [](const Asset& asset, uint32_t child, const std::vector<bool>& among) {
            uint32_t up = asset.nodes[child].parent;
            while (up != kNone && !among[up]) up = asset.nodes[up].parent;
            return up != kNone;
        };
        if (has_ancestor(from_, node, is_animated_) || has_ancestor(to_, match_[node], is_joint_)) return change;
        constexpr double kRounding = 1e-5;
        change.turn = conjugate(model_rotation(to_, to_.nodes[match_[node]].parent)) *
                      model_rotation(from_, from_.nodes[node].parent);
        const Vec3<double> axis{change.turn.x, change.turn.y, change.turn.z};
        change.is_turned = length(axis) > kRounding;
        return change;
    }

    AssetTrack changed_track(const AssetTrack& track) const {
        AssetTrack out = track;
        out.node = match_[track.node];
        const NodeChange change = change_of(track.node);
        const size_t width = components(track);
        for (size_t i = 0; i < out.values.size() / width; ++i) {
            float* value = &out.values[i * width];
            if (track.target == TrackTarget::kTranslation) change_translation(change, is_tangent(track, i), value);
            if (track.target == TrackTarget::kRotation && change.is_turned) {
                const auto q = change.turn * Quaternion<double>{value[0], value[1], value[2], value[3]};
                for (size_t c = 0; const double part : {q.x, q.y, q.z, q.w}) value[c++] = static_cast<float>(part);
            }
        }
        return out;
    }

    static void change_translation(const NodeChange& change, bool is_tangent, float* value) {
        Vec3<double> t{value[0], value[1], value[2]};
        if (!is_tangent) t = t - change.old_rest;
        t = t * change.scale;
        if (change.is_turned) {
            const Quaternion<double> turned = change.turn * Quaternion<double>{t.x, t.y, t.z, 0} *
                                              conjugate(change.turn);
            t = {turned.x, turned.y, turned.z};
        }
        if (!is_tangent) t = t + change.new_rest;
        for (size_t c = 0; const double part : {t.x, t.y, t.z}) value[c++] = static_cast<float>(part);
    }

    static size_t target_count(const Asset& asset, uint32_t node) {
        size_t count = 0;
        for (const AssetMeshInstance& instance : asset.mesh_instances)
            if (instance.node == node) count = std::max(count, asset.meshes[instance.mesh].weights.size());
        return count;
    }

    bool has_same_targets(uint32_t node) const {
        return match_[node] != kNone && target_count(from_, node) > 0 &&
               target_count(from_, node) == target_count(to_, match_[node]);
    }

    const Asset &from_, &to_;
    std::vector<bool> is_animated_, has_morph_track_;  // of `from`
    std::vector<bool> is_joint_;                       // of `to`
    std::vector<uint32_t> match_;
    bool is_same_skeleton_ = true;
    double scale_ = 1;  // mean length of new bones over that of old ones
};

// Files of Mixamo and of FBX name all of their clips so.
bool says_nothing(std::string_view name) {
    return name.empty() || name == "Take 001" || name.find("mixamo.com") != name.npos;
}

// What a clip is called beside those in `names`; `stem` is the name of its file without extension.
std::string free_name(const std::string& name, const std::string& stem, const std::vector<std::string>& names) {
    const auto is_free = [&](const std::string& wanted) { return find_name(names, wanted) == kNone; };
    if (!says_nothing(name) && is_free(name)) return name;
    const std::string base = says_nothing(name) ? stem : stem + " " + name;
    std::string numbered = base;
    for (uint32_t number = 2; !is_free(numbered); ++number) numbered = joined(base, " ", number);
    return numbered;
}

}  // namespace

Result<void> add_clips(Asset& asset, const Asset& from) {
    return as_result(
        [&] {
            check_asset(asset);
            check_asset(from);
            if (from.clips.empty()) refuse(from.name, "has no clips to add to ", asset.name);
            const ClipAdder adder(from, asset);
            std::vector<AssetClip> clips = adder.clips();
            std::vector<std::string> warnings = from.warnings, names;
            const std::string without = adder.without_match();
            if (clips.empty())
                refuse(from.name, "its clips animate ", without.empty() ? "nothing" : without, ", and ", asset.name,
                       " has no such nodes: clips are added to nodes of the same names");
            if (!without.empty())
                warnings.push_back(
                    joined(from.name, ": its clips also animate ", without, ", which ", asset.name, " does not have"));
            for (const AssetClip& clip : asset.clips) names.push_back(clip.name);
            for (AssetClip& clip : clips) {
                clip.name = free_name(clip.name, from.name.substr(0, from.name.rfind('.')), names);
                names.push_back(clip.name);
            }
            // Room first: after that nothing fails half-way.
            asset.clips.reserve(asset.clips.size() + clips.size());
            asset.warnings.reserve(asset.warnings.size() + warnings.size());
            std::ranges::move(clips, std::back_inserter(asset.clips));
            std::ranges::move(warnings, std::back_inserter(asset.warnings));
        },
        from.name);
}

}  // namespace throng
