// Clips of another file, for the nodes that have the same names.
#include <throng/asset.h>

#include "base/failure.h"
#include "base/find_name.h"
#include "compile/asset_check.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

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

enum class NameForm { kExact, kLoose, kWithoutPrefix, kWithoutNumber };

// Names as they are compared.
class Names {
public:
    // `is_chosen`: the nodes that matter, of which a prefix may be common to all.
    Names(const Asset& asset, const std::vector<bool>& is_chosen) : asset_(asset) {
        bool is_first = true;
        for (uint32_t node = 0; node < is_chosen.size(); ++node) {
            if (!is_chosen[node]) continue;
            const std::string name = loose_name(asset.nodes[node].name);
            if (std::exchange(is_first, false)) prefix_ = name;
            prefix_.erase(std::ranges::mismatch(prefix_, name).in1, prefix_.end());
        }
    }
    std::string of(uint32_t node, NameForm form) const {
        const std::string& name = asset_.nodes[node].name;
        if (form == NameForm::kExact) return name;
        // Sketchfab numbers nodes: "Hips_03".
        const size_t last = name.find_last_not_of("0123456789");
        const bool is_numbered = last != name.npos && last + 1 < name.size() && name[last] == '_';
        const bool cuts_number = form == NameForm::kWithoutNumber && is_numbered;
        const std::string loose = loose_name(cuts_number ? name.substr(0, last) : name);
        return form != NameForm::kLoose && loose.starts_with(prefix_) ? loose.substr(prefix_.size()) : loose;
    }

private:
    const Asset& asset_;
    std::string prefix_;  // three.js writes "mixamorig:Hips" as "mixamorigHips"
};

// [node of `to`] The node of `from` that has its name, or kNone. Joints and what is animated come first. One node moves
// all that have its name, as where clothes have a skeleton of their own; of several with one name each moves one.
std::vector<uint32_t> find_sources(const Asset& from, const std::vector<bool>& is_animated, const Asset& to,
                                   const std::vector<bool>& is_joint) {
    struct Step {
        NameForm from, to;
        bool is_unique = true;  // names that several have in this form tell nothing
    };
    constexpr std::array kSteps{Step{NameForm::kExact, NameForm::kExact, false},
                                Step{NameForm::kLoose, NameForm::kLoose, false},
                                Step{NameForm::kWithoutPrefix, NameForm::kWithoutPrefix},
                                Step{NameForm::kWithoutNumber, NameForm::kWithoutPrefix},
                                Step{NameForm::kWithoutPrefix, NameForm::kWithoutNumber}};
    const Names from_names(from, is_animated), to_names(to, is_joint);
    std::vector<uint32_t> sources(to.nodes.size(), kNone);
    std::vector<bool> is_taken(from.nodes.size(), false);
    using NodesByName = std::unordered_map<std::string, std::vector<uint32_t>>;
    for (const Step& step : kSteps) {
        const auto by_name = [](const Names& names, NameForm form, const std::vector<bool>& comes_first,
                                const auto& is_free) {
            NodesByName nodes;
            for (const bool first : {true, false})
                for (uint32_t node = 0; node < comes_first.size(); ++node)
                    if (comes_first[node] == first && is_free(node)) nodes[names.of(node, form)].push_back(node);
            return nodes;
        };
        const NodesByName there = by_name(from_names, step.from, is_animated,
                                          [&](uint32_t node) { return !is_taken[node]; }),
                          wanted = by_name(to_names, step.to, is_joint,
                                           [&](uint32_t node) { return sources[node] == kNone; });
        for (const auto& [name, nodes] : wanted) {
            const auto found = there.find(name);
            if (name.empty() || found == there.end()) continue;
            const std::vector<uint32_t>& named = found->second;
            if (step.is_unique && (nodes.size() > 1 || named.size() > 1)) continue;
            for (size_t i = 0; i < nodes.size(); ++i) {
                const bool is_another = named.size() == 1 && i > 0;
                if (is_another ? !is_joint[nodes[i]] : i >= named.size()) break;
                sources[nodes[i]] = named[is_another ? 0 : i];
                is_taken[sources[nodes[i]]] = true;
            }
        }
    }
    return sources;
}

