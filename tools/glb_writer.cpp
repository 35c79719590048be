#include "glb_writer.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <new>
#include <string_view>
#include <type_traits>

namespace throng {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// JSON text; commas are put where they belong.
class Json {
public:
    const std::string& text() const { return text_; }

    Json& begin_object() { return open('{'); }
    Json& end_object() { return close('}'); }
    Json& begin_array() { return open('['); }
    Json& end_array() { return close(']'); }
    Json& key(std::string_view name) {
        value(name);
        text_ += ':';
        needs_comma_ = false;
        return *this;
    }
    Json& value(std::string_view string) {
        separate();
        text_ += '"';
        for (const char c : string) append(c);
        text_ += '"';
        return *this;
    }
    Json& value(const char* string) { return value(std::string_view(string)); }
    Json& value(bool flag) {
        separate();
        text_ += flag ? "true" : "false";
        return *this;
    }
    // Shortest decimal that reads back as the same number.
    template <class Number>
    requires std::is_arithmetic_v<Number> Json& value(Number number) {
        separate();
        char digits[32];
        text_.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
        return *this;
    }
    template <class Range>
    Json& values(const Range& numbers) {
        begin_array();
        for (const auto number : numbers) value(number);
        return end_array();
    }

private:
    Json& open(char bracket) {
        separate();
        text_ += bracket;
        needs_comma_ = false;
        return *this;
    }
    Json& close(char bracket) {
        text_ += bracket;
        needs_comma_ = true;
        return *this;
    }
    void separate() {
        if (needs_comma_) text_ += ',';
        needs_comma_ = true;
    }
    void append(char c) {
        constexpr char kHex[] = "0123456789abcdef";
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') text_ += '\\';
        if (code >= 0x20)
            text_ += c;
        else
            text_.append("\\u00").append(1, kHex[code >> 4]).append(1, kHex[code & 15]);
    }

    std::string text_;
    bool needs_comma_ = false;
};

enum class Target : uint32_t { kNone = 0, kVertices = 34962, kIndices = 34963 };
enum class Component : uint32_t { kU16 = 5123, kU32 = 5125, kFloat = 5126 };

struct BufferView {
    size_t offset_bytes, size_bytes, stride_bytes;  // stride 0: tightly packed
    Target target;
};
struct Accessor {
    size_t view, count;
    const char* type;
    Component component;
    std::vector<float> least, most;  // where glTF asks for them
};

class GlbWriter {
public:
    explicit GlbWriter(const Asset& asset) : asset_(asset) {}

    Result<std::vector<std::byte>> write() {
        json_.begin_object();
        json_.key("asset").begin_object().key("version").value("2.0").key("generator").value("throng").end_object();
        write_nodes();
        write_skins();
        write_materials();
        write_meshes();
        write_clips();
        write_buffer();
        json_.end_object();
        return pack();
    }

private:
    template <class Write>
    void array(const char* name, size_t count, Write&& write) {
        if (count == 0) return;  // glTF forbids empty arrays
        json_.key(name).begin_array();
        for (size_t i = 0; i < count; ++i) {
            json_.begin_object();
            write(i);
            json_.end_object();
        }
        json_.end_array();
    }
    void name(const std::string& name) {
        if (!name.empty()) json_.key("name").value(name);
    }

    template <class T>
    size_t add_accessor(const std::vector<T>& data, size_t elements, const char* type, Component component,
                        Target target) {
        binary_.resize((binary_.size() + 3) / 4 * 4);
        const size_t size_bytes = data.size() * sizeof(T);
        views_.push_back({binary_.size(), size_bytes, target == Target::kVertices ? size_bytes / elements : 0, target});
        const auto* bytes = reinterpret_cast<const std::byte*>(data.data());
        binary_.insert(binary_.end(), bytes, bytes + size_bytes);
        accessors_.push_back({views_.size() - 1, elements, type, component, {}, {}});
        return accessors_.size() - 1;
    }
    // The smallest and the largest of each component over the data of the last accessor.
    template <size_t kComponents, class T>
    void add_range(const std::vector<T>& data) {
        const auto* value = reinterpret_cast<const float*>(data.data());
        Accessor& accessor = accessors_.back();
        accessor.least.assign(kComponents, std::numeric_limits<float>::max());
        accessor.most.assign(kComponents, std::numeric_limits<float>::lowest());
        for (size_t i = 0; i < accessor.count * kComponents; ++i) {
            accessor.least[i % kComponents] = std::min(accessor.least[i % kComponents], value[i]);
            accessor.most[i % kComponents] = std::max(accessor.most[i % kComponents], value[i]);
        }
    }

