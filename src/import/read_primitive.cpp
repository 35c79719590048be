#include "import/read_primitive.h"

#include "import/draco.h"
#include "import/kept_vertices.h"
#include "import/normals.h"
#include "import/triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

namespace throng::gltf {
namespace {

class PrimitiveReader {
public:
    PrimitiveReader(Reading& reading, const JsonView& json, AttributeNotes& notes, NeededJoints& needed)
        : reading_(reading), json_(json), notes_(notes), needed_(needed), kept_(reading.budget) {}

    AssetPrimitive read(const Asset& asset, std::span<const TextureCoordinates> of_materials) {
        out_.material = json_.optional_index("material", asset.materials.size(), "materials");
        const uint64_t mode = json_.optional_uint("mode", kTriangles);
        if (mode >= kModeCount) json_.fail_at("mode", mode, " is unknown");
        attributes_ = json_.optional_object("attributes");
        if (mode < kTriangles)
            warn("points and lines are not drawn");
        else if (!attributes_ || !attributes_->has("POSITION"))
            warn("has no POSITION: it is not drawn");
        else
            read_geometry(Mode(mode), asset, of_materials);
        return std::move(out_);
    }

private:
    void read_geometry(Mode mode, const Asset& asset, std::span<const TextureCoordinates> of_materials) {
        if (const auto compressed = json_.extension("KHR_draco_mesh_compression"))
            draco_.emplace(*compressed, reading_.buffers, reading_.budget);
        read_triangles_and_positions(mode);
        if (attributes_->has("NORMAL")) read_normals();
        if (out_.material == kNone)
            read_texcoords({});
        else
            read_texcoords(asset.materials[out_.material], of_materials[out_.material]);
        if (attributes_->has("COLOR_0")) read_colors();
        read_influences();
        draco_.reset();
        read_targets();
        make_normals();
    }

    void warn(const char* why) { reading_.warnings.add(json_.place(), why); }

    std::string place_of(const std::string& name) const { return attributes_->place_of(name); }

    AccessorFormat format_of(const std::string& name) {
        const AccessorFormat format = reading_.accessors.format(*attributes_, name);
        if (name != "POSITION") require_count(*attributes_, name, format);
        ++notes_.count;
        return format;
    }

    AccessorView open(const std::string& name, const AccessorFormat& format) {
        if (draco_)
            if (auto view = draco_->attribute(name, format)) return *view;
        return reading_.accessors.open(format);
    }

    // Fails unless there are as many elements as vertices.
    void require_count(const JsonView& attributes, const std::string& name, const AccessorFormat& format) const {
        if (format.count != file_count_)
            attributes.fail_at(name, "has ", format.count, " elements, but POSITION has ", file_count_);
    }

    using Types = std::initializer_list<const char*>;

    // `integers`: whether the component type may be other than float, by the rules of the attribute.
    void require(const JsonView& attributes, const std::string& name, const AccessorFormat& format, Types types,
                 bool integers) const {
        if (std::find(types.begin(), types.end(), format.type) == types.end())
            attributes.fail_at(name, "must be ", *types.begin(), ", but is ", format.type);
        if (!format.is_float() && !integers)
            attributes.fail_at(name, "must not be ", format.normalized ? "normalised " : "", format.component_text(),
                               reading_.quantized ? "" : " without KHR_mesh_quantization");
    }

    // Like require(), but takes integers that glTF does not allow there as normalised if they can only be meant that
    // way: tinygltf could not write "normalized" before 2019.
    AccessorFormat repaired(const std::string& name, AccessorFormat format, Types types, bool integers) {
        const bool as_normalised = is_short(format) && (format.is_unsigned() || name == "NORMAL");
        require(*attributes_, name, format, types, integers || as_normalised);
        if (format.is_float() || integers) return format;
        format.normalized = true;
        notes_.taken_as_normalised.add(place_of(name));
        return format;
    }

    static bool is_short(const AccessorFormat& format) { return size_of(format.component_type) <= 2; }
    // Unsigned and normalised: what texture coordinates, colours and weights may be without an extension.
    static bool is_fraction(const AccessorFormat& format) {
        return is_short(format) && format.is_unsigned() && format.normalized;
    }
    // Quantised normals and differences are signed, those of normals also normalised (KHR_mesh_quantization).
    bool is_quantized_signed(const AccessorFormat& format) const {
        return reading_.quantized && is_short(format) && !format.is_unsigned();
    }

