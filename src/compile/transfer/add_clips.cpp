// Clips of another file, for the nodes that have the same names.
#include <throng/asset.h>

#include "base/failure.h"
#include "compile/asset_check.h"
#include "compile/transfer/rig_transfer.h"

#include <algorithm>
#include <iterator>
#include <unordered_set>

namespace throng {
namespace {

size_t target_count(const Asset& asset, uint32_t node) {
    size_t count = 0;
    for (const AssetMeshInstance& instance :
         std::ranges::equal_range(asset.mesh_instances, node, {}, &AssetMeshInstance::node))
        count = std::max(count, asset.meshes[instance.mesh].weights.size());
    return count;
}

class ClipAdder {
public:
    ClipAdder(const Asset& from, const Asset& to) : from_(from), to_(to), transfer_(from, to) {}

    // The clips as they apply to `to`, without those of which nothing is left.
    std::vector<AssetClip> clips() const {
        std::vector<AssetClip> out;
        for (const AssetClip& clip : from_.clips) {
            AssetClip changed{.name = clip.name, .duration_s = clip.duration_s};
            for (const AssetTrack& track : clip.tracks) {
                const bool holds = holds_rest(from_, track);
                for (const uint32_t node : transfer_.targets(track.node))
                    if (transfer_.takes(node, holds)) changed.tracks.push_back(changed_track(track, node, holds));
            }
            for (const AssetMorphTrack& track : clip.morph_tracks)
                for (const uint32_t node : transfer_.targets(track.node))
                    if (has_same_targets(track.node, node)) {
                        changed.morph_tracks.push_back(track);
                        changed.morph_tracks.back().node = node;
                    }
            if (!changed.tracks.empty() || !changed.morph_tracks.empty()) out.push_back(std::move(changed));
        }
        return out;
    }

    // "2 of its 40 animated nodes ('tail', 'wing')": those that move nothing; empty if there are none.
    std::string without_target() const {
        constexpr size_t kShown = 5;
        std::string list;
        size_t count = 0, animated_count = 0;
        for (uint32_t node = 0; node < from_.nodes.size(); ++node) {
            if (!transfer_.animated(node).moves) continue;
            ++animated_count;
            const bool has_morphs = transfer_.animated(node).has_morphs &&
                                    std::ranges::none_of(transfer_.targets(node), [&](uint32_t target) {
                                        return has_same_targets(node, target);
                                    });
            if ((!transfer_.targets(node).empty() && !has_morphs) || count++ >= kShown) continue;
            const std::string& name = from_.nodes[node].name;
            list += joined(list.empty() ? "" : ", ", name.empty() ? "one without a name" : "'" + printable(name) + "'");
            if (has_morphs) list += joined(" with ", target_count(from_, node), " morph targets");
        }
        if (count == 0) return {};
        return joined(count, " of its ", animated_count, " animated nodes (", list,
                      count > kShown ? joined(" and ", count - kShown, " more") : "", ")");
    }

    // The first joints of `to`, so that a message shows how its names look.
    std::string some_joints() const {
        constexpr size_t kShown = 3;
        std::string list;
        size_t count = 0;
        for (uint32_t node = 0; node < to_.nodes.size() && count < kShown; ++node) {
            if (!transfer_.is_joint(node)) continue;
            list += joined(count == 0 ? "'" : ", '", printable(to_.nodes[node].name), "'");
            ++count;
        }
        return list;
    }

private:
    AssetTrack changed_track(const AssetTrack& track, uint32_t node, bool holds) const {
        AssetTrack out = track;
        out.node = node;
        const NodeChange& change = transfer_.change(node);
        const size_t width = components(track);
        const auto set = [&](size_t i, const auto&... parts) {
            size_t c = i * width;
            ((out.values[c++] = static_cast<float>(parts)), ...);
        };
        for (size_t i = 0; i < out.values.size() / width; ++i) {
            const float* value = &track.values[i * width];
            if (track.target == TrackTarget::kTranslation && !change.keeps_translations()) {
                const Vec3<double> t = is_tangent(track, i) ? change.way(vector_of(value))
                                                            : change.translation(vector_of(value));
                set(i, t.x, t.y, t.z);
            } else if (track.target == TrackTarget::kRotation && change.is_turned) {
                const auto q = change.rotation({value[0], value[1], value[2], value[3]});
                set(i, q.x, q.y, q.z, q.w);
            } else if (track.target == TrackTarget::kScale && holds && !is_tangent(track, i) &&
                       length(vector_of(value)) > 0) {
                const Vec3<double>& s = to_.nodes[node].parent_from_node.scale;  // which can be a change of units
                set(i, s.x, s.y, s.z);
            }
        }
        return out;
    }

    bool has_same_targets(uint32_t source, uint32_t node) const {
        const size_t count = target_count(from_, source);
        return count > 0 && count == target_count(to_, node);
    }

    const Asset &from_, &to_;
    RigTransfer transfer_;
};

// Mixamo and FBX files name all of their clips like this.
bool says_nothing(std::string_view name) {
    return name.empty() || name.find("Take 001") != name.npos || name.find("mixamo.com") != name.npos;
}

// "walk" of "moves/walk.glb".
std::string stem_of(const std::string& file) {
    const std::string name = file.substr(file.find_last_of("/\\") + 1), stem = name.substr(0, name.rfind('.'));
    return stem.empty() ? "clip" : stem;
}

// A name for the clip that is not in `names`; `stem` is the name of its file without extension.
std::string free_name(const std::string& name, const std::string& stem, const std::unordered_set<std::string>& names) {
    if (!says_nothing(name) && !names.contains(name)) return name;
    const std::string base = says_nothing(name) ? stem : stem + " " + name;
    std::string numbered = base;
    for (uint32_t number = 2; names.contains(numbered); ++number) numbered = joined(base, " ", number);
    return numbered;
}

// The warnings of `from` about nodes and animations, without those that `asset` has already: what was mended in the
// other file's meshes is no concern of this character.
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