size_t components(const AssetTrack& track) { return track.target == TrackTarget::kRotation ? 4 : 3; }

bool is_tangent(const AssetTrack& track, size_t value) {
    return track.interpolation == Interpolation::kCubicSpline && value % 3 != 1;
}

Vec3<double> vector_of(const float* value) { return {value[0], value[1], value[2]}; }

// Calls visit(value) for each key.
template <class Visit>
void for_each_key(const AssetTrack& track, const Visit& visit) {
    const size_t width = components(track);
    for (size_t i = 0; i < track.values.size() / width; ++i)
        if (!is_tangent(track, i)) visit(&track.values[i * width]);
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
    bool holds = true;
    for_each_key(track, [&](const float* value) {
        const bool is_negative = track.target == TrackTarget::kRotation && !differs(value, -1);  // the same rotation
        holds = holds && (!differs(value, 1) || is_negative);
    });
    return holds;
}

Quaternion<double> conjugate(const Quaternion<double>& q) { return {-q.x, -q.y, -q.z, q.w}; }

Vec3<double> rotated(const Quaternion<double>& q, const Vec3<double>& v) {
    const Quaternion<double> out = q * Quaternion<double>{v.x, v.y, v.z, 0} * conjugate(q);
    return {out.x, out.y, out.z};
}

// model_from_node, of scales that are the same along all axes, or nearly so.
struct Frame {
    Quaternion<double> rotation{};
    Vec3<double> origin{};
    double scale = 1;

    Frame child(const Quaternion<double>& q, const Vec3<double>& t, const Vec3<double>& s) const {
        return {normalized(rotation * q), origin + rotated(rotation, t * scale),
                scale * std::cbrt(std::abs(s.x * s.y * s.z))};
    }
};

std::vector<uint32_t> parents_first(const Asset& asset) {
    std::vector<std::vector<uint32_t>> children(asset.nodes.size());
    std::vector<uint32_t> order;
    for (uint32_t node = 0; node < asset.nodes.size(); ++node) {
        const uint32_t parent = asset.nodes[node].parent;
        (parent == kNone ? order : children[parent]).push_back(node);
    }
    for (size_t i = 0; i < order.size(); ++i)
        for (const uint32_t child : children[order[i]]) order.push_back(child);
    return order;
}

// [node] In the rest pose.
std::vector<Frame> rest_frames(const Asset& asset) {
    std::vector<Frame> frames(asset.nodes.size());
    for (const uint32_t node : parents_first(asset)) {
        const auto& [q, t, s] = asset.nodes[node].parent_from_node;
        const uint32_t parent = asset.nodes[node].parent;
        frames[node] = (parent == kNone ? Frame() : frames[parent]).child(q, t, s);
    }
    return frames;
}

// What the clips do to a node.
struct Animated {
    bool moves = false;  // away from its rest pose
    bool has_rotation = false, has_translation = false, has_morphs = false;
    bool changes_length = false;  // its distance to its parent is not that of a bone
};

std::vector<Animated> animated_nodes(const Asset& asset) {
    constexpr double kSamePlace = 0.01;  // as a part of the distance
    std::vector<Animated> nodes(asset.nodes.size());
    for (const AssetClip& clip : asset.clips) {
        for (const AssetTrack& track : clip.tracks) {
            Animated& node = nodes[track.node];
            node.moves = node.moves || !holds_rest(asset, track);
            node.has_rotation = node.has_rotation || track.target == TrackTarget::kRotation;
            if (track.target != TrackTarget::kTranslation) continue;
            node.has_translation = true;
            const bool is_cubic = track.interpolation == Interpolation::kCubicSpline;
            const Vec3<double> first = vector_of(&track.values[is_cubic ? 3 : 0]);
            for_each_key(track, [&](const float* value) {
                const double way = length(vector_of(value) - first);
                node.changes_length = node.changes_length || way > kSamePlace * length(first);
            });
        }
        for (const AssetMorphTrack& track : clip.morph_tracks)
            nodes[track.node].moves = nodes[track.node].has_morphs = true;
    }
    return nodes;
}

// What keys of a node of `from` become on a node of `to`: a translation base + turn (translation - old_rest) scale.
struct NodeChange {
    bool is_turned = false;
    Quaternion<double> turn{};  // new_parent_from_old_parent
    double scale = 1;
    Vec3<double> old_rest{}, base{};

