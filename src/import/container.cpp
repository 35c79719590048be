#include "import/container.h"

#include "base/read_file.h"
#include "import/meshopt.h"
#include "import/uri.h"

#include <bit>
#include <cstring>

namespace throng::gltf {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian, and its data are used as they are");

constexpr uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t kBinChunk = 0x004E4942;   // "BIN\0"
constexpr size_t kGlbHeaderBytes = 12, kChunkHeaderBytes = 8;

uint32_t word_at(std::span<const std::byte> bytes, size_t offset) {
    uint32_t word = 0;
    std::memcpy(&word, bytes.data() + offset, sizeof(word));
    return word;
}

std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class... Parts>
[[noreturn]] void fail(const Parts&... message) {
    throw Failure(ErrorCode::kInvalidFile, "", message...);
}

Container open_glb(std::span<const std::byte> file, Warnings& warnings) {
    if (file.size() < kGlbHeaderBytes) fail("GLB header: the file ends within it");
    const uint32_t version = word_at(file, 4), length = word_at(file, 8);
    if (version == 1) throw Failure(ErrorCode::kUnsupported, "", "glTF 1.0 is not supported, only 2.0");
    if (version != 2) throw Failure(ErrorCode::kUnsupported, "", "GLB version ", version, " is not supported, only 2");
    if (length > file.size()) fail("GLB header: the length is ", length, " bytes, but the file has ", file.size());
    if (length < file.size()) warnings.add("", "GLB header: bytes after the stated length are ignored");
    file = file.first(length);

    Container out;
    size_t offset = kGlbHeaderBytes;
    for (uint32_t chunk = 0; offset < file.size(); ++chunk) {
        const std::string name = "GLB chunk " + std::to_string(chunk);
        if (file.size() - offset < kChunkHeaderBytes) fail(name, ": the file ends within its header");
        const uint32_t size_bytes = word_at(file, offset), type = word_at(file, offset + 4);
        offset += kChunkHeaderBytes;
        if (size_bytes > file.size() - offset)
            fail(name, ": its header says ", size_bytes, " bytes, but ", file.size() - offset, " are left");
        const auto content = file.subspan(offset, size_bytes);
        if ((chunk == 0) != (type == kJsonChunk))
            fail(name, chunk == 0 ? ": must be JSON" : ": is a second JSON chunk");
        if (chunk == 0) {
            out.json = as_text(content);
        } else if (type == kBinChunk) {
            if (out.bin) fail(name, ": is a second BIN chunk");
            out.bin = content;
        }
        offset += size_bytes;
    }
    if (out.json.empty()) fail("GLB: has no JSON");
    return out;
}

// What the application's resolver returns for a name.
std::vector<std::byte> resolved(const AssetResolver& resolver, const std::string& name, const std::string& place) {
    if (!resolver)
        throw Failure(ErrorCode::kFile, place, "'", printable(name),
                      "' cannot be found: a file in memory needs a resolver for side files (load_asset)");
    Result<std::vector<std::byte>> bytes = call_application(place, "the resolver", [&] { return resolver(name); });
    if (!bytes)
        throw Failure(bytes.error().code, place, "'", printable(name),
                      "' was not returned by the resolver: ", printable(bytes.error().text(), 200));
    return *std::move(bytes);
}

}  // namespace

Container open_container(std::span<const std::byte> file, Warnings& warnings) {
    if (file.empty()) fail("the file is empty");
    if (file.size() >= 4 && word_at(file, 0) == kGlbMagic) return open_glb(file, warnings);
    const std::string_view text = as_text(file);
    const size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");  // byte order mark: forbidden, but it occurs
    if (first == text.npos || text[first] != '{') fail("neither a GLB file nor the JSON of a glTF file");
    return Container{text, {}};
}

Buffers::Buffers(JsonView root, const Container& container, const SideFiles& side_files, Budget& budget)
    : buffers_(root.optional_array("buffers")),
      views_(root.optional_array("bufferViews")),
      bin_(container.bin),
      side_files_(side_files),
      budget_(budget) {}

