#include "import/draco.h"
#include "import/normals.h"
#include "import/readers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>

namespace throng::gltf {
namespace {

enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan, kModeCount };

// Reads the attributes and indices of one primitive.
class PrimitiveReader {
public:
    PrimitiveReader(Reading& reading, const JsonView& json, const Asset& asset,
                    std::span<const TextureCoordinates> of_materials)
        : reading_(reading), json_(json) {
        out_.material = json.optional_index("material", asset.materials.size(), "materials");
        const uint64_t mode = json.optional_uint("mode", kTriangles);
        if (mode >= kModeCount) json.fail_at("mode", mode, " is unknown");
        attributes_ = json.optional_object("attributes");
        if (mode < kTriangles)
            warn("points and lines are not drawn");
        else if (!attributes_ || !attributes_->has("POSITION"))
            warn("has no POSITION: it is not drawn");
        else
            read_triangles(Mode(mode), asset, of_materials);
    }

    AssetPrimitive take() { return std::move(out_); }

private:
    void read_triangles(Mode mode, const Asset& asset, std::span<const TextureCoordinates> of_materials) {
        if (const auto compressed = json_.extension("KHR_draco_mesh_compression"))
            draco_.emplace(*compressed, reading_.buffers, reading_.budget);
        read_positions();
        if (attributes_->has("NORMAL")) read_normals();
        if (out_.material == kNone)
            read_texcoords({});
        else
            read_texcoords(asset.materials[out_.material], of_materials[out_.material]);
        if (attributes_->has("COLOR_0")) read_colors();
        read_targets();
        read_influences();
        read_indices(mode);
        make_normals();
    }

    void warn(const char* why) { reading_.warnings.add(json_.place(), why); }

    std::string place_of(const std::string& name) const { return attributes_->place_of(name); }

    template <class... Parts>
    [[noreturn]] void fail(const std::string& name, const Parts&... what) const {
        attributes_->fail_at(name, what...);
    }

    // The attribute's data; `element_bytes` are charged for each element.
    AccessorView open(const std::string& name, uint64_t element_bytes) {
        const AccessorFormat format = reading_.accessors.format(*attributes_, name);
        if (name != "POSITION") require_count(*attributes_, name, format);
        reading_.budget.charge(format.count, element_bytes, place_of(name));
        if (draco_)
            if (auto view = draco_->attribute(name, format)) return *view;
        return reading_.accessors.open(format);
    }

    // Fails unless there are as many elements as vertices.
    void require_count(const JsonView& attributes, const std::string& name, const AccessorFormat& format) const {
        if (format.count != out_.positions.size())
            attributes.fail_at(name, "has ", format.count, " elements, but POSITION has ", out_.positions.size());
    }

    // `integers`: whether the component type may be other than float, by the rules of the attribute.
    void require(const JsonView& attributes, const std::string& name, const AccessorFormat& format,
                 std::initializer_list<const char*> types, bool integers) const {
        if (std::find(types.begin(), types.end(), format.type) == types.end())
            attributes.fail_at(name, "must be ", *types.begin(), ", but is ", format.type);
        if (!format.is_float() && !integers)
            attributes.fail_at(name, "must not be ", format.normalized ? "normalised " : "", format.component_text(),
                               reading_.quantized ? "" : " without KHR_mesh_quantization");
    }

    static bool is_short(const AccessorFormat& format) { return size_of(format.component_type) <= 2; }
    // Unsigned and normalised: what texture coordinates, colours and weights may be without an extension.
    static bool is_fraction(const AccessorFormat& format) {
        return is_short(format) && format.is_unsigned() && format.normalized;
    }

    std::vector<Vec3<float>> finite_vectors(const JsonView& attributes, const char* name,
                                            const AccessorView& view) const {
        std::vector<Vec3<float>> out(view.count());
        for (uint32_t v = 0; v < view.count(); ++v) {
            reading_.budget.poll_at(v);
            out[v] = {view.number(v, 0), view.number(v, 1), view.number(v, 2)};
            if (!std::isfinite(out[v].x) || !std::isfinite(out[v].y) || !std::isfinite(out[v].z))
                attributes.fail_at(name, "vertex ", v, " is not finite");
        }
        return out;
    }

    void read_positions() {
        const AccessorView view = open("POSITION", sizeof(Vec3<float>));
        require(*attributes_, "POSITION", view.format, {"VEC3"}, reading_.quantized && is_short(view.format));
        out_.positions = finite_vectors(*attributes_, "POSITION", view);
    }