    bool keeps_translations() const {
        return !is_turned && scale == 1 && old_rest == Vec3<double>() && base == Vec3<double>();
    }
};

class ClipAdder {
public:
    ClipAdder(const Asset& from, const Asset& to)
        : from_(from),
          to_(to),
          animated_(animated_nodes(from)),
          is_joint_(joints_of(to)),
          changes_(to.nodes.size()),
          targets_(from.nodes.size()) {
        std::vector<bool> moves;
        for (const Animated& node : animated_) moves.push_back(node.moves);
        sources_ = find_sources(from, moves, to, is_joint_);
        for (uint32_t node = 0; node < sources_.size(); ++node)
            if (sources_[node] != kNone) targets_[sources_[node]].push_back(node);
        old_frames_ = rest_frames(from);
        frames_ = rest_frames(to);
        compare_bones();
        for (const uint32_t node : parents_first(to)) find_change(node);
    }

    // The clips as they are on `to`, without those that nothing is left of.
    std::vector<AssetClip> clips() const {
        std::vector<AssetClip> out;
        for (const AssetClip& clip : from_.clips) {
            AssetClip changed{.name = clip.name, .duration_s = clip.duration_s};
            for (const AssetTrack& track : clip.tracks) {
                const bool holds = holds_rest(from_, track);
                for (const uint32_t node : targets_[track.node])
                    if (!holds || is_joint_[node]) changed.tracks.push_back(changed_track(track, node, holds));
            }
            for (const AssetMorphTrack& track : clip.morph_tracks)
                for (const uint32_t node : targets_[track.node])
                    if (has_same_targets(track.node, node)) {
                        changed.morph_tracks.push_back(track);
                        changed.morph_tracks.back().node = node;
                    }
            if (!changed.tracks.empty() || !changed.morph_tracks.empty()) out.push_back(std::move(changed));
        }
        return out;
    }

    // "2 of its 40 animated nodes ('tail', 'wing')", those that move nothing; nothing where there are none.
    std::string without_target() const {
        constexpr size_t kShown = 5;
        std::string list;
        size_t count = 0, animated_count = 0;
        for (uint32_t node = 0; node < targets_.size(); ++node) {
            if (!animated_[node].moves) continue;
            ++animated_count;
            const bool has_morphs = animated_[node].has_morphs &&
                                    std::ranges::none_of(targets_[node], [&](uint32_t target) {
                                        return has_same_targets(node, target);
                                    });
            if ((!targets_[node].empty() && !has_morphs) || count++ >= kShown) continue;
            const std::string& name = from_.nodes[node].name;
            list += joined(list.empty() ? "" : ", ", name.empty() ? "one without a name" : "'" + printable(name) + "'");
            if (has_morphs) list += joined(" with ", target_count(from_, node), " morph targets");
        }
        if (count == 0) return {};
        return joined(count, " of its ", animated_count, " animated nodes (", list,
                      count > kShown ? joined(" and ", count - kShown, " more") : "", ")");
    }

    // A few names of what there is, for a message.
    std::string some_joints() const {
        constexpr size_t kShown = 3;
        std::string list;
        for (uint32_t node = 0, count = 0; node < is_joint_.size() && count < kShown; ++node)
            if (is_joint_[node] && ++count > 0)
                list += joined(list.empty() ? "'" : ", '", printable(to_.nodes[node].name), "'");
        return list;
    }

private:
    // A joint that hangs on a joint.
    bool is_bone(uint32_t node) const {
        const uint32_t parent = to_.nodes[node].parent;
        return is_joint_[node] && parent != kNone && is_joint_[parent];
    }

    static double parent_scale(const Asset& asset, const std::vector<Frame>& frames, uint32_t node) {
        const uint32_t parent = asset.nodes[node].parent;
        return parent == kNone ? 1 : frames[parent].scale;
    }
    double old_length(uint32_t node) const {
        return length(from_.nodes[node].parent_from_node.translation) * parent_scale(from_, old_frames_, node);
    }
    double new_length(uint32_t node) const {
        return length(to_.nodes[node].parent_from_node.translation) * parent_scale(to_, frames_, node);
    }
    bool is_as_long(uint32_t node) const {
        constexpr double kSameLength = 0.01;  // exporters round less
        const double old_one = old_length(sources_[node]), new_one = new_length(node);
        return std::abs(old_one - new_one) <= kSameLength * std::max(old_one, new_one);
    }

