// Stubs for libraries that are not available for ARM: files compressed with them are refused, and meshes keep all their
// triangles.
#include "base/failure.h"
#include "import/draco.h"
#include "import/meshopt.h"

#include <meshoptimizer.h>

namespace draco {
class Mesh {};
}  // namespace draco

namespace throng::gltf {

DracoMesh::DracoMesh(const JsonView& json, Buffers&, Budget& budget) : json_(json), budget_(budget), charge_(budget) {
    json_.fail("without Draco");
}
DracoMesh::~DracoMesh() = default;
std::optional<AccessorView> DracoMesh::attribute(std::string_view, const AccessorFormat&) const { return {}; }
std::vector<uint32_t> DracoMesh::indices() const { return {}; }

std::shared_ptr<const std::vector<std::byte>> decode_meshopt(const JsonView& json, std::span<const std::byte>,
                                                             Budget&) {
    json.fail("without meshoptimizer");
}

}  // namespace throng::gltf

size_t meshopt_simplify(unsigned*, const unsigned*, size_t, const float*, size_t, size_t, size_t, float, unsigned,
                        float*) {
    return 0;
}
size_t meshopt_simplifySloppy(unsigned*, const unsigned*, size_t, const float*, size_t, size_t, size_t, float, float*) {
    return 0;
}