    // Reads an attribute that only affects looks, so the file is not refused for values that are not finite. Components
    // that the file lacks are 1.
    template <class Element, class MayBeIntegers>
    void read_looks(const std::string& name, std::initializer_list<const char*> types,
                    const MayBeIntegers& may_be_integers, std::vector<Element>& out) {
        const AccessorView view = open(name, sizeof(Element));
        require(*attributes_, name, view.format, types, may_be_integers(view.format));
        bool mended = false;
        out.reserve(view.count());
        for (uint32_t v = 0; v < view.count(); ++v) {
            reading_.budget.poll_at(v);
            std::array<float, sizeof(Element) / sizeof(float)> values;
            for (uint32_t c = 0; c < values.size(); ++c) {
                values[c] = c < view.format.component_count ? view.number(v, c) : 1;
                if (std::isfinite(values[c])) continue;
                mended = true;
                values[c] = 0;
            }
            out.push_back(std::bit_cast<Element>(values));
        }
        if (mended) reading_.warnings.add(place_of(name), "has values that are not finite: they are set to 0");
    }

    void read_normals() {
        const auto may_be_integers = [&](const AccessorFormat& format) {
            return is_quantized_signed(format) && format.normalized;
        };
        read_looks("NORMAL", {"VEC3"}, may_be_integers, out_.normals);
    }

    // Makes normals for vertices that have none in the file, or one of length 0.
    void make_normals() {
        const size_t vertex_count = out_.positions.size();
        const bool has_some = !out_.normals.empty();
        const auto is_missing = [](const Vec3<float>& normal) { return dot(normal, normal) == 0; };
        const ptrdiff_t missing = has_some ? std::ranges::count_if(out_.normals, is_missing) : ptrdiff_t(vertex_count);
        if (missing == 0) return;
        reading_.budget.charge(vertex_count, sizeof(Vec3<float>), json_.place());
        const std::vector<Vec3<float>> made = smooth_normals(out_);
        out_.normals.resize(vertex_count);
        for (size_t v = 0; v < vertex_count; ++v)
            if (is_missing(out_.normals[v])) out_.normals[v] = made[v];
        reading_.warnings.add(json_.place(), missing, " of ", vertex_count,
                              " vertices have no normal: they get smooth ones, of the triangles around them");
    }

    void read_texcoords(const AssetMaterial& material, const TextureCoordinates& coordinates) {
        bool has_texture = false;
        visit_images([&](auto member) { has_texture = has_texture || material.*member != kNone; });
        if (!read_texcoords(coordinates) && has_texture)
            warn("its material has a texture, but it has no texture coordinates for it");
    }

    bool read_texcoords(const TextureCoordinates& coordinates) {
        const std::string name = joined("TEXCOORD_", coordinates.set);
        if (!attributes_->has(name)) return false;
        const auto may_be_integers = [&](const AccessorFormat& format) {
            return is_fraction(format) || (reading_.quantized && is_short(format));
        };
        read_looks(name, {"VEC2"}, may_be_integers, out_.texcoords);
        if (coordinates.transform == TextureCoordinates().transform) return true;
        for (std::array<float, 2>& texcoord : out_.texcoords) {
            const auto [u, v] = texcoord;
            for (size_t k = 0; k < 2; ++k) {
                const auto& row = coordinates.transform[k];
                texcoord[k] = static_cast<float>(row[0] * double{u} + row[1] * double{v} + row[2]);
            }
        }
        return true;
    }

    void read_colors() { read_looks("COLOR_0", {"VEC4", "VEC3"}, is_fraction, out_.colors); }

    // KHR_draco_mesh_compression leaves morph targets as they are.
    void read_targets() {
        const JsonView targets = json_.optional_array("targets");
        reading_.budget.charge(targets.size(), sizeof(AssetMorphTarget), targets.place());
        out_.targets.reserve(targets.size());
        for (const JsonView target : targets) {
            target.as_object();
            AssetMorphTarget& out = out_.targets.emplace_back();
            out.positions = read_differences(target, "POSITION", false);
            out.normals = read_differences(target, "NORMAL", true);
        }
    }

    // Quantised normals and differences are signed, those of normals also normalised (KHR_mesh_quantization).
    bool is_quantized_signed(const AccessorFormat& format) const {
        return reading_.quantized && is_short(format) && !format.is_unsigned();
    }

    std::vector<Vec3<float>> read_differences(const JsonView& target, const char* name, bool is_normal) {
        if (!target.has(name)) return {};
        const AccessorFormat format = reading_.accessors.format(target, name);
        require(target, name, format, {"VEC3"}, is_quantized_signed(format) && (format.normalized || !is_normal));
        require_count(target, name, format);
        reading_.budget.charge(format.count, sizeof(Vec3<float>), target.place_of(name));
        return finite_vectors(target, name, reading_.accessors.open(format));
    }

