// The materials of one group of a crowd, with textures of the kind that a renderer has.
#pragma once

#include "crowd/group.h"

#include <array>
#include <map>
#include <memory>
#include <vector>

namespace throng {

struct MaterialTexture {
    uint32_t AssetMaterial::*image;
    bool is_color;  // sRGB; else numbers
};
// Indexed by binding.
inline constexpr std::array<MaterialTexture, 5> kMaterialTextures{{{&AssetMaterial::image, true},
                                                                   {&AssetMaterial::metallic_roughness_image, false},
                                                                   {&AssetMaterial::normal_image, false},
                                                                   {&AssetMaterial::occlusion_image, false},
                                                                   {&AssetMaterial::emissive_image, true}}};

template <class Texture>
struct TexturedMaterial {
    AssetMaterial factors;                                            // normal_image is kNone if it cannot be drawn
    bool has_maps = false;                                            // has other textures than the base colour's
    std::array<const Texture*, kMaterialTextures.size()> textures{};  // null: white
};

template <class Texture>
class TexturedMaterials {
public:
    // make(image, is_color) is called once for each image of a material that some outfit shows, and returns a shared
    // pointer. An image for which it returns null is drawn white; as a normal map it leaves normals as they are.
    template <class Make>
    TexturedMaterials(const Group& group, const Make& make) {
        std::vector<bool> used(group.materials.size());
        for (size_t section = 0; section < group.sections.size(); ++section)
            for (const uint32_t material : group.section_materials[section])
                if (material < used.size() && group.sections[section].index_count > 0) used[material] = true;
        const auto texture = [&](uint32_t image, bool is_color) -> const Texture* {
            if (image >= group.images.size()) return nullptr;
            const std::pair key(image, is_color);
            auto found = textures_.find(key);
            if (found == textures_.end()) found = textures_.emplace(key, make(*group.images[image], is_color)).first;
            return found->second.get();
        };
        for (size_t i = 0; i <= group.materials.size(); ++i) {
            const bool is_default = i == group.materials.size();
            TexturedMaterial<Texture>& material = all_.emplace_back();
            if (!is_default) material.factors = group.materials[i];
            for (size_t t = 0; t < kMaterialTextures.size(); ++t) {
                const auto [member, is_color] = kMaterialTextures[t];
                uint32_t& image = material.factors.*member;
                material.textures[t] = texture(!is_default && used[i] ? image : kNone, is_color);
                if (member == &AssetMaterial::normal_image && !material.textures[t])
                    image = kNone;  // white would tilt normals
                material.has_maps = material.has_maps || (t > 0 && image != kNone);
            }
        }
    }

    // As io::SectionLook numbers them: the group's materials, then the one for sections without a material.
    const std::vector<TexturedMaterial<Texture>>& all() const { return all_; }

private:
    std::map<std::pair<uint32_t, bool>, std::shared_ptr<const Texture>> textures_;  // by image and is_color
    std::vector<TexturedMaterial<Texture>> all_;
};

}  // namespace throng
