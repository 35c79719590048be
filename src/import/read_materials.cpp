#include "base/count.h"
#include "import/readers.h"
#include "import/uri.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace throng::gltf {
namespace {

constexpr double kMaxOfTransform = 1e6;  // beyond which floats have hardly any fractions
constexpr double kBrightest = 65504;     // of emissive colours: the largest half float

// Reads each image once, at its first use.
class Images {
public:
    Images(Reading& reading, Asset& asset)
        : reading_(reading),
          asset_(asset),
          textures_(reading.root.optional_array("textures")),
          images_(reading.root.optional_array("images")) {}

    // The image of a texture, as an index into the Asset's images, or kNone.
    uint32_t of_texture(const JsonView& texture_info) {
        const JsonView texture =
            textures_[texture_info.required_index("index", textures_.size(), "textures")].as_object();
        uint32_t source = texture.optional_index("source", images_.size(), "images");
        if (const auto webp = texture.extension("EXT_texture_webp"))
            if (const uint32_t own = webp->optional_index("source", images_.size(), "images"); own != kNone)
                source = own;
        if (source == kNone) {
            warn_of_format(texture);
            return kNone;
        }
        const auto [known, is_new] = image_of_.emplace(source, count_of(asset_.images));
        if (is_new) asset_.images.push_back(read(images_[source]));
        return known->second;
    }

    // Only warns if the sampler is wrong: the character is usable without it.
    void read_sampler(const JsonView& texture_info, AssetMaterial& material) {
        try {
            read_sampler_of(texture_info, material);
        } catch (const Failure& failure) {
            if (failure.error.code != ErrorCode::kInvalidFile) throw;
            reading_.warnings.add(failure.error.place, failure.error.message, ": the sampler is not used");
        }
    }

private:
    void read_sampler_of(const JsonView& texture_info, AssetMaterial& material) {
        const JsonView texture =
            textures_[texture_info.required_index("index", textures_.size(), "textures")].as_object();
        if (!texture.has("sampler")) return;
        const JsonView samplers = reading_.root.optional_array("samplers");
        const JsonView sampler = samplers[texture.required_index("sampler", samplers.size(), "samplers")].as_object();
        constexpr uint64_t kNearest = 9728;
        const TextureWrap wrap_u = wrap_of(sampler, "wrapS"), wrap_v = wrap_of(sampler, "wrapT");
        if (sampler.optional_uint("magFilter", 0) == kNearest) material.filter = TextureFilter::kNearest;
        material.wrap_u = wrap_u;
        material.wrap_v = wrap_v;
    }

    static TextureWrap wrap_of(const JsonView& sampler, const char* key) {
        constexpr uint64_t kClamp = 33071, kMirror = 33648, kRepeat = 10497;
        const uint64_t wrap = sampler.optional_uint(key, kRepeat);
        return wrap == kClamp ? TextureWrap::kClamp : wrap == kMirror ? TextureWrap::kMirror : TextureWrap::kRepeat;
    }

    // Warns about the format of the image that another extension has in place of `source`.
    void warn_of_format(const JsonView& texture) {
        constexpr std::pair<const char*, const char*> kFormats[] = {{"KHR_texture_basisu", "a KTX2 image"},
                                                                    {"EXT_texture_avif", "an AVIF image"},
                                                                    {"MSFT_texture_dds", "a DDS image"}};
        for (const auto& [extension, format] : kFormats)
            if (texture.extension(extension))
                return reading_.warnings.add(
                    texture.place(), "is ", format, " (", extension,
                    "), which is not read: the texture is left out. Convert it to PNG, JPEG or WebP");
        reading_.warnings.add(texture.place(), "has no image: the texture is left out");
    }

    AssetImage read(const JsonView& json) {
        AssetImage image;
        image.name = read_name(reading_, json);
        if (json.has("bufferView")) {
            const auto bytes = reading_.buffers.view_of(json).bytes;
            reading_.budget.charge(bytes.size(), json.place());
            image.encoded.assign(bytes.begin(), bytes.end());
            return image;
        }
        const std::string* uri = json.optional_string("uri");
        if (!uri) {
            reading_.warnings.add(json.place(), "has neither uri nor bufferView: the texture is left out");
            return image;
        }
        const std::string place = json.place_of("uri");
        try {
            if (is_data_uri(*uri)) {
                image.encoded = decode_data_uri(*uri, reading_.budget, place);
            } else {
                const auto content = reading_.buffers.side_file(*uri, place);
                reading_.budget.charge(content->size(), place);
                image.encoded = *content;
            }
        } catch (const Failure& failure) {
            // A character is usable without its texture.
            if (failure.error.code != ErrorCode::kFile && failure.error.code != ErrorCode::kInvalidFile) throw;
            reading_.warnings.add(failure.error.place, failure.error.message, ": the texture is left out");
        }
        return image;
    }

    Reading& reading_;
    Asset& asset_;
    JsonView textures_;
    JsonView images_;
    std::map<uint32_t, uint32_t> image_of_;
};

AlphaMode read_alpha_mode(Reading& reading, const JsonView& json) {
    const std::string* mode = json.optional_string("alphaMode");
    if (!mode || *mode == "OPAQUE") return AlphaMode::kOpaque;
    if (*mode == "MASK") return AlphaMode::kMask;
    if (*mode == "BLEND") return AlphaMode::kBlend;
    reading.warnings.add(json.place_of("alphaMode"), "'", printable(*mode), "' is unknown: OPAQUE is used");
    return AlphaMode::kOpaque;
}

// The textures of one material, which all use the same texture coordinates and sampler: those of the first that has an
// image.
class Textures {
public:
    Textures(Reading& reading, Images& images, AssetMaterial& material)
        : reading_(reading), images_(images), material_(material) {}