    // How many of <prefix>0, <prefix>1, … there are without a gap.
    uint32_t set_count(const std::string& prefix) {
        std::set<std::string> names;
        for (const JsonView attribute : *attributes_)
            if (attribute.key().starts_with(prefix)) names.insert(attribute.key());
        uint32_t count = 0;
        while (names.contains(joined(prefix, count))) ++count;
        if (names.size() != count)
            reading_.warnings.add(place_of(joined(prefix, count)), "is missing: the sets after it are ignored");
        return count;
    }

    void read_influences() {
        const uint32_t joint_sets = set_count("JOINTS_"), weight_sets = set_count("WEIGHTS_");
        if (joint_sets != weight_sets)
            attributes_->fail("there are ", joint_sets, " sets of JOINTS, but ", weight_sets, " of WEIGHTS");
        const size_t influence_count = size_t(joint_sets) * 4;
        out_.influence_count = uint32_t(influence_count);
        for (uint32_t set = 0; set < joint_sets; ++set) {
            const std::string joints_name = joined("JOINTS_", set), weights_name = joined("WEIGHTS_", set);
            const AccessorView joints = open(joints_name, 4 * sizeof(uint16_t));
            const AccessorView weights = open(weights_name, 4 * sizeof(float));
            if (joints.format.type != "VEC4" || !joints.format.is_unsigned() || !is_short(joints.format))
                fail(joints_name, "must be VEC4 of unsigned 8- or 16-bit integers, but is ", joints.format.text());
            require(*attributes_, weights_name, weights.format, {"VEC4"}, is_fraction(weights.format));
            // Here and not before: the counts are known to be true by now.
            out_.influence_joints.resize(out_.positions.size() * influence_count);
            out_.influence_weights.resize(out_.positions.size() * influence_count);
            uint32_t not_finite_count = 0, negative_count = 0;  // vertices
            for (uint32_t v = 0; v < joints.count(); ++v) {
                reading_.budget.poll_at(v);
                bool not_finite = false, negative = false;
                for (uint32_t k = 0; k < 4; ++k) {
                    const float stored = weights.number(v, k);
                    const bool finite = std::isfinite(stored);
                    not_finite = not_finite || !finite;
                    negative = negative || (finite && stored < 0);
                    const size_t influence = v * influence_count + set * 4 + k;
                    out_.influence_joints[influence] = uint16_t(joints.integer(v, k));
                    out_.influence_weights[influence] = finite ? std::max(stored, 0.0f) : 0.0f;
                }
                not_finite_count += not_finite;
                negative_count += negative;
            }
            warn_of_vertices(weights_name, not_finite_count, "have weights that are not finite: they are set to 0");
            warn_of_vertices(weights_name, negative_count, "have negative weights: they are set to 0");
        }
        forget_unused_joints();
    }

    void warn_of_vertices(const std::string& name, uint32_t count, const char* what) {
        if (count > 0) reading_.warnings.add(place_of(name), count, " of ", out_.positions.size(), " vertices ", what);
    }

    // A joint of weight 0 means nothing, and files have anything there, so it becomes 0. But a vertex without any
    // weight follows its first joint (compile/mesh/mesh.cpp), which stays.
    void forget_unused_joints() {
        const size_t count = out_.influence_count;
        for (size_t v = 0; v < out_.influence_weights.size(); v += count) {
            const auto weights = out_.influence_weights.begin() + ptrdiff_t(v);
            const bool weightless = std::all_of(weights, weights + ptrdiff_t(count), [](float w) { return w == 0; });
            for (size_t i = weightless ? 1 : 0; i < count; ++i)
                if (out_.influence_weights[v + i] == 0) out_.influence_joints[v + i] = 0;
        }
    }

    void read_indices(Mode mode) {
        std::vector<uint32_t> indices = draco_ ? draco_->indices() : file_indices();
        for (const uint32_t index : indices)
            if (index >= out_.positions.size())
                json_.fail_at("indices", "index ", index, ", but there are ", out_.positions.size(), " vertices");
        if (!draco_ && mode != kTriangles) indices = triangle_list(indices, mode);
        if (indices.size() % 3 != 0) {
            reading_.warnings.add(json_.place(), "its last triangle is incomplete: it is dropped");
            indices.resize(indices.size() / 3 * 3);
        }
        out_.indices = std::move(indices);
    }

