// The container of a glTF file: GLB chunks, and the buffers that the JSON names.
#pragma once

#include "import/limits.h"
#include "import/warnings.h"
#include "json/json_view.h"

#include <throng/asset.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace throng::gltf {

// Views into the file's bytes.
struct Container {
    std::string_view json;
    std::optional<std::span<const std::byte>> bin;
};

// A GLB if the file begins with its magic, otherwise JSON as a whole. Fails with kInvalidFile, and kUnsupported for GLB
// 1 (glTF 1.0).
Container open_container(std::span<const std::byte> file, Warnings& warnings);

// Where side files come from: a folder, or the application.
using SideFiles = std::variant<std::filesystem::path, AssetResolver>;

// Buffers and buffer views, read at first use: a buffer that nothing needs (the fallback of meshopt's extensions,
// which may be without data) is not looked at.
class Buffers {
public:
    // Keeps references.
    Buffers(JsonView root, const Container& container, const SideFiles& side_files, Budget& budget);

    struct View {
        std::span<const std::byte> bytes;
        uint64_t stride_bytes = 0;  // 0: tightly packed
    };
    // The content, decompressed, of the buffer view whose index is the member `bufferView`.
    View view_of(const JsonView& user);
    // Frees what has been decompressed; no view of it may be in use. A view that is needed again is decompressed again.
    void free_decompressed() { decompressed_views_.clear(); }

    // The content of a side file, for buffers and images. Charged to the limit of all side files.
    std::shared_ptr<const std::vector<std::byte>> side_file(std::string_view uri, const std::string& place);

private:
    std::span<const std::byte> buffer(uint32_t index);
    // The range of a buffer that `json` (a buffer view, or its meshopt extension) names.
    std::span<const std::byte> range(const JsonView& json);

    struct Loaded {
        std::shared_ptr<const std::vector<std::byte>> owner;  // none for the BIN chunk
        std::span<const std::byte> bytes;
    };

    JsonView buffers_;
    JsonView views_;
    std::optional<std::span<const std::byte>> bin_;
    const SideFiles& side_files_;
    Budget& budget_;
    uint64_t side_files_left_bytes_ = kFileLimitBytes;
    std::map<uint32_t, Loaded> loaded_buffers_;
    std::map<uint32_t, std::shared_ptr<const std::vector<std::byte>>> decompressed_views_;
    std::map<std::filesystem::path, std::shared_ptr<const std::vector<std::byte>>> loaded_side_files_;
};

}  // namespace throng::gltf
