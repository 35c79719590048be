#include "import/read_asset.h"

#include "base/read_file.h"
#include "import/readers.h"
#include "json/json_text.h"

#include <algorithm>

namespace throng::gltf {
namespace {

// "2.0": two numbers of up to five digits.
bool is_version(std::string_view text) {
    const size_t dot = text.find('.');
    const auto is_number = [](std::string_view digits) {
        return !digits.empty() && digits.size() < 6 && digits.find_first_not_of("0123456789") == digits.npos;
    };
    return dot != text.npos && is_number(text.substr(0, dot)) && is_number(text.substr(dot + 1));
}

void check_version(const JsonView& root) {
    const JsonView asset = root.required_object("asset");
    asset.required_string("version");
    for (const char* key : {"version", "minVersion"}) {
        const std::string* version = asset.optional_string(key);
        if (!version) continue;
        if (!is_version(*version)) asset.fail_at(key, "'", printable(*version), "' is not a version");
        const bool is_minimum = std::string_view(key) == "minVersion";
        if (std::stoi(*version) != 2 || (is_minimum && *version != "2.0"))
            throw Failure(ErrorCode::kUnsupported, asset.place_of(key), "glTF ", *version,
                          " is not supported, only 2.0");
    }
}

bool is_known(const std::string& extension) {
    constexpr std::string_view kKnown[] = {
        "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression",
        "KHR_texture_transform", "KHR_lights_punctual",     "KHR_texture_basisu",      "EXT_texture_webp"};
    return extension.starts_with("KHR_materials_") ||
           std::find(std::begin(kKnown), std::end(kKnown), extension) != std::end(kKnown);
}

// Returns whether KHR_mesh_quantization is used.
bool check_extensions(const JsonView& root) {
    bool quantized = false;
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        const bool required = std::string_view(key) == "extensionsRequired";
        for (const JsonView extension : root.optional_array(key)) {
            const std::string& name = extension.as_string();
            if (required && !is_known(name))
                throw Failure(ErrorCode::kUnsupported, extension.place(), "the extension ", printable(name),
                              " is not supported");
            quantized = quantized || name == "KHR_mesh_quantization";
        }
    }
    return quantized;
}

// What the parsed text will take, before it is parsed: nlohmann's values are 16 bytes, and each member of an object has
// its key beside it. Measured: not below what is really taken, at most twice it.
uint64_t parsed_bytes(std::string_view text) {
    uint64_t size_bytes = text.size();
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
            continue;
        }
        switch (c) {
            case '"':
                in_string = true;
                size_bytes += 32;
                break;
            case '{': size_bytes += 144; break;
            case '[': size_bytes += 64; break;
            case ':': size_bytes += 80; break;
            case ',': size_bytes += 32; break;
            default: break;
        }
    }
    return size_bytes;
}

Asset read_parts(std::span<const std::byte> bytes, const std::filesystem::path& folder, Warnings& warnings) {
    Budget budget;
    const Container container = open_container(bytes, warnings);
    const JsonText json = parse_json(container.json, budget);
    const JsonView root = json.view();
    root.as_object();
    check_version(root);
    const bool quantized = check_extensions(root);
    Buffers buffers(root, container, folder, budget);
    Accessors accessors(root, buffers, budget, warnings);
    Reading reading{root, buffers, accessors, budget, warnings, quantized};

    Asset asset;
    read_nodes(reading, asset);
    read_skins(reading, asset);
    read_clips(reading, asset);
    const std::vector<uint32_t> texcoord_sets = read_materials(reading, asset);
    read_meshes(reading, texcoord_sets, asset);
    read_mesh_instances(reading, asset);
    return asset;
}

std::string message_name(const std::filesystem::path& path) {
    const std::string name = printable(path.filename().string(), 120);
    return name.empty() ? printable(path.string(), 120) : name;
}

// Runs `body`; a Failure's place is given the file's name in front.
template <class Body>
auto in_file(const std::string& name, Body&& body) {
    try {
        return body();
    } catch (const Failure& failure) {
        const auto& [code, place, message] = failure.error;
        throw Failure(code, place.empty() ? name : name + ": " + place, message);
    }
}

}  // namespace

std::string read_name(Reading& reading, const JsonView& json) {
    const auto name = json.find("name");
    if (!name) return {};
    if (name->is_string()) return name->as_string();
    reading.warnings.add(name->place(), "is not a string: it is taken as no name");
    return {};
}

JsonText parse_json(std::string_view text, Budget& budget) {
    if (text.size() > kJsonLimitBytes)
        throw Failure(ErrorCode::kLimit, "", "the JSON is larger than the limit of 256 MiB");
    // Some exporters pad the JSON chunk of a GLB with zeros in place of spaces.
    text = text.substr(0, text.find_last_not_of('\0') + 1);
    budget.charge(parsed_bytes(text), "");
    return JsonText(text, JsonAuthor::kProgram);
}

Asset read_asset(std::span<const std::byte> bytes, const std::filesystem::path& origin) {
    const std::string name = message_name(origin);
    return in_file(name, [&] {
        Warnings warnings(name);
        Asset asset = read_parts(bytes, origin.parent_path(), warnings);
        asset.name = printable(origin.filename().string(), std::string::npos);
        asset.warnings = warnings.take();
        return asset;
    });
}

}  // namespace throng::gltf

namespace throng {

Result<Asset> load_asset(const std::filesystem::path& path) {
    const std::string name = gltf::message_name(path);
    return as_result([&] { return gltf::read_asset(read_file(path, gltf::kFileLimitBytes, name), path); }, name);
}

}  // namespace throng