    std::vector<uint32_t> file_indices() {
        std::vector<uint32_t> out;
        if (!json_.has("indices")) {
            reading_.budget.charge(out_.positions.size(), sizeof(uint32_t), json_.place());
            out.resize(out_.positions.size());
            std::iota(out.begin(), out.end(), 0u);
            return out;
        }
        const AccessorView view = reading_.accessors.open(json_, "indices");
        if (view.format.type != "SCALAR" || !view.format.is_unsigned())
            json_.fail_at("indices", "must be SCALAR of unsigned integers, but is ", view.format.text());
        reading_.budget.charge(view.count(), sizeof(uint32_t), json_.place_of("indices"));
        const uint32_t restart = uint32_t((uint64_t(1) << 8 * size_of(view.format.component_type)) - 1);
        out.resize(view.count());
        for (uint32_t i = 0; i < out.size(); ++i) {
            reading_.budget.poll_at(i);
            out[i] = view.integer(i, 0);
            if (out[i] == restart)
                json_.fail_at("indices", "index ", restart, " is the primitive restart value, which glTF forbids");
        }
        return out;
    }

    // Strips and fans as glTF 2.0, 3.7.2.1 winds them.
    std::vector<uint32_t> triangle_list(const std::vector<uint32_t>& in, Mode mode) {
        std::vector<uint32_t> out;
        if (in.size() < 3) return in;
        reading_.budget.charge(in.size() * 3, sizeof(uint32_t), json_.place());
        out.reserve((in.size() - 2) * 3);
        for (size_t i = 0; i + 2 < in.size(); ++i) {
            if (mode == kTriangleFan)
                out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
            else
                out.insert(out.end(), {in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]});
        }
        return out;
    }

    Reading& reading_;
    JsonView json_;
    std::optional<JsonView> attributes_;
    std::optional<DracoMesh> draco_;
    AssetPrimitive out_;
};

// mesh.extras.targetNames: a convention of exporters, so what does not fit is no error.
std::vector<std::string> read_target_names(Reading& reading, const JsonView& mesh, uint32_t target_count) {
    const auto extras = mesh.find("extras");
    if (!extras || !extras->is_object()) return {};
    const auto names = extras->find("targetNames");
    if (!names) return {};
    std::vector<std::string> out;
    if (names->is_array() && names->size() == target_count)
        for (size_t t = 0; t < target_count; ++t)
            if ((*names)[t].is_string()) out.push_back((*names)[t].as_string());
    if (out.size() == target_count) return out;
    reading.warnings.add(names->place(), "is not a name for each morph target: it is ignored");
    return {};
}

}  // namespace

uint32_t morph_target_count(const JsonView& mesh) {
    const JsonView primitives = mesh.optional_array("primitives");
    return primitives.size() == 0 ? 0 : uint32_t(primitives[0].as_object().optional_array("targets").size());
}

std::vector<float> read_morph_weights(Reading& reading, const JsonView& json, uint32_t target_count) {
    if (!json.has("weights")) return {};
    const JsonView weights = json.required_array("weights");
    if (weights.size() != target_count)
        weights.fail("has ", weights.size(), " numbers, but the mesh has ", target_count, " morph targets");
    reading.budget.charge(target_count, sizeof(float), weights.place());
    std::vector<float> out;
    for (const JsonView weight : weights) out.push_back(weight.as_float());
    return out;
}

void read_meshes(Reading& reading, std::span<const TextureCoordinates> of_materials, Asset& asset) {
    const JsonView meshes = reading.charged_array("meshes", sizeof(AssetMesh));
    asset.meshes.reserve(meshes.size());
    for (const JsonView json : meshes) {
        reading.progress.report(asset.meshes.size(), meshes.size());
        AssetMesh mesh;
        mesh.name = read_name(reading, json);
        const uint32_t target_count = morph_target_count(json);
        const JsonView primitives = json.required_array("primitives");
        reading.budget.charge(primitives.size(), sizeof(AssetPrimitive), primitives.place());
        mesh.primitives.reserve(primitives.size());
        for (const JsonView primitive : primitives) {
            const JsonView targets = primitive.as_object().optional_array("targets");
            if (targets.size() != target_count)
                primitive.fail_at("targets", "has ", targets.size(), " morph targets, but the first primitive has ",
                                  target_count);
            mesh.primitives.push_back(PrimitiveReader(reading, primitive, asset, of_materials).take());
        }
        mesh.weights = read_morph_weights(reading, json, target_count);
        mesh.weights.resize(target_count);
        mesh.target_names = read_target_names(reading, json, target_count);
        asset.meshes.push_back(std::move(mesh));
    }
}

}  // namespace throng::gltf
