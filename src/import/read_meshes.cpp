#include "import/draco.h"
#include "import/readers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace throng::gltf {
namespace {

enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan, kModeCount };

// Reads the attributes and indices of one primitive.
class PrimitiveReader {
public:
    PrimitiveReader(Reading& reading, const JsonView& json, const Asset& asset,
                    const std::vector<uint32_t>& texcoord_sets)
        : reading_(reading), json_(json), place_(json.place_of("attributes")) {
        out_.material = json.optional_index("material", asset.materials.size(), "materials");
        const uint64_t mode = json.optional_uint("mode", kTriangles);
        if (mode >= kModeCount)
            throw Failure(ErrorCode::kInvalidFile, json.place_of("mode"), std::to_string(mode) + " is unknown");
        attributes_ = json.optional_object("attributes");
        if (mode < kTriangles)
            warn("points and lines are not drawn");
        else if (!attributes_ || !attributes_->has("POSITION"))
            warn("has no POSITION: it is not drawn");
        else
            read_triangles(Mode(mode), asset, texcoord_sets);
    }

    AssetPrimitive take() { return std::move(out_); }

private:
    void read_triangles(Mode mode, const Asset& asset, const std::vector<uint32_t>& texcoord_sets) {
        if (const auto compressed = json_.extension("KHR_draco_mesh_compression"))
            draco_.emplace(*compressed, reading_.buffers, reading_.budget);
        read_positions();
        if (attributes_->has("NORMAL")) read_normals();
        if (out_.material == kNone)
            read_texcoord_set(0);
        else
            read_texcoords(asset.materials[out_.material], texcoord_sets[out_.material]);
        if (attributes_->has("COLOR_0")) read_colors();
        read_targets();
        read_influences();
        read_indices(mode);
    }

    void warn(const char* why) { reading_.warnings.add(json_.place(), why); }

    std::string place_of(const std::string& name) const { return place_ + "." + name; }

    [[noreturn]] void fail(const std::string& name, const std::string& what) const {
        throw Failure(ErrorCode::kInvalidFile, place_of(name), what);
    }

    // The attribute's data; there are as many elements as vertices, and `element_bytes` are charged for each.
    AccessorView open(const std::string& name, uint64_t element_bytes) {
        const AccessorFormat format = reading_.accessors.format(*attributes_, name.c_str());
        if (name != "POSITION" && format.count != out_.positions.size())
            fail(name, "has " + std::to_string(format.count) + " elements, but POSITION has " +
                           std::to_string(out_.positions.size()));
        reading_.budget.charge(format.count, element_bytes, place_of(name));
        if (draco_)
            if (auto view = draco_->attribute(name.c_str(), format)) return *view;
        return reading_.accessors.open(format);
    }

    // `integers`: whether the component type may be other than float, by the rules of the attribute.
    void require(const std::string& name, const AccessorFormat& format, std::initializer_list<const char*> types,
                 bool integers) {
        const std::string type = *types.begin();
        if (std::find(types.begin(), types.end(), format.type) == types.end())
            fail(name, "must be " + type + ", but is " + format.type);
        if (!format.is_float() && !integers)
            fail(name, std::string("must not be ") + (format.normalized ? "normalised " : "") +
                           name_of(format.component_type) +
                           (reading_.quantized ? "" : " without KHR_mesh_quantization"));
    }

    static bool is_short(const AccessorFormat& format) { return size_of(format.component_type) <= 2; }
    // Unsigned and normalised: what texture coordinates, colours and weights may be without an extension.
    static bool is_fraction(const AccessorFormat& format) {
        return is_short(format) && format.is_unsigned() && format.normalized;
    }