    void write_nodes() {
        const auto& nodes = asset_.nodes;
        std::vector<std::vector<size_t>> children(nodes.size());
        std::vector<size_t> roots;
        for (size_t i = 0; i < nodes.size(); ++i)
            (nodes[i].parent == kNone ? roots : children[nodes[i].parent]).push_back(i);
        json_.key("scene").value(0);
        json_.key("scenes").begin_array().begin_object().key("nodes").values(roots).end_object().end_array();
        std::vector<const AssetMeshInstance*> instance_of(nodes.size());
        for (const AssetMeshInstance& instance : asset_.mesh_instances) instance_of[instance.node] = &instance;
        array("nodes", nodes.size(), [&](size_t i) {
            name(nodes[i].name);
            const Trs<double>& trs = nodes[i].parent_from_node;
            const auto &t = trs.translation, &s = trs.scale;
            const auto& r = trs.rotation;
            if (t != Vec3<double>{}) json_.key("translation").values(std::array{t.x, t.y, t.z});
            if (r != Quaternion<double>{}) json_.key("rotation").values(std::array{r.x, r.y, r.z, r.w});
            if (s != Vec3<double>{1, 1, 1}) json_.key("scale").values(std::array{s.x, s.y, s.z});
            if (!children[i].empty()) json_.key("children").values(children[i]);
            if (const AssetMeshInstance* instance = instance_of[i]) {
                json_.key("mesh").value(instance->mesh);
                if (instance->skin != kNone) json_.key("skin").value(instance->skin);
            }
        });
    }

    void write_skins() {
        array("skins", asset_.skins.size(), [&](size_t i) {
            const AssetSkin& skin = asset_.skins[i];
            std::vector<float> matrices;  // column-major 4x4
            for (const Affine& m : skin.inverse_binds)
                for (size_t column = 0; column < 4; ++column)
                    matrices.insert(matrices.end(),
                                    {m.row[0][column], m.row[1][column], m.row[2][column], column == 3 ? 1.f : 0.f});
            name(skin.name);
            json_.key("joints").values(skin.joints);
            json_.key("inverseBindMatrices")
                .value(add_accessor(matrices, skin.inverse_binds.size(), "MAT4", Component::kFloat, Target::kNone));
        });
    }

    void write_materials() {
        array("materials", asset_.materials.size(), [&](size_t i) {
            const AssetMaterial& material = asset_.materials[i];
            name(material.name);
            json_.key("pbrMetallicRoughness").begin_object();
            json_.key("baseColorFactor").values(material.base_color);
            json_.key("metallicFactor").value(0).end_object();
            if (material.alpha_mode != AlphaMode::kOpaque)
                json_.key("alphaMode").value(material.alpha_mode == AlphaMode::kMask ? "MASK" : "BLEND");
            if (material.alpha_mode == AlphaMode::kMask) json_.key("alphaCutoff").value(material.alpha_cutoff);
            if (material.double_sided) json_.key("doubleSided").value(true);
        });
    }

    void write_meshes() {
        array("meshes", asset_.meshes.size(), [&](size_t i) {
            name(asset_.meshes[i].name);
            array("primitives", asset_.meshes[i].primitives.size(),
                  [&](size_t k) { write_primitive(asset_.meshes[i].primitives[k]); });
        });
    }

    void write_primitive(const AssetPrimitive& p) {
        const size_t vertices = p.positions.size();
        const auto attribute = [&](const char* semantic, const auto& data, const char* type, Component component) {
            json_.key(semantic).value(add_accessor(data, vertices, type, component, Target::kVertices));
        };
        json_.key("attributes").begin_object();
        attribute("POSITION", p.positions, "VEC3", Component::kFloat);
        add_range<3>(p.positions);
        if (!p.normals.empty()) attribute("NORMAL", p.normals, "VEC3", Component::kFloat);
        if (!p.colors.empty()) attribute("COLOR_0", p.colors, "VEC4", Component::kFloat);
        if (p.influence_count > 0) {
            attribute("JOINTS_0", p.influence_joints, "VEC4", Component::kU16);
            attribute("WEIGHTS_0", p.influence_weights, "VEC4", Component::kFloat);
        }
        json_.end_object();
        if (p.material != kNone) json_.key("material").value(p.material);
        // 65,535 itself is the primitive restart value.
        if (vertices <= 65535) {
            const std::vector<uint16_t> narrow(p.indices.begin(), p.indices.end());
            json_.key("indices").value(
                add_accessor(narrow, narrow.size(), "SCALAR", Component::kU16, Target::kIndices));
        } else {
            json_.key("indices").value(
                add_accessor(p.indices, p.indices.size(), "SCALAR", Component::kU32, Target::kIndices));
        }
    }

