#include "compile/mesh/mesh.h"

#include "base/count.h"
#include "base/failure.h"
#include "compile/limits.h"
#include "import/compiled_size.h"
#include "import/normals.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace throng {
namespace {

// Octahedral map of a unit vector to two signed 16-bit fractions.
// Source: Cigolle et al., A Survey of Efficient Representations for Independent Unit Vectors, JCGT 2014.
uint32_t pack_normal(const Vec3<float>& n) {
    const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    if (!(sum > 0)) return pack_normal({0, 1, 0});
    float u = n.x / sum, v = n.y / sum;
    if (n.z < 0) {
        const float folded_u = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
        v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f);
        u = folded_u;
    }
    const auto fraction = [](float f) {
        return static_cast<uint32_t>(
            static_cast<uint16_t>(static_cast<int16_t>(std::lround(std::clamp(f, -1.0f, 1.0f) * 32767))));
    };
    return fraction(u) | fraction(v) << 16;
}

uint32_t pack_color(const std::array<float, 4>& color) {
    uint32_t packed = 0;
    for (int i = 0; i < 4; ++i)
        packed |= static_cast<uint32_t>(std::lround(std::clamp(color[static_cast<size_t>(i)], 0.0f, 1.0f) * 255))
                  << (8 * i);
    return packed;
}

// [node_count]: the sign of the determinant of model_from_node, in the rest pose.
std::vector<int> determinant_signs(const Asset& asset) {
    const auto sign = [](double x) { return (x > 0) - (x < 0); };
    std::vector<int> signs(asset.nodes.size());
    for (const uint32_t node : parents_first(asset)) {
        const auto& [x, y, z] = asset.nodes[node].parent_from_node.scale;
        const uint32_t parent = asset.nodes[node].parent;
        signs[node] = sign(x) * sign(y) * sign(z) * (parent == kNone ? 1 : signs[parent]);
    }
    return signs;
}

// [mesh]: its primitives that have triangles.
std::vector<std::vector<uint32_t>> drawn_primitives(const Asset& asset) {
    std::vector<std::vector<uint32_t>> drawn(asset.meshes.size());
    for (size_t mesh = 0; mesh < asset.meshes.size(); ++mesh) {
        const std::vector<AssetPrimitive>& primitives = asset.meshes[mesh].primitives;
        for (uint32_t i = 0; i < primitives.size(); ++i)
            if (is_drawn(primitives[i])) drawn[mesh].push_back(i);
    }
    return drawn;
}

// A strict order for a map; which one does not matter. Skins with equal entries share them.
struct ByEntries {
    bool operator()(const std::vector<PaletteEntry>& a, const std::vector<PaletteEntry>& b) const {
        return std::ranges::lexicographical_compare(a, b, [](const PaletteEntry& x, const PaletteEntry& y) {
            return std::tie(x.joint, x.joint_from_bind.row) < std::tie(y.joint, y.joint_from_bind.row);
        });
    }
};

class MeshCompiler {
public:
    MeshCompiler(const Asset& asset, const RigMap& map, Character& character, const Progress& progress)
        : asset_(asset),
          map_(map),
          character_(character),
          progress_(progress),
          drawn_(drawn_primitives(asset)),
          determinant_signs_(determinant_signs(asset)),
          anchors_(rigid_anchors(asset, map)) {}

    void run() {
        check_size();
        for (const AssetSkin& skin : asset_.skins) add_skin(skin);
        size_t done = 0;
        for (const AssetMeshInstance& instance : asset_.mesh_instances) {
            progress_.report(done++, asset_.mesh_instances.size());
            for (const uint32_t primitive : drawn_[instance.mesh]) add_section(instance, primitive);
        }
        character_.materials = asset_.materials;
        character_.images = asset_.images;
        warn_of_weightless();
    }

private:
    void check_size() const {
        const auto [section_count, size_bytes] = compiled_size(asset_);
        constexpr const char* kCounted = ", each counted for every node that shows it; the limit is ";
        if (section_count > kSectionLimit)
            throw Failure(ErrorCode::kLimit, asset_.name, "its meshes have ", section_count, " primitives", kCounted,
                          kSectionLimit);
        if (size_bytes > kMeshLimit_bytes)
            throw Failure(ErrorCode::kLimit, asset_.name, "its meshes take ", size_bytes >> 20, " MiB", kCounted,
                          kMeshLimit_bytes >> 20, " MiB");
    }

    uint32_t add_entries(const std::vector<PaletteEntry>& entries) {
        const size_t first = character_.palette.size();
        if (first + entries.size() > kPaletteLimit)
            throw Failure(ErrorCode::kLimit, asset_.name, "the skins have more than ", kPaletteLimit, " joints in sum");
        character_.palette.insert(character_.palette.end(), entries.begin(), entries.end());
        return static_cast<uint32_t>(first);
    }

    // Skins with the same joints and inverse binds share their entries.
    void add_skin(const AssetSkin& skin) {
        progress_.poll();
        std::vector<PaletteEntry> entries;
        for (size_t k = 0; k < skin.joints.size(); ++k)
            entries.push_back({map_.joint_of_node[skin.joints[k]], skin.inverse_binds[k]});
        auto known = first_entries_.find(entries);
        if (known == first_entries_.end()) known = first_entries_.emplace(entries, add_entries(entries)).first;
        character_.skins.push_back({skin.name, known->second, count_of(entries)});
    }

    // The palette entry of a mesh that follows its node.
    uint32_t rigid_entry(uint32_t node) {
        const auto known = rigid_entries_.find(node);
        if (known != rigid_entries_.end()) return known->second;
        const RigidAnchor& anchor = anchors_[node];
        return rigid_entries_[node] = add_entries({{anchor.joint, anchor.joint_from_mesh.as<float>()}});
    }