    void read_positions() {
        const AccessorView view = open("POSITION", sizeof(Vec3<float>));
        require("POSITION", view.format, {"VEC3"}, reading_.quantized && is_short(view.format));
        out_.positions.resize(view.count());
        for (uint32_t v = 0; v < view.count(); ++v) {
            const Vec3<float> position{view.number(v, 0), view.number(v, 1), view.number(v, 2)};
            if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z))
                fail("POSITION", "vertex " + std::to_string(v) + " is not finite");
            out_.positions[v] = position;
        }
    }

    // Only what looks wrong depends on these: not worth refusing the file.
    float finite_or_zero(const AccessorView& view, uint32_t vertex, uint32_t component) {
        const float value = view.number(vertex, component);
        mended_ = mended_ || !std::isfinite(value);
        return std::isfinite(value) ? value : 0;
    }
    void warn_if_mended(const std::string& name) {
        if (std::exchange(mended_, false))
            reading_.warnings.add(place_of(name), "has values that are not finite: they are set to 0");
    }

    void read_normals() {
        const std::string name = "NORMAL";
        const AccessorView view = open(name, sizeof(Vec3<float>));
        require(name, view.format, {"VEC3"},
                reading_.quantized && is_short(view.format) && !view.format.is_unsigned() && view.format.normalized);
        out_.normals.resize(view.count());
        for (uint32_t v = 0; v < view.count(); ++v)
            out_.normals[v] = {finite_or_zero(view, v, 0), finite_or_zero(view, v, 1), finite_or_zero(view, v, 2)};
        warn_if_mended(name);
    }

    void read_texcoords(const AssetMaterial& material, uint32_t set) {
        bool has_texture = false;
        visit_images([&](auto member) { has_texture = has_texture || material.*member != kNone; });
        if (!read_texcoord_set(set) && has_texture)
            warn("its material has a texture, but it has no texture coordinates for it");
    }

    bool read_texcoord_set(uint32_t set) {
        const std::string name = "TEXCOORD_" + std::to_string(set);
        if (!attributes_->has(name.c_str())) return false;
        const AccessorView view = open(name, sizeof(std::array<float, 2>));
        require(name, view.format, {"VEC2"}, is_fraction(view.format) || (reading_.quantized && is_short(view.format)));
        out_.texcoords.resize(view.count());
        for (uint32_t v = 0; v < view.count(); ++v)
            out_.texcoords[v] = {finite_or_zero(view, v, 0), finite_or_zero(view, v, 1)};
        warn_if_mended(name);
        return true;
    }

    void read_colors() {
        const std::string name = "COLOR_0";
        const AccessorView view = open(name, sizeof(std::array<float, 4>));
        require(name, view.format, {"VEC4", "VEC3"}, is_fraction(view.format));
        out_.colors.resize(view.count());
        for (uint32_t v = 0; v < view.count(); ++v) {
            auto& color = out_.colors[v] = {1, 1, 1, 1};
            for (uint32_t c = 0; c < view.format.component_count; ++c) color[c] = finite_or_zero(view, v, c);
        }
        warn_if_mended(name);
    }

    // KHR_draco_mesh_compression leaves morph targets as they are.
    void read_targets() {
        const JsonView targets = json_.optional_array("targets");
        reading_.budget.charge(targets.size(), sizeof(AssetMorphTarget), targets.place());
        out_.targets.resize(targets.size());
        for (size_t t = 0; t < targets.size(); ++t) {
            const JsonView target = targets[t].as_object();
            out_.targets[t].positions = read_differences(target, "POSITION", false);
            out_.targets[t].normals = read_differences(target, "NORMAL", true);
        }
    }

    // Quantised ones are signed, those of normals normalised (KHR_mesh_quantization).
    std::vector<Vec3<float>> read_differences(const JsonView& target, const char* name, bool is_normal) {
        if (!target.has(name)) return {};
        const AccessorFormat format = reading_.accessors.format(target, name);
        const std::string place = target.place_of(name);
        const auto refuse = [&](const std::string& what) { throw Failure(ErrorCode::kInvalidFile, place, what); };
        const bool quantized = reading_.quantized && is_short(format) && !format.is_unsigned() &&
                               (format.normalized || !is_normal);
        if (format.type != "VEC3") refuse("must be VEC3, but is " + format.type);
        if (!format.is_float() && !quantized)
            refuse(std::string("must not be ") + (format.normalized ? "normalised " : "") +
                   name_of(format.component_type) + (reading_.quantized ? "" : " without KHR_mesh_quantization"));
        if (format.count != out_.positions.size())
            refuse("has " + std::to_string(format.count) + " elements, but POSITION has " +
                   std::to_string(out_.positions.size()));
        reading_.budget.charge(format.count, sizeof(Vec3<float>), place);
        const AccessorView view = reading_.accessors.open(format);
        std::vector<Vec3<float>> out(view.count());
        for (uint32_t v = 0; v < view.count(); ++v) {
            out[v] = {view.number(v, 0), view.number(v, 1), view.number(v, 2)};
            if (!std::isfinite(out[v].x) || !std::isfinite(out[v].y) || !std::isfinite(out[v].z))
                refuse("vertex " + std::to_string(v) + " is not finite");
        }
        return out;
    }

    // How many of <prefix>0, <prefix>1, … there are without a gap.
    uint32_t set_count(const std::string& prefix) {
        uint32_t count = 0;
        while (attributes_->has((prefix + std::to_string(count)).c_str())) ++count;
        const auto names = attributes_->keys();
        const auto all = std::count_if(names.begin(), names.end(),
                                       [&](const std::string& name) { return name.starts_with(prefix); });
        if (uint64_t(all) != count)
            reading_.warnings.add(place_of(prefix + std::to_string(count)),
                                  "is missing: the sets after it are ignored");
        return count;
    }

    void read_influences() {
        const uint32_t joint_sets = set_count("JOINTS_"), weight_sets = set_count("WEIGHTS_");
        if (joint_sets != weight_sets)
            throw Failure(ErrorCode::kInvalidFile, place_,
                          "there are " + std::to_string(joint_sets) + " sets of JOINTS, but " +
                              std::to_string(weight_sets) + " of WEIGHTS");
        const size_t influence_count = size_t(joint_sets) * 4;
        out_.influence_count = uint32_t(influence_count);
        for (uint32_t set = 0; set < joint_sets; ++set) {
            const std::string joints_name = "JOINTS_" + std::to_string(set),
                              weights_name = "WEIGHTS_" + std::to_string(set);
            const AccessorView joints = open(joints_name, 4 * sizeof(uint16_t));
            const AccessorView weights = open(weights_name, 4 * sizeof(float));
            if (joints.format.type != "VEC4" || !joints.format.is_unsigned() || !is_short(joints.format))
                fail(joints_name, "must be VEC4 of unsigned 8- or 16-bit integers, but is " + joints.format.type +
                                      " of " + name_of(joints.format.component_type));
            require(weights_name, weights.format, {"VEC4"}, is_fraction(weights.format));
            // Here and not before: the counts are known to be true by now.
            out_.influence_joints.resize(out_.positions.size() * influence_count);
            out_.influence_weights.resize(out_.positions.size() * influence_count);
            uint32_t not_finite_count = 0, negative_count = 0;  // vertices
            for (uint32_t v = 0; v < joints.count(); ++v) {
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
        if (count == 0) return;
        reading_.warnings.add(place_of(name), std::to_string(count) + " of " + std::to_string(out_.positions.size()) +
                                                  " vertices " + what);
    }

    // Where the weight is 0 the joint means nothing, and files have anything there. But a vertex without any weight
    // follows its first joint (compile/mesh/mesh.cpp).
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
        const std::string place = json_.place_of("indices");
        for (const uint32_t index : indices)
            if (index >= out_.positions.size())
                throw Failure(ErrorCode::kInvalidFile, place,
                              "index " + std::to_string(index) + ", but there are " +
                                  std::to_string(out_.positions.size()) + " vertices");
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
            for (uint32_t i = 0; i < out.size(); ++i) out[i] = i;
            return out;
        }
        const AccessorView view = reading_.accessors.open(json_, "indices");
        const std::string place = json_.place_of("indices");
        if (view.format.type != "SCALAR" || !view.format.is_unsigned())
            throw Failure(ErrorCode::kInvalidFile, place,
                          "must be SCALAR of unsigned integers, but is " + view.format.type + " of " +
                              name_of(view.format.component_type));
        reading_.budget.charge(view.count(), sizeof(uint32_t), place);
        const uint32_t restart = uint32_t((uint64_t(1) << 8 * size_of(view.format.component_type)) - 1);
        out.resize(view.count());
        for (uint32_t i = 0; i < out.size(); ++i) {
            out[i] = view.integer(i, 0);
            if (out[i] == restart)
                throw Failure(
                    ErrorCode::kInvalidFile, place,
                    "index " + std::to_string(restart) + " is the primitive restart value, which glTF forbids");
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
    std::string place_;
    std::optional<JsonView> attributes_;
    std::optional<DracoMesh> draco_;
    AssetPrimitive out_;
    bool mended_ = false;
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
    const JsonView weights = json.optional_array("weights");
    if (!json.has("weights")) return {};
    if (weights.size() != target_count)
        weights.fail("has " + std::to_string(weights.size()) + " numbers, but the mesh has " +
                     std::to_string(target_count) + " morph targets");
    reading.budget.charge(target_count, sizeof(float), weights.place());
    std::vector<float> out;
    for (size_t t = 0; t < target_count; ++t) out.push_back(float(weights[t].as_number()));
    return out;
}

void read_meshes(Reading& reading, const std::vector<uint32_t>& texcoord_sets, Asset& asset) {
    const JsonView meshes = reading.root.optional_array("meshes");
    reading.budget.charge(meshes.size(), sizeof(AssetMesh), meshes.place());
    asset.meshes.reserve(meshes.size());
    for (size_t m = 0; m < meshes.size(); ++m) {
        AssetMesh mesh;
        mesh.name = read_name(reading, meshes[m]);
        const uint32_t target_count = morph_target_count(meshes[m]);
        const JsonView primitives = meshes[m].required_array("primitives");
        reading.budget.charge(primitives.size(), sizeof(AssetPrimitive), primitives.place());
        mesh.primitives.reserve(primitives.size());
        for (size_t p = 0; p < primitives.size(); ++p) {
            const JsonView targets = primitives[p].as_object().optional_array("targets");
            if (targets.size() != target_count)
                throw Failure(ErrorCode::kInvalidFile, primitives[p].place_of("targets"),
                              "has " + std::to_string(targets.size()) + " morph targets, but the first primitive has " +
                                  std::to_string(target_count));
            mesh.primitives.push_back(PrimitiveReader(reading, primitives[p], asset, texcoord_sets).take());
        }
        mesh.weights = read_morph_weights(reading, meshes[m], target_count);
        mesh.weights.resize(target_count);
        mesh.target_names = read_target_names(reading, meshes[m], target_count);
        asset.meshes.push_back(std::move(mesh));
    }
}

}  // namespace throng::gltf
