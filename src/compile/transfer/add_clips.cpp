// Clips of another file, for the nodes that have the same names.
#include <throng/asset.h>

#include "base/failure.h"
#include "base/text.h"
#include "compile/asset_check.h"
#include "compile/transfer/names.h"
#include "compile/transfer/rig_transfer.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace throng {
namespace {

// The instance at a node whose mesh has the node's morph targets; null if the node has no mesh.
const AssetMeshInstance* morphed_at(const Asset& asset, uint32_t node) {
    const auto instances = std::ranges::equal_range(asset.mesh_instances, node, {}, &AssetMeshInstance::node);
    const auto most = std::ranges::max_element(
        instances, {}, [&](const AssetMeshInstance& of) { return asset.meshes[of.mesh].weights.size(); });
    return most == instances.end() ? nullptr : &*most;
}

const AssetMesh* mesh_of(const Asset& asset, uint32_t node) {
    const AssetMeshInstance* instance = morphed_at(asset, node);
    return instance ? &asset.meshes[instance->mesh] : nullptr;
}

std::vector<float> default_weights(const Asset& asset, uint32_t node) {
    const AssetMeshInstance* instance = morphed_at(asset, node);
    return instance->weights.empty() ? asset.meshes[instance->mesh].weights : instance->weights;
}

// [morph target of `to`]: the one of `from` with the same name, or kNone. If one of the meshes has no names, targets
// are matched by index, provided that both have the same number.
std::vector<uint32_t> find_morph_sources(const AssetMesh& from, const AssetMesh& to) {
    std::vector<uint32_t> sources(to.weights.size(), kNone);
    if (from.target_names.empty() || to.target_names.empty() || from.target_names == to.target_names) {
        if (from.weights.size() == to.weights.size()) std::iota(sources.begin(), sources.end(), 0u);
        return sources;
    }
    std::unordered_map<std::string_view, uint32_t> by_name;
    for (uint32_t target = 0; target < from.target_names.size(); ++target)
        by_name.emplace(from.target_names[target], target);
    for (size_t target = 0; target < sources.size(); ++target)
        if (const auto found = by_name.find(to.target_names[target]); found != by_name.end())
            sources[target] = found->second;
    return sources;
}

class ClipAdder {
public:
    ClipAdder(const Asset& from, const Asset& to) : from_(from), to_(to), transfer_(from, to) {}

