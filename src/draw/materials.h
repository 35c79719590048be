// The materials of one group of a crowd, ready to bind.
#pragma once

#include "crowd/group.h"
#include "draw/textures.h"

#include <map>
#include <vector>

namespace throng {

struct DrawMaterial {
    AssetMaterial factors;
    // Below it a fragment is left out. A blended material is drawn as one with a mask at 0.5: characters are not
    // sorted.
    float alpha_cutoff = 0;
    bool masked = false;
    bool has_maps = false;  // more textures than that of the base colour
    Bindings textures;
};

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

    const DrawMaterial& of(const MeshSection& section) const {
        return section.material < materials_.size() - 1 ? materials_[section.material] : materials_.back();
    }

private:
    std::map<std::pair<uint32_t, VkFormat>, std::optional<Image>> textures_;  // by image; none: drawn white
    std::vector<DrawMaterial> materials_;  // the group's, then the one of sections without
};

}  // namespace throng