    // Bones keep their length in nearly all clips, so rest poses tell it even where one is a frame of a clip.
    void compare_bones() {
        constexpr double kMostBones = 0.9;  // hips and faces move
        size_t count = 0, same_count = 0;
        double old_sum = 0, new_sum = 0;
        for (uint32_t node = 0; node < sources_.size(); ++node) {
            const uint32_t source = sources_[node];
            if (source == kNone || !is_bone(node)) continue;
            const uint32_t old_parent = from_.nodes[source].parent;
            if (old_parent == kNone || sources_[to_.nodes[node].parent] != old_parent) continue;
            ++count;
            same_count += is_as_long(node);
            old_sum += old_length(source);
            new_sum += new_length(node);
        }
        is_same_skeleton_ = static_cast<double>(same_count) >= kMostBones * static_cast<double>(count);
        if (same_count < count && old_sum > 0 && new_sum > 0) size_ratio_ = new_sum / old_sum;
    }

    // After those of its ancestors, whose frames then are those that they have while `from` rests: joints are turned in
    // model space as in `from`, whatever holds them.
    void find_change(uint32_t node) {
        constexpr double kRounding = 1e-5;
        const uint32_t parent = to_.nodes[node].parent, source = sources_[node];
        const Frame frame = parent == kNone ? Frame() : frames_[parent];
        auto [rotation, translation, scale] = to_.nodes[node].parent_from_node;
        if (source != kNone) {
            const AssetNode& old_node = from_.nodes[source];
            const Frame old_frame = old_node.parent == kNone ? Frame() : old_frames_[old_node.parent];
            NodeChange& change = changes_[node];
            change.turn = conjugate(frame.rotation) * old_frame.rotation;
            change.is_turned = length(Vec3<double>{change.turn.x, change.turn.y, change.turn.z}) > kRounding;
            if (!change.is_turned) change.turn = {};
            const double unit = frame.scale > 0 && old_frame.scale > 0 ? old_frame.scale / frame.scale : 1;
            change.scale = unit * size_ratio_;
            if (is_bone(node)) {
                const bool is_below_root = !is_bone(parent);
                if (is_as_long(node)) {
                    change.scale = unit;
                } else if (!animated_[source].changes_length || !(is_same_skeleton_ || is_below_root)) {
                    change.old_rest = old_node.parent_from_node.translation;
                    change.base = translation;
                }
            } else if (frame.scale > 0) {
                const Vec3<double> way = old_frame.origin * size_ratio_ - frame.origin;
                if (length(way) > kRounding * std::max(length(frame.origin), length(old_frame.origin)))
                    change.base = rotated(conjugate(frame.rotation), way) * (1 / frame.scale);
            }
            if (std::abs(change.scale - 1) < kRounding) change.scale = 1;
            const bool is_carried = is_joint_[node] || animated_[source].moves;
            if (is_carried && animated_[source].has_rotation)
                rotation = change.turn * old_node.parent_from_node.rotation;
            if (is_carried && animated_[source].has_translation)
                translation = changed(change, old_node.parent_from_node.translation);
        }
        frames_[node] = frame.child(rotation, translation, scale);
    }

    static Vec3<double> changed(const NodeChange& change, const Vec3<double>& translation) {
        return change.base + rotated(change.turn, (translation - change.old_rest) * change.scale);
    }