    // The clips, mapped to the nodes of `to`. Clips that keep no track are left out.
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
                    if (const std::vector<uint32_t> sources = morph_sources(track.node, node);
                        std::ranges::any_of(sources, [](uint32_t source) { return source != kNone; }))
                        changed.morph_tracks.push_back(changed_track(track, node, sources));
            if (!changed.tracks.empty() || !changed.morph_tracks.empty()) out.push_back(std::move(changed));
        }
        return out;
    }

    // "2 of its 40 animated nodes ('tail', 'wing')": those that move nothing in `to`; empty if there are none.
    std::string without_target() const {
        NameList list;
        size_t animated_count = 0;
        for (uint32_t node = 0; node < from_.nodes.size(); ++node) {
            if (!transfer_.animated(node).moves) continue;
            ++animated_count;
            if (lacks_morphs(node))
                list.add(from_.nodes[node].name, joined(" with ", used_morphs(node).size(), " morph targets"));
            else if (transfer_.targets(node).empty())
                list.add(from_.nodes[node].name);
        }
        if (list.count() == 0) return {};
        return joined(list.count(), " of its ", animated_count, " animated nodes (", list.text(), ")");
    }

    // "; what is below 'Spine2' will be turned differently": lists nodes that clips rotate and `to` lacks, although it
    // has joints below them.
    std::string turned_differently() const {
        std::vector<bool> holds_joint(from_.nodes.size(), false);
        for (uint32_t node = 0; node < from_.nodes.size(); ++node) {
            if (!moves_joint(node)) continue;
            for (uint32_t above = from_.nodes[node].parent; above != kNone && !holds_joint[above];
                 above = from_.nodes[above].parent)
                holds_joint[above] = true;
        }
        NameList list;
        for (uint32_t node = 0; node < from_.nodes.size(); ++node)
            if (holds_joint[node] && transfer_.animated(node).rotates && transfer_.targets(node).empty())
                list.add(from_.nodes[node].name);
        return list.count() == 0 ? "" : joined("; what is below ", list.text(), " will be turned differently");
    }

    // "1 of 52 morph targets of 'Face' ('tongueOut')": the targets that `to` lacks, for each node some of whose targets
    // it has.
    std::vector<std::string> without_morphs() const {
        std::vector<std::string> out;
        for (uint32_t node = 0; node < from_.nodes.size(); ++node) {
            if (!transfer_.animated(node).has_morphs || lacks_morphs(node)) continue;
            const std::vector<bool> is_used = used_morphs(node);
            NameList list;
            for (size_t target = 0; target < is_used.size(); ++target)
                if (!is_used[target]) list.add(mesh_of(from_, node)->target_names[target]);
            if (list.count() > 0)
                out.push_back(joined(list.count(), " of ", is_used.size(), " morph targets of ",
                                     quoted(from_.nodes[node].name), " (", list.text(), ")"));
        }
        return out;
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
                const Vec3<double> t = is_tangent(track, i) ? change.vector(vector_of(value))
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

    // The track with a column for each morph target of `to`. Targets that nothing moves keep their default weight.
    AssetMorphTrack changed_track(const AssetMorphTrack& track, uint32_t node,
                                  const std::vector<uint32_t>& sources) const {
        AssetMorphTrack out{.node = node, .interpolation = track.interpolation, .times_s = track.times_s};
        const std::vector<float> rest = default_weights(to_, node);
        const size_t old_width = mesh_of(from_, track.node)->weights.size();
        const auto value = [&](size_t row, size_t target) {
            if (sources[target] != kNone) return track.values[row * old_width + sources[target]];
            return is_tangent(track, row) ? 0 : rest[target];
        };
        for (size_t row = 0; row < track.values.size() / old_width; ++row)
            for (size_t target = 0; target < sources.size(); ++target) out.values.push_back(value(row, target));
        return out;
    }

    // [morph target of `node`]: that of `source` which moves it, or kNone.
    std::vector<uint32_t> morph_sources(uint32_t source, uint32_t node) const {
        const AssetMesh *old_mesh = mesh_of(from_, source), *mesh = mesh_of(to_, node);
        return old_mesh && mesh ? find_morph_sources(*old_mesh, *mesh) : std::vector<uint32_t>();
    }

    // [morph target of `source`]: whether it moves any of `to`.
    std::vector<bool> used_morphs(uint32_t source) const {
        const AssetMesh* mesh = mesh_of(from_, source);
        std::vector<bool> is_used(mesh ? mesh->weights.size() : 0, false);
        for (const uint32_t node : transfer_.targets(source))
            for (const uint32_t used : morph_sources(source, node))
                if (used != kNone) is_used[used] = true;
        return is_used;
    }

    // Whether clips move morph targets of this node, and `to` has none of them.
    bool lacks_morphs(uint32_t source) const {
        return transfer_.animated(source).has_morphs && std::ranges::none_of(used_morphs(source), std::identity());
    }

    bool moves_joint(uint32_t source) const {
        return std::ranges::any_of(transfer_.targets(source), [&](uint32_t node) { return transfer_.is_joint(node); });
    }

    const Asset &from_, &to_;
    RigTransfer transfer_;
};

// Mixamo and FBX files name all of their clips like this.
bool is_generic_name(std::string_view name) {
    return name.empty() || name.find("Take 001") != name.npos || name.find("mixamo.com") != name.npos;
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
            std::vector<std::string> warnings = new_warnings(asset, from, [](const std::string& line) {
                // Only animations and nodes are taken over, so warnings about meshes do not apply here.
                return line.find(": animations[") != line.npos || line.find(": nodes[") != line.npos;
            });
            const std::string without = adder.without_target();
            if (clips.empty())
                refuse(from.name, without.empty() ? "its clips move nothing in " : without + " are not in ", asset.name,
                       ", which has ", some_joints(asset, joints_of(asset)),
                       ", …: clips are added to nodes of the same names");
            const auto warn = [&](const std::string& what, const std::string& effect) {
                warnings.push_back(joined(from.name, ": ", what, " are not in ", asset.name, effect));
            };
            if (!without.empty()) warn(without, adder.turned_differently());
            for (const std::string& morphs : adder.without_morphs()) warn(morphs, "");
            UniqueNames names;
            for (const AssetClip& clip : asset.clips) names.insert(clip.name);
            for (AssetClip& clip : clips)
                clip.name = names.add(clip.name, is_generic_name(clip.name), stem_of(from.name, "clip"));
            // Reserves first, so that nothing fails half-way after that.
            asset.clips.reserve(asset.clips.size() + clips.size());
            asset.warnings.reserve(asset.warnings.size() + warnings.size());
            std::ranges::move(clips, std::back_inserter(asset.clips));
            std::ranges::move(warnings, std::back_inserter(asset.warnings));
        },
        from.name);
}

}  // namespace throng
