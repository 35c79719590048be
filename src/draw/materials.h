// The materials of one group of a crowd, ready to bind.
#pragma once

#include "draw/textured_materials.h"
#include "draw/textures.h"

#include <array>
#include <vector>

namespace throng {

// The samplers that read the textures of materials.
class MaterialSampling {
public:
    explicit MaterialSampling(const std::shared_ptr<Gpu>& gpu);

    VkSampler sampler_of(const AssetMaterial& material) const;

private:
    static constexpr size_t kFilters = 2, kWraps = 3;
    std::array<std::array<std::array<OwnedSampler, kWraps>, kWraps>, kFilters> samplers_;  // [filter][wrap u][wrap v]
};

class GroupMaterials {
public:
    // Decodes only images of materials that some outfit shows. One that cannot be decoded, or for which there is no
    // room, is white, with a warning; as a normal map it leaves normals as they are. Draw with them only when the
    // uploads have finished.
    GroupMaterials(Uploads& uploads, const Group& group, const ShaderLayout::Set& set, const MaterialSampling& sampling,
                   TextureAccount& account);

    // By io::SectionLook::material
    const TexturedMaterial<Image>& operator[](uint32_t material) const { return materials_.all()[material]; }
    VkDescriptorSet textures_of(uint32_t material) const { return bindings_[material].set(); }

private:
    TexturedMaterials<Image> materials_;
    std::shared_ptr<const Image> white_;  // what is read where a material has no texture
    std::vector<Bindings> bindings_;      // of each material's textures
};

}  // namespace throng
