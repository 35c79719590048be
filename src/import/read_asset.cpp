#include "import/read_asset.h"

#include "import/readers.h"
#include "import/uri.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace throng::gltf {
namespace {

void check_version(const JsonView& root) {
    const JsonView asset = root.required_object("asset");
    const auto check = [&](const char* key, const std::string& version) {
        const JsonView at = *asset.find(key);
        const size_t dot = version.find('.');
        const auto is_number = [](std::string_view text) {
            return !text.empty() && text.size() < 6 &&
                   std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
        };
        if (dot == version.npos || !is_number(std::string_view(version).substr(0, dot)) ||
            !is_number(std::string_view(version).substr(dot + 1)))
            at.fail("'" + printable(version) + "' is not a version");
        const bool is_minimum = std::string_view(key) == "minVersion";
        if (std::stoi(version) != 2 || (is_minimum && version != "2.0"))
            at.fail("glTF " + version + " is not supported, only 2.0", ErrorCode::kUnsupported);
    };
    check("version", asset.required_string("version"));
    if (const std::string* minimum = asset.optional_string("minVersion")) check("minVersion", *minimum);
}

bool is_known(const std::string& extension) {
    constexpr std::string_view kKnown[] = {
        "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_draco_mesh_compression",
        "KHR_texture_transform", "KHR_lights_punctual",     "KHR_texture_basisu",
        "EXT_texture_webp"};
    return extension.starts_with("KHR_materials_") ||
           std::find(std::begin(kKnown), std::end(kKnown), extension) != std::end(kKnown);
}

// Returns whether KHR_mesh_quantization is used.
bool check_extensions(const JsonView& root) {
    bool quantized = false;
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        const bool required = std::string_view(key) == "extensionsRequired";
        const JsonView names = root.optional_array(key);
        for (size_t i = 0; i < names.size(); ++i) {
            const std::string& name = names[i].as_string();
            if (required && !is_known(name))
                names[i].fail("the extension " + printable(name) + " is not supported", ErrorCode::kUnsupported);
            quantized = quantized || name == "KHR_mesh_quantization";
        }
    }
    return quantized;
}

Asset read_parts(std::span<const std::byte> bytes, const std::filesystem::path& folder, Warnings& warnings) {
    Budget budget;
    const Container container = open_container(bytes, warnings);
    const Json json = parse_json(container.json, budget);
    const JsonView root(json, "");
    root.as_object();
    check_version(root);
    const bool quantized = check_extensions(root);
    Buffers buffers(root, container, folder, budget);
    Accessors accessors(root, buffers, budget);
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
        const Error& error = failure.error;
        throw Failure(error.code, error.place.empty() ? name : name + ": " + error.place, error.message);
    } catch (const Json::exception& error) {
        throw Failure(ErrorCode::kInvalidFile, name, "the JSON cannot be used: " + printable(error.what(), 200));
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
    return as_result(
        [&] {
            const std::vector<std::byte> bytes = gltf::in_file(
                name, [&] { return gltf::read_file(path, gltf::kFileLimitBytes, ""); });
            return gltf::read_asset(bytes, path);
        },
        name);
}

}  // namespace throng