Buffers::View Buffers::view_of(const JsonView& user) {
    const uint32_t index = user.required_index("bufferView", views_.size(), "bufferViews");
    const JsonView json = views_[index];
    auto compressed = json.extension("EXT_meshopt_compression");
    if (!compressed) compressed = json.extension("KHR_meshopt_compression");
    View out;
    out.stride_bytes = json.optional_uint("byteStride", 0);
    if (!compressed) {
        out.bytes = range(json);
        return out;
    }
    auto known = decompressed_views_.find(index);
    if (known == decompressed_views_.end())
        known = decompressed_views_.emplace(index, decode_meshopt(*compressed, range(*compressed), budget_)).first;
    const uint64_t size_bytes = json.required_uint("byteLength");
    const std::vector<std::byte>& decompressed = *known->second;
    if (size_bytes > decompressed.size())
        json.fail("byteLength is ", size_bytes, ", but ", decompressed.size(), " bytes are compressed");
    out.bytes = std::span(decompressed).first(size_bytes);
    return out;
}

std::span<const std::byte> Buffers::range(const JsonView& json) {
    const auto bytes = buffer(json.required_index("buffer", buffers_.size(), "buffers"));
    const uint64_t offset = json.optional_uint("byteOffset", 0), size_bytes = json.required_uint("byteLength");
    // Both are below 2^53, so the sum cannot overflow.
    if (offset + size_bytes > bytes.size())
        json.fail("ends at byte ", offset + size_bytes, ", but its buffer has ", bytes.size());
    return bytes.subspan(offset, size_bytes);
}

std::span<const std::byte> Buffers::buffer(uint32_t index) {
    const auto known = loaded_buffers_.find(index);
    if (known != loaded_buffers_.end()) return known->second.bytes;
    Loaded loaded;
    const JsonView json = buffers_[index];
    const std::string place = json.place_of("uri");
    const uint64_t size_bytes = json.required_uint("byteLength");
    if (const std::string* uri = json.optional_string("uri")) {
        loaded.owner = is_data_uri(*uri)
                           ? std::make_shared<const std::vector<std::byte>>(decode_data_uri(*uri, budget_, place))
                           : side_file(*uri, place);
        loaded.bytes = *loaded.owner;
    } else {
        if (index != 0 || !bin_) json.fail("has no uri, and the file has no BIN chunk for it");
        loaded.bytes = *bin_;
    }
    if (size_bytes > loaded.bytes.size())
        json.fail("byteLength is ", size_bytes, ", but there are ", loaded.bytes.size(), " bytes");
    loaded.bytes = loaded.bytes.first(size_bytes);
    return loaded_buffers_.emplace(index, std::move(loaded)).first->second.bytes;
}

std::shared_ptr<const std::vector<std::byte>> Buffers::side_file(std::string_view uri, const std::string& place) {
    const auto* folder = std::get_if<std::filesystem::path>(&side_files_);
    const std::filesystem::path path = folder ? resolve_side_file(uri, *folder, place)
                                              : std::filesystem::path(side_file_name(uri, place));
    auto& content = loaded_side_files_[path];
    if (content) return content;
    const char* too_large = side_files_left_bytes_ < kFileLimitBytes
                                ? "together with the side files read before, the file is larger than the limit of 2 GiB"
                                : kLargerThanFiles;
    std::vector<std::byte> bytes = folder
                                       ? read_file(path, side_files_left_bytes_, place, too_large, budget_.progress())
                                       : resolved(std::get<AssetResolver>(side_files_), path.string(), place);
    if (bytes.size() > side_files_left_bytes_) throw Failure(ErrorCode::kLimit, place, too_large);
    side_files_left_bytes_ -= bytes.size();
    budget_.add_file(bytes.size());
    return content = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
}

}  // namespace throng::gltf