    AssetTrack changed_track(const AssetTrack& track, uint32_t node, bool holds) const {
        AssetTrack out = track;
        out.node = node;
        const NodeChange& change = changes_[node];
        const size_t width = components(track);
        const auto set = [&](size_t i, const auto&... parts) {
            size_t c = i * width;
            ((out.values[c++] = static_cast<float>(parts)), ...);
        };
        for (size_t i = 0; i < out.values.size() / width; ++i) {
            const float* value = &track.values[i * width];
            if (track.target == TrackTarget::kTranslation && !change.keeps_translations()) {
                const Vec3<double> t = is_tangent(track, i) ? rotated(change.turn, vector_of(value) * change.scale)
                                                            : changed(change, vector_of(value));
                set(i, t.x, t.y, t.z);
            } else if (track.target == TrackTarget::kRotation && change.is_turned) {
                const auto q = change.turn * Quaternion<double>{value[0], value[1], value[2], value[3]};
                set(i, q.x, q.y, q.z, q.w);
            } else if (track.target == TrackTarget::kScale && holds && !is_tangent(track, i) &&
                       length(vector_of(value)) > 0) {
                const Vec3<double>& s = to_.nodes[node].parent_from_node.scale;  // which may be that of a unit
                set(i, s.x, s.y, s.z);
            }
        }
        return out;
    }

    static size_t target_count(const Asset& asset, uint32_t node) {
        size_t count = 0;
        for (const AssetMeshInstance& instance :
             std::ranges::equal_range(asset.mesh_instances, node, {}, &AssetMeshInstance::node))
            count = std::max(count, asset.meshes[instance.mesh].weights.size());
        return count;
    }
    bool has_same_targets(uint32_t source, uint32_t node) const {
        const size_t count = target_count(from_, source);
        return count > 0 && count == target_count(to_, node);
    }

    const Asset &from_, &to_;
    std::vector<Animated> animated_;  // [node of `from`]
    std::vector<bool> is_joint_;      // [node of `to`]
    std::vector<uint32_t> sources_;   // [node of `to`]
    std::vector<NodeChange> changes_;
    std::vector<std::vector<uint32_t>> targets_;  // [node of `from`]
    std::vector<Frame> old_frames_, frames_;
    bool is_same_skeleton_ = true;
    double size_ratio_ = 1;  // mean length of bones in `to` over that in `from`
};

// Files of Mixamo and of FBX name all of their clips so.
bool says_nothing(std::string_view name) {
    return name.empty() || name.find("Take 001") != name.npos || name.find("mixamo.com") != name.npos;
}

// "walk" of "moves/walk.glb".
std::string stem_of(const std::string& file) {
    const std::string name = file.substr(file.find_last_of("/\\") + 1), stem = name.substr(0, name.rfind('.'));
    return stem.empty() ? "clip" : stem;
}

// What a clip is called beside those in `names`; `stem` is the name of its file without extension.
std::string free_name(const std::string& name, const std::string& stem, const std::unordered_set<std::string>& names) {
    if (!says_nothing(name) && !names.contains(name)) return name;
    const std::string base = says_nothing(name) ? stem : stem + " " + name;
    std::string numbered = base;
    for (uint32_t number = 2; names.contains(numbered); ++number) numbered = joined(base, " ", number);
    return numbered;
}

// Those of `from` that tell of its clips, and are not there yet.
std::vector<std::string> new_warnings(const Asset& asset, const Asset& from) {
    const std::unordered_set<std::string> there(asset.warnings.begin(), asset.warnings.end());
    std::vector<std::string> out;
    std::ranges::copy_if(from.warnings, std::back_inserter(out), [&](const std::string& line) {
        return !there.contains(line) && (line.find(": animations[") != line.npos || line.find(": nodes[") != line.npos);
    });
    return out;
}

}  // namespace

Result<void> add_clips(Asset& asset, const Asset& from) {
    return as_result(
        [&] {
            check_rig(asset);
            check_asset(from);
            if (from.clips.empty()) refuse(from.name, "has no clips to add to ", asset.name);
            const ClipAdder adder(from, asset);
            std::vector<AssetClip> clips = adder.clips();
            std::vector<std::string> warnings = new_warnings(asset, from);
            const std::string without = adder.without_target();
            if (clips.empty())
                refuse(from.name, without.empty() ? "its clips move nothing" : without, " are not in ", asset.name,
                       ", which has ", adder.some_joints(), ", …: clips are added to nodes of the same names");
            if (!without.empty()) warnings.push_back(joined(from.name, ": ", without, " are not in ", asset.name));
            std::unordered_set<std::string> names;
            for (const AssetClip& clip : asset.clips) names.insert(clip.name);
            for (AssetClip& clip : clips) {
                clip.name = free_name(clip.name, stem_of(from.name), names);
                names.insert(clip.name);
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
