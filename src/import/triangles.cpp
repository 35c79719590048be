#include "import/triangles.h"

#include <numeric>

namespace throng::gltf {
namespace {

std::vector<uint32_t> file_indices(Reading& reading, const JsonView& primitive, uint32_t vertex_count) {
    std::vector<uint32_t> out;
    if (!primitive.has("indices")) {
        reading.budget.charge(vertex_count, sizeof(uint32_t), primitive.place());
        out.resize(vertex_count);
        std::iota(out.begin(), out.end(), 0u);
        return out;
    }
    const AccessorView view = reading.accessors.open(primitive, "indices", Missing::kAreLeftOut);
    if (view.format.type != "SCALAR" || !view.format.is_unsigned())
        primitive.fail_at("indices", "must be SCALAR of unsigned integers, but is ", view.format.text());
    reading.budget.charge(view.count(), sizeof(uint32_t), primitive.place_of("indices"));
    const uint32_t restart = uint32_t((uint64_t(1) << 8 * size_of(view.format.component_type)) - 1);
    out.resize(view.count());
    for (uint32_t i = 0; i < out.size(); ++i) {
        reading.budget.poll_at(i);
        out[i] = view.integer(i, 0);
        if (out[i] == restart)
            primitive.fail_at("indices", "index ", restart, " is the primitive restart value, which glTF forbids");
    }
    return out;
}

// Strips and fans as glTF 2.0, 3.7.2.1 winds them.
std::vector<uint32_t> triangle_list(Reading& reading, const JsonView& primitive, const std::vector<uint32_t>& in,
                                    Mode mode) {
    std::vector<uint32_t> out;
    if (in.size() < 3) return in;
    reading.budget.charge(in.size() * 3, sizeof(uint32_t), primitive.place());
    out.reserve((in.size() - 2) * 3);
    for (size_t i = 0; i + 2 < in.size(); ++i) {
        if (mode == kTriangleFan)
            out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
        else
            out.insert(out.end(), {in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]});
    }
    return out;
}

}  // namespace

std::vector<uint32_t> read_triangles(Reading& reading, const JsonView& primitive, Mode mode, const DracoMesh* draco,
                                     uint32_t vertex_count) {
    std::vector<uint32_t> indices = draco ? draco->indices() : file_indices(reading, primitive, vertex_count);
    for (const uint32_t index : indices)
        if (index >= vertex_count)
            primitive.fail_at("indices", "index ", index, ", but there are ", vertex_count, " vertices");
    if (!draco && mode != kTriangles) indices = triangle_list(reading, primitive, indices, mode);
    if (indices.size() % 3 != 0) {
        reading.warnings.add(primitive.place(), "its last triangle is incomplete: it is dropped");
        indices.resize(indices.size() / 3 * 3);
    }
    return indices;
}

}  // namespace throng::gltf
