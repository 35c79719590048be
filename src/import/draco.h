// KHR_draco_mesh_compression.
// Source: "KHR_draco_mesh_compression", Khronos glTF extension, and the Draco bitstream 2.2, decoded by libdraco.
#pragma once

#include "import/accessor.h"

#include <memory>

namespace draco {
class Mesh;
}

namespace throng::gltf {

// The geometry of one compressed primitive.
class DracoMesh {
public:
    // Decompresses `json`, the extension object of a primitive. Fails with kInvalidFile, or kLimit. The memory is
    // charged for as long as this object exists.
    DracoMesh(const JsonView& json, Buffers& buffers, Budget& budget);
    ~DracoMesh();

    // The primitive's attribute `name`, in its accessor's format; no value where it is not among the compressed ones.
    std::optional<AccessorView> attribute(std::string_view name, const AccessorFormat& format) const;
    // Three per triangle, not yet checked against the vertices. Charged for the whole import.
    std::vector<uint32_t> indices() const;

private:
    JsonView json_;
    Budget& budget_;
    TemporaryCharge charge_;
    std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace throng::gltf
