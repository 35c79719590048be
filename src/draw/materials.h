// The materials of one group of a crowd, ready to bind.
#pragma once

#include "draw/textured_materials.h"
#include "draw/textures.h"

#include <vector>

namespace throng {

// How the textures of all materials are read, and what is read where there is none.
struct MaterialSampling {
    explicit MaterialSampling(const std::shared_ptr<Gpu>& gpu);  // submits and waits

    OwnedSampler sampler;
    Image white;
};

class GroupMaterials {
public:
    // Only images that a section's material uses are decoded; one that cannot be, or is too much, is white, with a
    // warning, and leaves normals as they are. To be drawn with when the uploads have finished.
    GroupMaterials(Uploads& uploads, const Group& group, const ShaderLayout::Set& set, const MaterialSampling& sampling,
                   TextureAccount& account);

    const TexturedMaterial<Image>& of(const MeshSection& section) const {
        return materials_.all()[materials_.index_of(section)];
    }
    VkDescriptorSet textures_of(const MeshSection& section) const {
        return bindings_[materials_.index_of(section)].set();
    }

private:
    TexturedMaterials<Image> materials_;
    std::vector<Bindings> bindings_;  // of each material's textures
};

}  // namespace throng