    // The image of the texture at `key`, or kNone.
    uint32_t read(const JsonView& json, const char* key) {
        const auto info = json.optional_object(key);
        if (!info) return kNone;
        const TextureCoordinates coordinates = coordinates_of(*info);
        if (coordinates_.value_or(coordinates) != coordinates) {
            reading_.warnings.add(info->place(),
                                  "uses other texture coordinates than the material's first texture: it is left out");
            return kNone;
        }
        const uint32_t image = images_.of_texture(*info);
        if (image != kNone && !coordinates_) {
            coordinates_ = coordinates;
            images_.read_sampler(*info, material_);
        }
        return image;
    }
    TextureCoordinates coordinates() const { return coordinates_.value_or(TextureCoordinates()); }

private:
    static TextureCoordinates coordinates_of(const JsonView& info) {
        TextureCoordinates coordinates;
        uint64_t set = info.optional_uint("texCoord", 0);
        if (const auto transform = info.extension("KHR_texture_transform")) {
            set = transform->optional_uint("texCoord", set);
            std::array<double, 2> offset{0, 0}, scale{1, 1};
            transform->optional_numbers("offset", offset);
            transform->optional_numbers("scale", scale);
            for (std::array<double, 2>* const numbers : {&offset, &scale})
                for (double& number : *numbers) number = std::clamp(number, -kMaxOfTransform, kMaxOfTransform);
            // Counter-clockwise in the picture, whose v points down.
            const double turn_rad = transform->optional_number("rotation", 0);
            const double cosine = std::cos(turn_rad), sine = std::sin(turn_rad);
            coordinates.transform = {
                {{cosine * scale[0], sine * scale[1], offset[0]}, {-sine * scale[0], cosine * scale[1], offset[1]}}};
        }
        coordinates.set = uint32_t(std::min<uint64_t>(set, kNone));
        return coordinates;
    }

    Reading& reading_;
    Images& images_;
    AssetMaterial& material_;
    std::optional<TextureCoordinates> coordinates_;
};

void read_metallic_roughness(const JsonView& pbr, Textures& textures, AssetMaterial& material) {
    std::array<double, 4> color{};
    if (pbr.optional_numbers("baseColorFactor", color))
        for (size_t c = 0; c < 4; ++c) material.base_color[c] = float(color[c]);
    material.metallic = pbr.optional_float("metallicFactor", 1);
    material.roughness = pbr.optional_float("roughnessFactor", 1);
    material.image = textures.read(pbr, "baseColorTexture");
    material.metallic_roughness_image = textures.read(pbr, "metallicRoughnessTexture");
}

// KHR_materials_pbrSpecularGlossiness, for materials that have nothing else: its diffuse colours and glossiness,
// without its specular colours.
void read_specular_glossiness(const JsonView& json, Textures& textures, AssetMaterial& material) {
    std::array<double, 4> color{};
    if (json.optional_numbers("diffuseFactor", color))
        for (size_t c = 0; c < 4; ++c) material.base_color[c] = float(color[c]);
    material.metallic = 0;
    material.roughness = 1 - json.optional_float("glossinessFactor", 1);
    material.image = textures.read(json, "diffuseTexture");
}

void read_surface(const JsonView& json, Textures& textures, AssetMaterial& material) {
    material.normal_image = textures.read(json, "normalTexture");
    if (material.normal_image != kNone)
        material.normal_scale = json.required_object("normalTexture").optional_float("scale", 1);
    material.occlusion_image = textures.read(json, "occlusionTexture");
    if (material.occlusion_image != kNone)
        material.occlusion_strength = json.required_object("occlusionTexture").optional_float("strength", 1);
    std::array<double, 3> emissive{};
    json.optional_numbers("emissiveFactor", emissive);
    const auto extension = json.extension("KHR_materials_emissive_strength");
    const double strength = extension ? extension->optional_number("emissiveStrength", 1) : 1;
    for (size_t c = 0; c < 3; ++c) material.emissive[c] = float(std::clamp(emissive[c] * strength, 0.0, kBrightest));
    material.emissive_image = textures.read(json, "emissiveTexture");
}

}  // namespace

std::vector<TextureCoordinates> read_materials(Reading& reading, Asset& asset) {
    const JsonView materials = reading.charged_array("materials", sizeof(AssetMaterial) + sizeof(AssetImage));
    asset.materials.resize(materials.size());
    std::vector<TextureCoordinates> coordinates(materials.size());
    Images images(reading, asset);
    for (size_t i = 0; i < materials.size(); ++i) {
        reading.progress.report(i, materials.size());
        const JsonView json = materials[i].as_object();
        AssetMaterial& material = asset.materials[i];
        material.name = read_name(reading, json);
        material.alpha_mode = read_alpha_mode(reading, json);
        material.alpha_cutoff = json.optional_float("alphaCutoff", 0.5);
        material.double_sided = json.optional_bool("doubleSided", false);
        Textures textures(reading, images, material);
        if (const auto pbr = json.optional_object("pbrMetallicRoughness"))
            read_metallic_roughness(*pbr, textures, material);
        else if (const auto older = json.extension("KHR_materials_pbrSpecularGlossiness"))
            read_specular_glossiness(*older, textures, material);
        read_surface(json, textures, material);
        coordinates[i] = textures.coordinates();
    }
    return coordinates;
}

}  // namespace throng::gltf
