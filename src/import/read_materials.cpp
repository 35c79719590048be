#include "base/count.h"
#include "import/readers.h"
#include "import/uri.h"

#include <algorithm>
#include <map>

namespace throng::gltf {
namespace {

constexpr double kBrightest = 65504;  // of what shines by itself: the largest half float

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
        const uint32_t source = texture.optional_index("source", images_.size(), "images");
        if (source == kNone) {
            reading_.warnings.add(texture.place(), "has no PNG or JPEG image: the texture is left out");
            return kNone;
        }
        const auto [known, is_new] = image_of_.emplace(source, count_of(asset_.images));
        if (is_new) asset_.images.push_back(read(images_[source]));
        return known->second;
    }

private:
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
            // A character without its texture is still a character.
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

// The textures of one material, which all use the same set of texture coordinates: that of the first that has an image.
class Textures {
public:
    Textures(Reading& reading, Images& images) : reading_(reading), images_(images) {}

    // The image of the texture at `key`, or kNone.
    uint32_t read(const JsonView& json, const char* key) {
        const auto info = json.optional_object(key);
        if (!info) return kNone;
        uint64_t set = info->optional_uint("texCoord", 0);
        if (const auto transform = info->extension("KHR_texture_transform")) {
            set = transform->optional_uint("texCoord", set);
            reading_.warnings.add(info->place(), "KHR_texture_transform is ignored");
        }
        const auto bounded_set = uint32_t(std::min<uint64_t>(set, kNone));
        if (set_.value_or(bounded_set) != bounded_set) {
            reading_.warnings.add(info->place(),
                                  "uses other texture coordinates than the material's first texture: it is left out");
            return kNone;
        }
        const uint32_t image = images_.of_texture(*info);
        if (image != kNone) set_ = bounded_set;
        return image;
    }
    uint32_t set() const { return set_.value_or(0); }

private:
    Reading& reading_;
    Images& images_;
    std::optional<uint32_t> set_;
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

std::vector<uint32_t> read_materials(Reading& reading, Asset& asset) {
    const JsonView materials = reading.charged_array("materials", sizeof(AssetMaterial) + sizeof(AssetImage));
    asset.materials.resize(materials.size());
    std::vector<uint32_t> texcoord_sets(materials.size(), 0);
    Images images(reading, asset);
    for (size_t i = 0; i < materials.size(); ++i) {
        reading.progress.report(i, materials.size());
        const JsonView json = materials[i].as_object();
        AssetMaterial& material = asset.materials[i];
        material.name = read_name(reading, json);
        material.alpha_mode = read_alpha_mode(reading, json);
        material.alpha_cutoff = json.optional_float("alphaCutoff", 0.5);
        material.double_sided = json.optional_bool("doubleSided", false);
        Textures textures(reading, images);
        if (const auto pbr = json.optional_object("pbrMetallicRoughness"))
            read_metallic_roughness(*pbr, textures, material);
        read_surface(json, textures, material);
        texcoord_sets[i] = textures.set();
    }
    return texcoord_sets;
}

}  // namespace throng::gltf
