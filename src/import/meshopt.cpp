#include "import/meshopt.h"

#include "import/meshopt_attributes.h"
#include "import/meshopt_color.h"

#include <meshoptimizer.h>

namespace throng::gltf {
namespace {

enum class Codec : uint8_t { kAttributes0, kAttributes1, kTriangles, kIndices };

// The least that `count` elements can be compressed to.
uint64_t least_bytes(Codec codec, uint64_t count, uint64_t stride_bytes) {
    switch (codec) {
        case Codec::kAttributes0: return count * stride_bytes / 64;  // two bits for 16 equal bytes
        case Codec::kAttributes1: return least_attributes_bytes(count, stride_bytes);
        case Codec::kTriangles: return count / 3;  // a byte for each
        case Codec::kIndices: break;
    }
    return count;
}

int decode_by_meshoptimizer(Codec codec, std::span<const std::byte> compressed, size_t count, size_t stride_bytes,
                            std::byte* out) {
    const auto* data = reinterpret_cast<const unsigned char*>(compressed.data());
    if (codec == Codec::kTriangles) return meshopt_decodeIndexBuffer(out, count, stride_bytes, data, compressed.size());
    if (codec == Codec::kIndices) return meshopt_decodeIndexSequence(out, count, stride_bytes, data, compressed.size());
    return meshopt_decodeVertexBuffer(out, count, stride_bytes, data, compressed.size());
}

}  // namespace

std::shared_ptr<const std::vector<std::byte>> decode_meshopt(const JsonView& json,
                                                             std::span<const std::byte> compressed, Budget& budget) {
    const std::string& mode = json.required_string("mode");
    const std::string* named_filter = json.optional_string("filter");
    const std::string filter = named_filter ? *named_filter : "NONE";
    const uint64_t count = json.required_uint("count"), stride_bytes = json.required_uint("byteStride");

    // meshoptimizer asserts its preconditions, so all of them are checked before.
    const bool attributes = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
    if (!attributes && !triangles && mode != "INDICES") json.fail("mode '", printable(mode), "' is unknown");
    if (attributes ? stride_bytes == 0 || stride_bytes % 4 != 0 || stride_bytes > 256
                   : stride_bytes != 2 && stride_bytes != 4)
        json.fail("byteStride ", stride_bytes, " is not allowed in mode ", mode);
    if (triangles && count % 3 != 0) json.fail("count ", count, " is not a multiple of 3");
    const bool octahedral = filter == "OCTAHEDRAL", quaternion = filter == "QUATERNION",
               exponential = filter == "EXPONENTIAL", color = filter == "COLOR";
    if (!octahedral && !quaternion && !exponential && !color && filter != "NONE")
        json.fail("filter '", printable(filter), "' is unknown");
    if (!attributes && filter != "NONE") json.fail("filter ", filter, " is not allowed in mode ", mode);
    if (((octahedral || color) && stride_bytes != 4 && stride_bytes != 8) || (quaternion && stride_bytes != 8))
        json.fail("byteStride ", stride_bytes, " is not allowed with filter ", filter);

    const bool version_1 = !compressed.empty() && compressed[0] == kAttributesVersion1;
    const Codec codec = triangles     ? Codec::kTriangles
                        : !attributes ? Codec::kIndices
                        : version_1   ? Codec::kAttributes1
                                      : Codec::kAttributes0;
    // A few bytes that claim gigabytes are refused before memory is allocated for them.
    if (least_bytes(codec, count, stride_bytes) > compressed.size())
        json.fail(compressed.size(), " bytes are too few for a count of ", count);
    const auto decoded = charged_bytes(budget, count, stride_bytes, json.place());
    if (count == 0) return decoded;
    std::byte* const out = decoded->data();
    if (codec == Codec::kAttributes1)
        decode_attributes(json, compressed, stride_bytes, *decoded, budget.progress());
    else if (const int failed = decode_by_meshoptimizer(codec, compressed, count, stride_bytes, out))
        json.fail("the compressed data are broken (meshoptimizer error ", failed, ")");
    if (octahedral) meshopt_decodeFilterOct(out, count, stride_bytes);
    if (quaternion) meshopt_decodeFilterQuat(out, count, stride_bytes);
    if (exponential) meshopt_decodeFilterExp(out, count, stride_bytes);
    if (color) decode_colors(json, *decoded, stride_bytes);
    return decoded;
}

}  // namespace throng::gltf