    void write_clips() {
        array("animations", asset_.clips.size(), [&](size_t i) {
            const AssetClip& clip = asset_.clips[i];
            name(clip.name);
            const std::vector<float>* times_s = nullptr;  // written last; tracks with the same times share them
            size_t time_accessor = 0;
            array("samplers", clip.tracks.size(), [&](size_t k) {
                const AssetTrack& track = clip.tracks[k];
                if (!times_s || *times_s != track.times_s) {
                    times_s = &track.times_s;
                    time_accessor =
                        add_accessor(track.times_s, track.times_s.size(), "SCALAR", Component::kFloat, Target::kNone);
                    add_range<1>(track.times_s);
                }
                const size_t components = track.target == TrackTarget::kRotation ? 4 : 3;
                json_.key("input")
                    .value(time_accessor)
                    .key("output")
                    .value(add_accessor(track.values, track.values.size() / components,
                                        components == 4 ? "VEC4" : "VEC3", Component::kFloat, Target::kNone));
                json_.key("interpolation").value(name_of(track.interpolation));
            });
            array("channels", clip.tracks.size(), [&](size_t k) {
                json_.key("sampler").value(k).key("target").begin_object();
                json_.key("node")
                    .value(clip.tracks[k].node)
                    .key("path")
                    .value(name_of(clip.tracks[k].target))
                    .end_object();
            });
        });
    }
    static const char* name_of(Interpolation interpolation) {
        switch (interpolation) {
            case Interpolation::kStep: return "STEP";
            case Interpolation::kLinear: return "LINEAR";
            case Interpolation::kCubicSpline: return "CUBICSPLINE";
        }
        return "";
    }
    static const char* name_of(TrackTarget target) {
        switch (target) {
            case TrackTarget::kTranslation: return "translation";
            case TrackTarget::kRotation: return "rotation";
            case TrackTarget::kScale: return "scale";
        }
        return "";
    }

    void write_buffer() {
        array("accessors", accessors_.size(), [&](size_t i) {
            const Accessor& a = accessors_[i];
            json_.key("bufferView").value(a.view).key("componentType").value(uint32_t(a.component));
            json_.key("count").value(a.count).key("type").value(a.type);
            if (!a.least.empty()) json_.key("min").values(a.least).key("max").values(a.most);
        });
        array("bufferViews", views_.size(), [&](size_t i) {
            const BufferView& v = views_[i];
            json_.key("buffer").value(0).key("byteOffset").value(v.offset_bytes).key("byteLength").value(v.size_bytes);
            if (v.stride_bytes > 0) json_.key("byteStride").value(v.stride_bytes);
            if (v.target != Target::kNone) json_.key("target").value(uint32_t(v.target));
        });
        binary_.resize((binary_.size() + 3) / 4 * 4);
        if (!binary_.empty())
            json_.key("buffers")
                .begin_array()
                .begin_object()
                .key("byteLength")
                .value(binary_.size())
                .end_object()
                .end_array();
    }

    // Header, JSON chunk filled up with spaces, binary chunk filled up with zeros.
    Result<std::vector<std::byte>> pack() const {
        std::string text = json_.text();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const uint64_t total = 12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size());
        if (total > 0xFFFFFFFFu) return Error{ErrorCode::kLimit, asset_.name, "a .glb file of 4 GiB or more"};
        std::vector<std::byte> out;
        out.reserve(total);
        const auto word = [&](uint64_t value) {
            const auto bytes = std::bit_cast<std::array<std::byte, 4>>(uint32_t(value));
            out.insert(out.end(), bytes.begin(), bytes.end());
        };
        word(0x46546C67);  // "glTF"
        word(2);
        word(total);
        word(text.size());
        word(0x4E4F534A);  // "JSON"
        const auto* characters = reinterpret_cast<const std::byte*>(text.data());
        out.insert(out.end(), characters, characters + text.size());
        if (!binary_.empty()) {
            word(binary_.size());
            word(0x004E4942);  // "BIN"
            out.insert(out.end(), binary_.begin(), binary_.end());
        }
        return out;
    }

    const Asset& asset_;
    Json json_;
    std::vector<std::byte> binary_;
    std::vector<BufferView> views_;
    std::vector<Accessor> accessors_;
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
            if (p.morph_target_count > 0) return unsupported(place, "morph targets cannot be written");
            if (p.influence_count != 0 && p.influence_count != 4)
                return unsupported(place, "only four influences a vertex can be written");
        }
    return {};
}

}  // namespace

Result<std::vector<std::byte>> write_glb(const Asset& asset) {
    if (const Result<void> checked = check(asset); !checked) return checked.error();
    try {
        return GlbWriter(asset).write();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kOutOfMemory, asset.name, "out of memory"};
    }
}

}  // namespace throng