    void read_triangles_and_positions(Mode mode) {
        const AccessorFormat format = format_of("POSITION");
        require(*attributes_, "POSITION", format, {"VEC3"}, reading_.quantized && is_short(format));
        file_count_ = format.count;
        const AccessorView view = open("POSITION", format);
        out_.indices = read_triangles(reading_, json_, mode, draco_ ? &*draco_ : nullptr, file_count_);
        if (draco_ || json_.has("indices"))
            kept_.keep_used(file_count_, out_.indices, place_of("POSITION"));
        else
            kept_.keep_all(file_count_);
        out_.positions = finite_vectors(*attributes_, "POSITION", view);
    }

    std::vector<Vec3<float>> finite_vectors(const JsonView& attributes, const char* name, const AccessorView& view) {
        reading_.budget.charge(kept_.count(), sizeof(Vec3<float>), attributes.place_of(name));
        std::vector<Vec3<float>> out(kept_.count());
        for (uint32_t v = 0; v < kept_.count(); ++v) {
            reading_.budget.poll_at(v);
            const uint32_t in_file = kept_.in_file(v);
            out[v] = {view.number(in_file, 0), view.number(in_file, 1), view.number(in_file, 2)};
            if (!std::isfinite(out[v].x) || !std::isfinite(out[v].y) || !std::isfinite(out[v].z))
                attributes.fail_at(name, "vertex ", in_file, " is not finite");
        }
        return out;
    }

    // Reads an attribute that only affects looks, so the file is not refused for values that are not finite. Components
    // that the file lacks are 1.
    template <class Element>
    void read_looks(const std::string& name, const AccessorFormat& format, std::vector<Element>& out) {
        const AccessorView view = open(name, format);
        reading_.budget.charge(kept_.count(), sizeof(Element), place_of(name));
        bool mended = false;
        out.reserve(kept_.count());
        for (uint32_t v = 0; v < kept_.count(); ++v) {
            reading_.budget.poll_at(v);
            std::array<float, sizeof(Element) / sizeof(float)> values;
            for (uint32_t c = 0; c < values.size(); ++c) {
                values[c] = c < format.component_count ? view.number(kept_.in_file(v), c) : 1;
                if (std::isfinite(values[c])) continue;
                mended = true;
                values[c] = 0;
            }
            out.push_back(std::bit_cast<Element>(values));
        }
        if (mended) reading_.warnings.add(place_of(name), "has values that are not finite: they are set to 0");
    }

    // Normals of another format are left out, since make_normals() can replace them.
    void read_normals() {
        const AccessorFormat format = format_of("NORMAL");
        if (format.type != "VEC3" || (!format.is_float() && (!is_short(format) || format.is_unsigned())))
            return notes_.left_out.add(place_of("NORMAL"));
        const bool integers = is_quantized_signed(format) && format.normalized;
        read_looks("NORMAL", repaired("NORMAL", format, {"VEC3"}, integers), out_.normals);
    }

