// What the native renderer keeps of a group of a crowd: its mesh and materials.
#pragma once

#include "crowd/crowd_state.h"
#include "draw/draw_io.h"
#include "draw/native_mesh.h"
#include "draw/textured_materials.h"
#include "draw/textures.h"
#include "raster/texture.h"

#include <string>
#include <vector>

namespace throng {

// Textures are shared by all native renderers of the device. Subtracts their size from `room_bytes`, counted as the
// Vulkan renderer counts it, so that both draw the same images white.
TexturedMaterials<raster::OwnedTexture> native_materials(Gpu& gpu, const Group& group,
                                                         std::vector<std::string>& warnings, uint64_t& room_bytes);

class NativeGroup {
public:
    NativeGroup(const CrowdState& crowd, const Group& group, uint64_t& room_bytes);
    NativeGroup(const NativeGroup&) = delete;

    const NativeMesh& mesh() const { return mesh_; }
    // By io::SectionLook::material
    const raster::Material& material(uint32_t index) const { return materials_[index]; }
    const std::vector<io::JointLevel>& joint_levels() const { return joint_levels_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    std::vector<std::string> warnings_;
    std::vector<io::JointLevel> joint_levels_;
    TexturedMaterials<raster::OwnedTexture> textured_;
    std::vector<raster::Material> materials_;  // in the same order
    NativeMesh mesh_;
};

}  // namespace throng
