// The triangles of a primitive.
#pragma once

#include "import/draco.h"
#include "import/readers.h"

namespace throng::gltf {

// The member `mode`: those from kTriangles on draw triangles.
enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan, kModeCount };

// Three indices per triangle, each below `vertex_count`. `draco` is null where the primitive is not compressed.
std::vector<uint32_t> read_triangles(Reading& reading, const JsonView& primitive, Mode mode, const DracoMesh* draco,
                                     uint32_t vertex_count);

}  // namespace throng::gltf
