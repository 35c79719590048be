#include "tools/creatures/glb_writer.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <new>
#include <span>

namespace throng {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

using Json = nlohmann::ordered_json;  // keys keep the order of writing: the same bytes for the same asset

// glTF's constants.
template <class T>
constexpr uint32_t kComponent = 5126;
template <>
constexpr uint32_t kComponent<uint16_t> = 5123;
template <>
constexpr uint32_t kComponent<uint32_t> = 5125;
enum Target : uint32_t { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };

// glTF's names, in the order of the enumerations.
constexpr const char* kInterpolations[] = {"STEP", "LINEAR", "CUBICSPLINE"};
constexpr const char* kPaths[] = {"translation", "rotation", "scale"};

Json named(const std::string& name) { return name.empty() ? Json::object() : Json{{"name", name}}; }

// Vectors and matrices as the floats that they consist of.
template <class T>
std::span<const float> floats(const std::vector<T>& data) {
    static_assert(sizeof(T) % sizeof(float) == 0);
    return {reinterpret_cast<const float*>(data.data()), data.size() * sizeof(T) / sizeof(float)};
}

void append(std::vector<std::byte>& to, std::span<const std::byte> bytes) {
    to.insert(to.end(), bytes.begin(), bytes.end());
}

class GlbWriter {
public:
    Result<std::vector<std::byte>> write(const Asset& asset) {
        Json json{{"asset", {{"version", "2.0"}, {"generator", "throng"}}},
                  {"scene", 0},
                  {"scenes", Json::array({{{"nodes", roots(asset)}}})}};
        const auto put = [&](const char* key, Json array) {
            if (!array.empty()) json[key] = std::move(array);  // glTF forbids empty arrays
        };
        put("nodes", nodes(asset));
        put("skins", each(asset.skins, [&](const AssetSkin& skin) { return skin_of(skin); }));
        put("materials", each(asset.materials, material_of));
        put("meshes", each(asset.meshes, [&](const AssetMesh& mesh) {
                Json out = named(mesh.name);
                out["primitives"] = each(mesh.primitives,
                                         [&](const AssetPrimitive& primitive) { return primitive_of(primitive); });
                return out;
            }));
        put("animations", each(asset.clips, [&](const AssetClip& clip) { return animation_of(clip); }));
        put("accessors", std::move(accessors_));
        put("bufferViews", std::move(views_));
        pad(binary_);
        if (!binary_.empty()) put("buffers", Json::array({{{"byteLength", binary_.size()}}}));
        return pack(asset.name, json.dump(-1, ' ', false, Json::error_handler_t::replace));
    }

private:
    template <class Range, class Write>
    static Json each(const Range& range, Write&& write) {
        Json out = Json::array();
        for (const auto& element : range) out.push_back(write(element));
        return out;
    }

    static void pad(std::vector<std::byte>& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4); }

    // Adds numbers as vectors of `components` components, or as matrices of 16. Returns the accessor's index.
    template <class T>
    size_t add(std::span<const T> numbers, size_t components, Target target = kNoTarget) {
        pad(binary_);
        Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", numbers.size_bytes()}};
        if (target == kVertices) view["byteStride"] = components * sizeof(T);
        if (target != kNoTarget) view["target"] = uint32_t(target);
        const std::string vector = "VEC" + std::to_string(components);
        accessors_.push_back({{"bufferView", views_.size()},
                              {"componentType", kComponent<T>},
                              {"count", numbers.size() / components},
                              {"type", components == 1    ? "SCALAR"
                                       : components == 16 ? "MAT4"
                                                          : vector}});
        views_.push_back(std::move(view));
        append(binary_, std::as_bytes(numbers));
        return accessors_.size() - 1;
    }
    // Also gives the smallest and the largest value of each component.
    size_t add_with_range(std::span<const float> numbers, size_t components, Target target = kNoTarget) {
        const size_t accessor = add(numbers, components, target);
        std::vector<float> least(components, std::numeric_limits<float>::max()),
            most(components, std::numeric_limits<float>::lowest());
        for (size_t i = 0; i < numbers.size(); ++i) {
            least[i % components] = std::min(least[i % components], numbers[i]);
            most[i % components] = std::max(most[i % components], numbers[i]);
        }
        accessors_.back()["min"] = least;
        accessors_.back()["max"] = most;
        return accessor;
    }

    static Json roots(const Asset& asset) {
        Json out = Json::array();
        for (size_t i = 0; i < asset.nodes.size(); ++i)
            if (asset.nodes[i].parent == kNone) out.push_back(i);
        return out;
    }

    static Json nodes(const Asset& asset) {
        Json out = each(asset.nodes, [](const AssetNode& node) {
            const auto& [rotation, translation, scale] = node.parent_from_node;
            Json json = named(node.name);
            if (translation != Vec3<double>{}) json["translation"] = {translation.x, translation.y, translation.z};
            if (rotation != Quaternion<double>{}) json["rotation"] = {rotation.x, rotation.y, rotation.z, rotation.w};
            if (scale != Vec3<double>{1, 1, 1}) json["scale"] = {scale.x, scale.y, scale.z};
            return json;
        });
        for (size_t i = 0; i < asset.nodes.size(); ++i)
            if (asset.nodes[i].parent != kNone) out[asset.nodes[i].parent]["children"].push_back(i);
        for (const AssetMeshInstance& instance : asset.mesh_instances) {
            out[instance.node]["mesh"] = instance.mesh;
            if (instance.skin != kNone) out[instance.node]["skin"] = instance.skin;
        }
        return out;
    }

