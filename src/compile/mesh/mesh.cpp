#include "compile/mesh/mesh.h"

#include "base/count.h"
#include "base/failure.h"
#include "reference/sampled_poses.h"
#include "compile/limits.h"
#include "import/normals.h"

#include <algorithm>
#include <map>

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

class MeshCompiler {
public:
    MeshCompiler(const Asset& asset, const RigMap& map, Character& character, const Progress& progress)
        : asset_(asset),
          map_(map),
          character_(character),
          progress_(progress),
          rest_model_from_joint_(rest_model_from_joint(map.rig)) {}

    void run() {
        check_size();
        for (const AssetSkin& skin : asset_.skins) add_skin(skin);
        size_t done = 0;
        for (const AssetMeshInstance& instance : asset_.mesh_instances) {
            progress_.report(done++, asset_.mesh_instances.size());
            for (uint32_t primitive = 0; primitive < asset_.meshes[instance.mesh].primitives.size(); ++primitive)
                add_section(instance, primitive);
        }
        character_.materials = asset_.materials;
        character_.images = asset_.images;
        warn_of_weightless();
    }

private:
    void check_size() const {
        uint64_t size_bytes = 0;
        for (const AssetMeshInstance& instance : asset_.mesh_instances)
            for (const AssetPrimitive& primitive : asset_.meshes[instance.mesh].primitives) {
                const uint64_t influence_sets = std::max(1u, primitive.influence_count / 4);
                size_bytes += primitive.positions.size() * (sizeof(Vertex) + influence_sets * sizeof(Influences)) +
                              primitive.indices.size() * sizeof(uint32_t);
            }
        if (size_bytes > kMeshLimit_bytes)
            throw Failure(ErrorCode::kLimit, asset_.name, "its meshes take ", size_bytes >> 20,
                          " MiB, each counted for every node that shows it; the limit is ", kMeshLimit_bytes >> 20,
                          " MiB");
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
        std::vector<PaletteEntry> entries;
        for (size_t k = 0; k < skin.joints.size(); ++k)
            entries.push_back({map_.joint_of_node[skin.joints[k]], skin.inverse_binds[k]});
        for (const Skin& other : character_.skins) {
            const auto same = [](const PaletteEntry& a, const PaletteEntry& b) {
                return a.joint == b.joint && a.joint_from_bind == b.joint_from_bind;
            };
            const auto begin = character_.palette.begin() + other.first_entry;
            if (other.joint_count == entries.size() && std::equal(entries.begin(), entries.end(), begin, same)) {
                character_.skins.push_back({skin.name, other.first_entry, other.joint_count});
                return;
            }
        }
        character_.skins.push_back({skin.name, add_entries(entries), count_of(entries)});
    }

    // The palette entry of a mesh that follows its node.
    uint32_t rigid_entry(uint32_t node) {
        const auto known = rigid_entries_.find(node);
        if (known != rigid_entries_.end()) return known->second;
        const RigidAnchor anchor = rigid_anchor(asset_, map_, node);
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
        if (skinned) {
            add_influences(instance, primitive_index);
            character_.indices.insert(character_.indices.end(), primitive.indices.begin(), primitive.indices.end());
        } else {
            const uint32_t entry = rigid_entry(instance.node);
            character_.influences.insert(character_.influences.end(), section.vertex_count,
                                         {{1, 0, 0, 0}, {static_cast<uint16_t>(entry), 0, 0, 0}});
            add_rigid_indices(primitive, entry);
        }
        character_.sections.push_back(section);
        const std::string& node_name = asset_.nodes[instance.node].name;
        character_.section_names.push_back(
            printable(node_name.empty() ? asset_.meshes[instance.mesh].name : node_name, std::string::npos));
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

    // Weights are brought to the sum of 1 here, so that no kernel divides. A vertex without weight follows its first
    // joint, as in three.js (SkinnedMesh.normalizeSkinWeights()) and Babylon.js (Mesh.cleanMatrixWeights()), or the
    // first of the skin, where that has no such joint.
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

    // One line for all, however many primitives a file has.
    void warn_of_weightless() {
        if (weightless_count_ == 0) return;
        character_.warnings.push_back(joined(
            asset_.name, ": ", first_weightless_, ": ", weightless_count_, " of ", skinned_count_,
            " skinned vertices, the first of them here, have no weight: they follow their first joint (JOINTS_0)"));
    }

    // glTF 2.0, section 3.7.4: a node that mirrors reverses the winding.
    void add_rigid_indices(const AssetPrimitive& primitive, uint32_t entry) {
        const PaletteEntry& anchor = character_.palette[entry];
        const bool mirrored = determinant(rest_model_from_joint_[anchor.joint] * anchor.joint_from_bind.as<double>()) <
                              0;
        for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3)
            for (const size_t corner : {size_t{0}, mirrored ? size_t{2} : size_t{1}, mirrored ? size_t{1} : size_t{2}})
                character_.indices.push_back(primitive.indices[i + corner]);
    }

    const Asset& asset_;
    const RigMap& map_;
    Character& character_;
    const Progress& progress_;
    const std::vector<AffineT<double>> rest_model_from_joint_;
    std::map<uint32_t, uint32_t> rigid_entries_;         // node -> palette entry
    uint64_t skinned_count_ = 0, weightless_count_ = 0;  // vertices
    std::string first_weightless_;                       // the primitive
};

}  // namespace

void compile_mesh(const Asset& asset, const RigMap& map, Character& character, const Progress& progress) {
    MeshCompiler(asset, map, character, progress).run();
}

}  // namespace throng