    void add_section(const AssetMeshInstance& instance, uint32_t primitive_index) {
        const AssetPrimitive& primitive = asset_.meshes[instance.mesh].primitives[primitive_index];
        const bool skinned = instance.skin != kNone && primitive.influence_count > 0;
        const MeshSection section{.node = instance.node,
                                  .mesh = instance.mesh,
                                  .primitive = primitive_index,
                                  .skin = skinned ? instance.skin : kNone,
                                  .first_vertex = count_of(character_.vertices),
                                  .vertex_count = count_of(primitive.positions),
                                  .first_influences = count_of(character_.influences),
                                  .influence_sets = skinned ? primitive.influence_count / 4 : 1,
                                  .first_index = count_of(character_.indices),
                                  .index_count = count_of(primitive.indices),
                                  .material = primitive.material};
        add_vertices(primitive);
        if (skinned)
            add_influences(instance, primitive_index);
        else
            character_.influences.insert(character_.influences.end(), section.vertex_count,
                                         {{1, 0, 0, 0}, {static_cast<uint16_t>(rigid_entry(instance.node)), 0, 0, 0}});
        add_indices(primitive, determinant_signs_[instance.node] < 0);
        character_.sections.push_back(section);
        character_.section_names.push_back(printable(section_name(asset_, instance), std::string::npos));
    }

    void add_vertices(const AssetPrimitive& primitive) {
        const std::vector<Vec3<float>> normals = primitive.normals.empty() ? smooth_normals(primitive)
                                                                           : primitive.normals;
        for (size_t v = 0; v < primitive.positions.size(); ++v) {
            Vertex vertex{.position = primitive.positions[v], .normal_octahedral = pack_normal(normalized(normals[v]))};
            if (!primitive.texcoords.empty()) vertex.texcoord = primitive.texcoords[v];
            if (!primitive.colors.empty()) vertex.color = pack_color(primitive.colors[v]);
            character_.vertices.push_back(vertex);
        }
    }

    // Scales weights to a sum of 1, so that no kernel has to divide. A vertex without weight follows its first joint,
    // as in three.js (SkinnedMesh.normalizeSkinWeights()) and Babylon.js (Mesh.cleanMatrixWeights()), or the first
    // joint of the skin if the skin has no such joint.
    void add_influences(const AssetMeshInstance& instance, uint32_t primitive_index) {
        const AssetPrimitive& primitive = asset_.meshes[instance.mesh].primitives[primitive_index];
        const Skin& skin = character_.skins[instance.skin];
        const uint32_t count = primitive.influence_count;
        for (size_t v = 0; v < primitive.positions.size(); ++v) {
            double sum = 0;
            for (uint32_t i = 0; i < count; ++i) sum += primitive.influence_weights[v * count + i];
            const bool weightless = !(sum > 0);
            if (weightless && weightless_count_++ == 0)
                first_weightless_ = joined("meshes[", instance.mesh, "].primitives[", primitive_index, "]");
            for (uint32_t set = 0; set < count / 4; ++set) {
                Influences influences;
                for (uint32_t i = 0; i < 4; ++i) {
                    const size_t at = v * count + set * 4 + i;
                    const uint32_t joint = primitive.influence_joints[at];
                    const double all_on_first = set == 0 && i == 0 ? 1 : 0;
                    const double weight = weightless ? all_on_first : primitive.influence_weights[at] / sum;
                    const uint32_t known_joint = joint < skin.joint_count ? joint : 0;
                    influences.weights[i] = static_cast<float>(weight);
                    influences.entries[i] = static_cast<uint16_t>(skin.first_entry + known_joint);
                }
                character_.influences.push_back(influences);
            }
        }
        skinned_count_ += primitive.positions.size();
    }

    // One warning for the whole file, however many primitives are affected.
    void warn_of_weightless() {
        if (weightless_count_ == 0) return;
        character_.warnings.push_back(joined(
            asset_.name, ": ", first_weightless_, ": ", weightless_count_, " of ", skinned_count_,
            " skinned vertices, the first of them here, have no weight: they follow their first joint (JOINTS_0)"));
    }

    // glTF 2.0, section 3.7.4: the determinant of the node's global transform decides the winding. That holds for
    // skinned meshes too, although their positions do not depend on the node. three.js does the same.
    void add_indices(const AssetPrimitive& primitive, bool mirrored) {
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
            for (const size_t corner : {size_t{0}, mirrored ? size_t{2} : size_t{1}, mirrored ? size_t{1} : size_t{2}})
                character_.indices.push_back(primitive.indices[i + corner]);
    }

    const Asset& asset_;
    const RigMap& map_;
    Character& character_;
    const Progress& progress_;
    const std::vector<std::vector<uint32_t>> drawn_;                          // [mesh]: primitives
    const std::vector<int> determinant_signs_;                                // [node]
    const std::vector<RigidAnchor> anchors_;                                  // [node]
    std::map<std::vector<PaletteEntry>, uint32_t, ByEntries> first_entries_;  // of each distinct skin
    std::map<uint32_t, uint32_t> rigid_entries_;                              // node -> palette entry
    uint64_t skinned_count_ = 0, weightless_count_ = 0;                       // vertices
    std::string first_weightless_;                                            // the primitive
};

}  // namespace

void compile_mesh(const Asset& asset, const RigMap& map, Character& character, const Progress& progress) {
    MeshCompiler(asset, map, character, progress).run();
}

}  // namespace throng
