#include "import/meshopt.h"

#include "base/failure.h"

#include <meshoptimizer.h>

namespace throng::gltf {

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
    constexpr std::byte kAttributesVersion1{0xA1};
    if (attributes && !compressed.empty() && compressed[0] == kAttributesVersion1)
        throw Failure(
            ErrorCode::kUnsupported, json.place(),
            "the attributes are compressed with version 1 of their codec, but only version 0 is supported: compress "
            "them with EXT_meshopt_compression");
    if (filter == "COLOR") throw Failure(ErrorCode::kUnsupported, json.place(), "the filter COLOR is not supported");
    const bool octahedral = filter == "OCTAHEDRAL", quaternion = filter == "QUATERNION",
               exponential = filter == "EXPONENTIAL";
    if (!octahedral && !quaternion && !exponential && filter != "NONE")
        json.fail("filter '", printable(filter), "' is unknown");
    if (!attributes && filter != "NONE") json.fail("filter ", filter, " is not allowed in mode ", mode);
    if ((octahedral && stride_bytes != 4 && stride_bytes != 8) || (quaternion && stride_bytes != 8))
        json.fail("byteStride ", stride_bytes, " is not allowed with filter ", filter);

    // The least that each codec needs: two bits for 16 equal bytes, a byte for a triangle or an index. Checked here, so
    // that a few bytes that claim gigabytes are refused before memory is allocated for them.
    const uint64_t min_bytes = attributes ? count * stride_bytes / 64 : triangles ? count / 3 : count;
    if (min_bytes > compressed.size()) json.fail(compressed.size(), " bytes are too few for a count of ", count);
    const auto decoded = charged_bytes(budget, count, stride_bytes, json.place());
    if (count == 0) return decoded;
    std::byte* const out = decoded->data();
    const auto* data = reinterpret_cast<const unsigned char*>(compressed.data());
    const int failed = attributes  ? meshopt_decodeVertexBuffer(out, count, stride_bytes, data, compressed.size())
                       : triangles ? meshopt_decodeIndexBuffer(out, count, stride_bytes, data, compressed.size())
                                   : meshopt_decodeIndexSequence(out, count, stride_bytes, data, compressed.size());
    if (failed) json.fail("the compressed data are broken (meshoptimizer error ", failed, ")");
    if (octahedral) meshopt_decodeFilterOct(out, count, stride_bytes);
    if (quaternion) meshopt_decodeFilterQuat(out, count, stride_bytes);
    if (exponential) meshopt_decodeFilterExp(out, count, stride_bytes);
    return decoded;
}

}  // namespace throng::gltf
