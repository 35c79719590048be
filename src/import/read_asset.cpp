#include "import/read_asset.h"

#include "base/message_name.h"
#include "base/read_file.h"
#include "import/readers.h"
#include "json/json_text.h"

#include <algorithm>

namespace throng::gltf {
namespace {

// Rough share of the work that is done when the file is read; then, of the work on its content, after each part.
constexpr double kFileRead = 0.3, kParsed = 0.2, kClipsRead = 0.5, kMaterialsRead = 0.6;

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
    constexpr const char* kOnly = " is not supported, only 2.0; tools such as Blender read it and write 2.0";
    // Early files of glTF 1.0 have a number there.
    if (const JsonView version = asset.required("version"); version.is_number() && version.as_number() < 2)
        throw Failure(ErrorCode::kUnsupported, version.place(), "glTF 1.0", kOnly);
    asset.required_string("version");
    for (const char* key : {"version", "minVersion"}) {
        const std::string* version = asset.optional_string(key);
        if (!version) continue;
        if (!is_version(*version)) asset.fail_at(key, "'", printable(*version), "' is not a version");
        const bool is_minimum = std::string_view(key) == "minVersion";
        if (std::stoi(*version) != 2 || (is_minimum && *version != "2.0"))
            throw Failure(ErrorCode::kUnsupported, asset.place_of(key), "glTF ", *version, kOnly);
    }
}

bool is_known(const std::string& extension) {
    constexpr std::string_view kKnown[] = {
        "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression",
        "KHR_texture_transform", "KHR_lights_punctual",     "KHR_texture_basisu",      "EXT_texture_webp",
        "EXT_texture_avif",      "MSFT_texture_dds",        "KHR_node_visibility"};
    return extension.starts_with("KHR_materials_") ||
           std::find(std::begin(kKnown), std::end(kKnown), extension) != std::end(kKnown);
}

// Warns of extensions that would change the picture, and are not drawn.
void warn_of_ignored_extensions(const JsonView& root, Warnings& warnings) {
    constexpr std::string_view kSeen[] = {"anisotropy",  "clearcoat", "diffuse_transmission", "dispersion",
                                          "iridescence", "sheen",     "transmission",         "unlit",
                                          "variants",    "volume"};
    std::string ignored;
    for (const JsonView extension : root.optional_array("extensionsUsed")) {
        const std::string_view name = extension.as_string();
        if (name == "EXT_mesh_gpu_instancing")
            warnings.add(extension.place(), name, " is not supported: each node shows its mesh only once");
        constexpr std::string_view kOfMaterials = "KHR_materials_";
        if (!name.starts_with(kOfMaterials)) continue;
        if (std::ranges::find(kSeen, name.substr(kOfMaterials.size())) != std::end(kSeen))
            ignored += joined(ignored.empty() ? "" : ", ", name);
    }
    if (!ignored.empty()) warnings.add("extensionsUsed", ignored, ": not supported; materials are drawn without them");
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

// The memory that the text will take once parsed: nlohmann's values are 16 bytes, and each member of an object has its
// key beside it. By measurement, the result is never below the real size and at most twice as large.
uint64_t parsed_bytes(std::string_view text, const Budget& budget) {
    uint64_t size_bytes = text.size();
    bool in_string = false;
    for (size_t i = 0; i < text.size(); ++i) {
        budget.poll_at(i);
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

Asset read_parts(std::span<const std::byte> bytes, const SideFiles& side_files, Warnings& warnings,
                 const Progress& progress) {
    Budget budget(bytes.size(), progress);
    const Container container = open_container(bytes, warnings);
    const JsonText json = parse_json(container.json, budget, progress.between(0, kParsed));
    const JsonView root = json.view();
    root.as_object();
    check_version(root);
    const bool quantized = check_extensions(root);
    warn_of_ignored_extensions(root, warnings);
    Buffers buffers(root, container, side_files, budget);
    Accessors accessors(root, buffers, budget, warnings);
    Reading reading{root, buffers, accessors, budget, warnings, quantized};

    Asset asset;
    read_nodes(reading, asset);
    read_skins(reading, asset);
    reading.progress = progress.between(kParsed, kClipsRead);
    read_clips(reading, asset);
    buffers.free_decompressed();  // keys and meshes are hardly ever in one view
    reading.progress = progress.between(kClipsRead, kMaterialsRead);
    const std::vector<TextureCoordinates> coordinates = read_materials(reading, asset);
    reading.progress = progress.between(kMaterialsRead, 1);
    const std::vector<NeededJoints> needed_joints = read_meshes(reading, coordinates, asset);
    read_mesh_instances(reading, needed_joints, asset);
    return asset;
}

// Runs `body`; puts the file's name in front of a Failure's place.
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
    reading.warnings.add(name->place(), "is not a string: it is ignored");
    return {};
}

JsonText parse_json(std::string_view text, Budget& budget, const Progress& progress) {
    if (text.size() > kJsonLimitBytes)
        throw Failure(ErrorCode::kLimit, "", "the JSON is larger than the limit of 256 MiB");
    // Some exporters pad the JSON chunk of a GLB with zeros in place of spaces.
    text = text.substr(0, text.find_last_not_of('\0') + 1);
    budget.charge(parsed_bytes(text, budget), "");
    return JsonText(text, JsonAuthor::kProgram, {}, progress);
}

Asset read_asset(std::span<const std::byte> bytes, std::string_view name, const SideFiles& side_files,
                 const Progress& progress) {
    const std::string place = message_name(name);
    return in_file(place, [&] {
        progress.report(0);
        Warnings warnings(place);
        Asset asset = read_parts(bytes, side_files, warnings, progress);
        asset.name = printable(name, std::string::npos);
        asset.warnings = warnings.take();
        progress.report(1);
        return asset;
    });
}

Result<Asset> load_asset(const std::filesystem::path& path, const Progress& progress) {
    const std::string name = path.has_filename() ? path.filename().string() : path.string();
    const std::string place = message_name(name);
    return as_result(
        [&] {
            const std::vector<std::byte> bytes = read_file(path, kFileLimitBytes, place, kLargerThanFiles,
                                                           progress.between(0, kFileRead));
            return read_asset(bytes, name, path.parent_path(), progress.between(kFileRead, 1));
        },
        place);
}

}  // namespace throng::gltf

namespace throng {

Result<Asset> load_asset(const std::filesystem::path& path, const LoadHooks& hooks) {
    return gltf::load_asset(path, Progress(hooks));
}

Result<Asset> load_asset(std::span<const std::byte> bytes, std::string_view name, const AssetResolver& resolver,
                         const LoadHooks& hooks) {
    const std::string place = message_name(name);
    return as_result(
        [&] {
            if (bytes.size() > gltf::kFileLimitBytes) throw Failure(ErrorCode::kLimit, place, kLargerThanFiles);
            return gltf::read_asset(bytes, name, resolver, Progress(hooks));
        },
        place);
}

}  // namespace throng