    Json skin_of(const AssetSkin& skin) {
        std::vector<std::array<float, 16>> matrices;  // column-major
        for (const Affine& m : skin.inverse_binds) {
            const auto& [x, y, z] = m.row;
            matrices.push_back({x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, x[3], y[3], z[3], 1});
        }
        Json out = named(skin.name);
        out["joints"] = skin.joints;
        out["inverseBindMatrices"] = add(floats(matrices), 16);
        return out;
    }

    static Json material_of(const AssetMaterial& material) {
        Json out = named(material.name);
        out["pbrMetallicRoughness"] = {{"baseColorFactor", material.base_color}, {"metallicFactor", 0}};
        if (material.alpha_mode != AlphaMode::kOpaque)
            out["alphaMode"] = material.alpha_mode == AlphaMode::kMask ? "MASK" : "BLEND";
        if (material.alpha_mode == AlphaMode::kMask) out["alphaCutoff"] = material.alpha_cutoff;
        if (material.double_sided) out["doubleSided"] = true;
        return out;
    }

    Json primitive_of(const AssetPrimitive& p) {
        Json attributes{{"POSITION", add_with_range(floats(p.positions), 3, kVertices)}};
        if (!p.normals.empty()) attributes["NORMAL"] = add(floats(p.normals), 3, kVertices);
        if (!p.colors.empty()) attributes["COLOR_0"] = add(floats(p.colors), 4, kVertices);
        if (p.influence_count > 0) {
            attributes["JOINTS_0"] = add(std::span(p.influence_joints), 4, kVertices);
            attributes["WEIGHTS_0"] = add(floats(p.influence_weights), 4, kVertices);
        }
        Json out{{"attributes", std::move(attributes)}};
        if (p.material != kNone) out["material"] = p.material;
        if (p.positions.size() <= 65535) {  // 65,535 itself is the primitive restart value
            const std::vector<uint16_t> narrow(p.indices.begin(), p.indices.end());
            out["indices"] = add(std::span(narrow), 1, kIndices);
        } else {
            out["indices"] = add(std::span(p.indices), 1, kIndices);
        }
        return out;
    }

    Json animation_of(const AssetClip& clip) {
        Json samplers = Json::array(), channels = Json::array();
        const std::vector<float>* times_s = nullptr;  // written last; tracks with the same times share them
        size_t input = 0;
        for (const AssetTrack& track : clip.tracks) {
            if (!times_s || *times_s != track.times_s) {
                times_s = &track.times_s;
                input = add_with_range(track.times_s, 1);
            }
            const size_t output = add(floats(track.values), track.target == TrackTarget::kRotation ? 4 : 3);
            channels.push_back({{"sampler", samplers.size()},
                                {"target", {{"node", track.node}, {"path", kPaths[size_t(track.target)]}}}});
            samplers.push_back({{"input", input},
                                {"output", output},
                                {"interpolation", kInterpolations[size_t(track.interpolation)]}});
        }
        Json out = named(clip.name);
        out["samplers"] = std::move(samplers);
        out["channels"] = std::move(channels);
        return out;
    }

    // Header, JSON chunk padded with spaces, binary chunk padded with zeros.
    Result<std::vector<std::byte>> pack(const std::string& name, std::string text) const {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const uint64_t total = 12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size());
        if (total > 0xFFFFFFFFu) return Error{ErrorCode::kLimit, name, "the .glb file would have 4 GiB or more"};
        std::vector<std::byte> out;
        out.reserve(total);
        const auto words = [&](auto... values) {
            const std::array array{static_cast<uint32_t>(values)...};
            append(out, std::as_bytes(std::span(array)));
        };
        words(0x46546C67, 2, total);     // "glTF", version
        words(text.size(), 0x4E4F534A);  // "JSON"
        append(out, std::as_bytes(std::span(text)));
        if (binary_.empty()) return out;
        words(binary_.size(), 0x004E4942);  // "BIN"
        append(out, binary_);
        return out;
    }

    Json accessors_ = Json::array(), views_ = Json::array();
    std::vector<std::byte> binary_;
};

Result<void> check(const Asset& asset) {
    const auto unsupported = [](std::string place, const char* message) {
        return Error{ErrorCode::kUnsupported, std::move(place), message};
    };
    if (!asset.images.empty()) return unsupported("images", "cannot be written");
    for (size_t i = 0; i < asset.meshes.size(); ++i)
        for (const AssetPrimitive& p : asset.meshes[i].primitives) {
            const std::string place = "meshes[" + std::to_string(i) + "]";
            if (!p.texcoords.empty()) return unsupported(place, "texture coordinates cannot be written");
            if (!p.targets.empty()) return unsupported(place, "morph targets cannot be written");
            if (p.influence_count != 0 && p.influence_count != 4)
                return unsupported(place, "only four influences a vertex can be written");
        }
    return {};
}

}  // namespace

Result<std::vector<std::byte>> write_glb(const Asset& asset) {
    if (const Result<void> checked = check(asset); !checked) return checked.error();
    try {
        return GlbWriter().write(asset);
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kOutOfMemory, asset.name, "out of memory"};
    }
}

}  // namespace throng