    // Makes normals for vertices that have none in the file, or one of length 0.
    void make_normals() {
        const uint32_t vertex_count = kept_.count();
        const bool has_some = !out_.normals.empty();
        const auto is_missing = [](const Vec3<float>& normal) { return dot(normal, normal) == 0; };
        const ptrdiff_t missing = has_some ? std::ranges::count_if(out_.normals, is_missing) : ptrdiff_t(vertex_count);
        if (missing == 0) return;
        if (has_some) {
            TemporaryCharge charge(reading_.budget);
            charge.add(vertex_count, sizeof(Vec3<float>), json_.place());
            const std::vector<Vec3<float>> made = smooth_normals(out_);
            for (size_t v = 0; v < vertex_count; ++v)
                if (is_missing(out_.normals[v])) out_.normals[v] = made[v];
        } else {
            reading_.budget.charge(vertex_count, sizeof(Vec3<float>), json_.place());
            out_.normals = smooth_normals(out_);
        }
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
        const AccessorFormat format = format_of(name);
        const bool integers = is_fraction(format) || (reading_.quantized && is_short(format));
        read_looks(name, repaired(name, format, {"VEC2"}, integers), out_.texcoords);
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

    void read_colors() {
        const AccessorFormat format = format_of("COLOR_0");
        read_looks("COLOR_0", repaired("COLOR_0", format, {"VEC4", "VEC3"}, is_fraction(format)), out_.colors);
    }

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

    std::vector<Vec3<float>> read_differences(const JsonView& target, const char* name, bool is_normal) {
        if (!target.has(name)) return {};
        const AccessorFormat format = reading_.accessors.format(target, name);
        require(target, name, format, {"VEC3"}, is_quantized_signed(format) && (format.normalized || !is_normal));
        require_count(target, name, format);
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
        out_.influence_count = joint_sets * 4;
        constexpr uint64_t kInfluenceBytes = sizeof(uint16_t) + sizeof(float);
        reading_.budget.charge(kept_.count(), out_.influence_count * kInfluenceBytes, attributes_->place());
        out_.influence_joints.resize(size_t(kept_.count()) * out_.influence_count);
        out_.influence_weights.resize(out_.influence_joints.size());
        for (uint32_t set = 0; set < joint_sets; ++set) read_influences(set);
        forget_unused_joints();
    }

    void read_influences(uint32_t set) {
        const std::string joints_name = joined("JOINTS_", set), weights_name = joined("WEIGHTS_", set);
        const AccessorFormat joint_format = format_of(joints_name), weight_format = format_of(weights_name);
        if (joint_format.type != "VEC4" || !joint_format.is_unsigned() || !is_short(joint_format))
            attributes_->fail_at(joints_name, "must be VEC4 of unsigned 8- or 16-bit integers, but is ",
                                 joint_format.text());
        const AccessorView joints = open(joints_name, joint_format);
        const AccessorView weights = open(weights_name,
                                          repaired(weights_name, weight_format, {"VEC4"}, is_fraction(weight_format)));
        uint32_t not_finite_count = 0, negative_count = 0;  // vertices
        for (uint32_t v = 0; v < kept_.count(); ++v) {
            reading_.budget.poll_at(v);
            const uint32_t in_file = kept_.in_file(v);
            bool not_finite = false, negative = false;
            for (uint32_t k = 0; k < 4; ++k) {
                const float stored = weights.number(in_file, k);
                const bool finite = std::isfinite(stored);
                not_finite = not_finite || !finite;
                negative = negative || (finite && stored < 0);
                const size_t influence = size_t(v) * out_.influence_count + set * 4 + k;
                const uint32_t joint = joints.integer(in_file, k);
                const float weight = finite ? std::max(stored, 0.0f) : 0.0f;
                out_.influence_joints[influence] = uint16_t(joint);
                out_.influence_weights[influence] = weight;
                if (weight > 0 && joint >= needed_.count) needed_ = {joint + 1, in_file, place_of(joints_name)};
            }
            not_finite_count += not_finite;
            negative_count += negative;
        }
        warn_of_vertices(weights_name, not_finite_count, "have weights that are not finite: they are set to 0");
        warn_of_vertices(weights_name, negative_count, "have negative weights: they are set to 0");
    }

    void warn_of_vertices(const std::string& name, uint32_t count, const char* what) {
        if (count > 0) reading_.warnings.add(place_of(name), count, " of ", kept_.count(), " vertices ", what);
    }

    // A joint of weight 0 has no meaning, and files have anything there, so it is set to 0. But a vertex without any
    // weight follows its first joint (compile/mesh/mesh.cpp), so that one is kept.
    void forget_unused_joints() {
        const size_t count = out_.influence_count;
        for (size_t v = 0; v < out_.influence_weights.size(); v += count) {
            const auto weights = out_.influence_weights.begin() + ptrdiff_t(v);
            const bool weightless = std::all_of(weights, weights + ptrdiff_t(count), [](float w) { return w == 0; });
            for (size_t i = weightless ? 1 : 0; i < count; ++i)
                if (out_.influence_weights[v + i] == 0) out_.influence_joints[v + i] = 0;
        }
    }

    Reading& reading_;
    JsonView json_;
    AttributeNotes& notes_;
    NeededJoints& needed_;
    KeptVertices kept_;
    std::optional<JsonView> attributes_;
    std::optional<DracoMesh> draco_;
    uint32_t file_count_ = 0;  // of vertices, kept or not
    AssetPrimitive out_;
};

}  // namespace

AssetPrimitive read_primitive(Reading& reading, const JsonView& json, const Asset& asset,
                              std::span<const TextureCoordinates> of_materials, AttributeNotes& notes,
                              NeededJoints& needed) {
    return PrimitiveReader(reading, json, notes, needed).read(asset, of_materials);
}

}  // namespace throng::gltf
