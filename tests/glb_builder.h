// Tiny glTF files, valid and broken, made in memory: no test needs a download.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace throng::test {

using GltfJson = nlohmann::json;

// glTF component types.
enum : int { kInt8 = 5120, kUint8, kInt16, kUint16, kUint32 = 5125, kFloat = 5126 };

// The JSON and the binary buffer of one file. The JSON is public, so that tests can break anything in it.
class GlbBuilder {
public:
    GlbBuilder();

    // Appends to buffer 0, at a multiple of 4; returns the index of the new buffer view.
    size_t add_view(std::span<const std::byte> bytes);
    // A buffer view and an accessor for it; returns the accessor's index. `type` is "SCALAR", "VEC3", …
    template <class T>
    size_t add(const std::vector<T>& values, const char* type, int component_type) {
        return add_accessor(add_view(std::as_bytes(std::span(values))), values.size(), type, component_type);
    }
    // An accessor of `component_count` components in all over an existing view.
    size_t add_accessor(size_t view, size_t component_count, const char* type, int component_type);

    std::string glb() const;   // binary
    std::string gltf() const;  // JSON with a data: URI

    GltfJson json;
    std::vector<std::byte> bin;
};

// A valid character: nodes 0 (the mesh's), 1 and its child 2 (the joints); one triangle, skinned to both joints; one
// clip, 1 s long, that turns node 2 by 90° about z. The accessors are, in this order: POSITION, JOINTS_0, WEIGHTS_0,
// indices, inverse bind matrices, key times, rotations, NORMAL.
GlbBuilder tiny_character();
enum : size_t { kPosition, kVertexJoints, kWeights, kIndices, kInverseBinds, kTimes, kRotations, kNormals };

std::string base64(std::span<const std::byte> bytes);

}  // namespace throng::test
