#include "glb_builder.h"

#include <array>
#include <cmath>

namespace throng::test {
namespace {

size_t components_of(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "MAT3") return 9;
    if (type == "MAT4") return 16;
    return size_t(type.back() - '0');
}

void append_word(std::string& out, uint32_t word) { out.append(reinterpret_cast<const char*>(&word), sizeof(word)); }

}  // namespace

GlbBuilder::GlbBuilder() {
    json["asset"] = {{"version", "2.0"}};
    for (const char* key : {"bufferViews", "accessors", "nodes"}) json[key] = GltfJson::array();
    json["buffers"] = GltfJson::array({GltfJson::object()});
}

size_t GlbBuilder::add_view(std::span<const std::byte> bytes) {
    bin.resize((bin.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
    bin.insert(bin.end(), bytes.begin(), bytes.end());
    return json["bufferViews"].size() - 1;
}

size_t GlbBuilder::add_accessor(size_t view, size_t component_count, const char* type, int component_type) {
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component_type},
                                 {"count", component_count / components_of(type)},
                                 {"type", type}});
    return json["accessors"].size() - 1;
}

std::string GlbBuilder::glb() const {
    GltfJson copy = json;
    if (!copy["buffers"].empty() && !copy["buffers"][0].contains("byteLength"))
        copy["buffers"][0]["byteLength"] = bin.size();
    std::string text = copy.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string content(reinterpret_cast<const char*>(bin.data()), bin.size());
    content.resize((content.size() + 3) / 4 * 4, '\0');

    std::string out = "glTF";
    append_word(out, 2);
    append_word(out, uint32_t(12 + 8 + text.size() + 8 + content.size()));
    append_word(out, uint32_t(text.size()));
    out += "JSON" + text;
    append_word(out, uint32_t(content.size()));
    out += std::string("BIN\0", 4) + content;
    return out;
}

std::string GlbBuilder::gltf() const {
    GltfJson copy = json;
    copy["buffers"][0]["byteLength"] = bin.size();
    copy["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bin);
    return copy.dump();
}

GlbBuilder tiny_character() {
    GlbBuilder b;
    const float half = std::sqrt(0.5f);
    b.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", kFloat);
    b.add<uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kUint8);
    b.add<float>({0.25f, 0.75f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", kFloat);
    b.add<uint16_t>({0, 1, 2}, "SCALAR", kUint16);
    b.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,  //
                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 2, 3, 1},
                 "MAT4", kFloat);
    b.add<float>({0, 1}, "SCALAR", kFloat);
    b.add<float>({0, 0, 0, 1, 0, 0, half, half}, "VEC4", kFloat);
    b.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", kFloat);

    b.json["nodes"] = {{{"name", "body"}, {"mesh", 0}, {"skin", 0}},
                       {{"name", "root"}, {"children", {2}}},
                       {{"name", "tip"}, {"translation", {1, -2, -3}}}};
    b.json["scenes"] = {{{"nodes", {0, 1}}}};
    b.json["scene"] = 0;
    b.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", kInverseBinds}}};
    b.json["meshes"] = {
        {{"primitives",
          {{{"attributes",
             {{"POSITION", kPosition}, {"JOINTS_0", kVertexJoints}, {"WEIGHTS_0", kWeights}, {"NORMAL", kNormals}}},
            {"indices", kIndices}}}}}};
    b.json["animations"] = {{{"name", "turn"},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}},
                             {"samplers", {{{"input", kTimes}, {"output", kRotations}}}}}};
    return b;
}

std::string base64(std::span<const std::byte> bytes) {
    constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](size_t k) { return i + k < bytes.size() ? uint32_t(bytes[i + k]) : 0; };
        const uint32_t bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for (size_t k = 0; k < 4; ++k) out.push_back(i + k > bytes.size() ? '=' : kAlphabet[bits >> (18 - 6 * k) & 63]);
    }
    return out;
}

}  // namespace throng::test
