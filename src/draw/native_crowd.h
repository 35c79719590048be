// What the native renderer keeps of a crowd: meshes and materials of its groups.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/draw_io.h"
#include "draw/native_mesh.h"
#include "draw/textured_materials.h"
#include "draw/textures.h"
#include "raster/texture.h"

#include <deque>
#include <string>

namespace throng {

class NativeGroup {
public:
    NativeGroup(const CrowdState& crowd, const Group& group, TextureAccount& account);
    NativeGroup(const NativeGroup&) = delete;

    const NativeMesh& mesh() const { return mesh_; }
    // By io::SectionLook::material
    const raster::Material& material(uint32_t index) const { return materials_[index]; }
    const std::vector<io::JointLevel>& joint_levels() const { return joint_levels_; }

private:
    std::vector<io::JointLevel> joint_levels_;
    TexturedMaterials<raster::OwnedTexture> textured_;
    std::vector<raster::Material> materials_;  // as those
    NativeMesh mesh_;
};

struct NativeCrowd {
    explicit NativeCrowd(const CrowdState& crowd);

    std::deque<NativeGroup> groups;
    std::vector<std::string> warnings;
};

}  // namespace throng
