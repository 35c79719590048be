#include <throng/draw.h>

#include "base/replace_file.h"

#include <libdeflate.h>

#include <cstdlib>
#include <limits>

namespace {

// Returns a zlib stream, to be freed with free(); null if out of memory. stb's own compressor takes several times as
// long.
unsigned char* compressed(const unsigned char* data, int size_bytes, int* compressed_bytes, int /*level*/) {
    constexpr int kLevel = 3;  // of 12
    libdeflate_compressor* const compressor = libdeflate_alloc_compressor(kLevel);
    if (!compressor) return nullptr;
    const auto size = static_cast<size_t>(size_bytes);
    const size_t room = libdeflate_zlib_compress_bound(compressor, size);
    auto* const stream = static_cast<unsigned char*>(std::malloc(room));
    if (stream) *compressed_bytes = static_cast<int>(libdeflate_zlib_compress(compressor, data, size, stream, room));
    libdeflate_free_compressor(compressor);
    return stream;
}

}  // namespace

// Static, so that an application may have its own stb.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#define STBIW_ZLIB_COMPRESS compressed
#include <stb/stb_image_write.h>

namespace throng {
namespace {

std::vector<char> encode_png(const std::string& place, const Picture& picture) {
    if (picture.width == 0 || picture.height == 0 ||
        picture.rgba.size() != uint64_t{picture.width} * picture.height * 4)
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "the picture is empty, or its rgba does not have width x height x 4 bytes");
    constexpr uint64_t kStbLimit_bytes = std::numeric_limits<int>::max();  // it computes sizes as int
    if (picture.height * (picture.width * uint64_t{4} + 1) > kStbLimit_bytes)
        throw Failure(ErrorCode::kLimit, place, "the pixels of the picture exceed the limit of 2 GiB");

    std::vector<char> encoded;
    const auto append = [](void* to, void* data, int size_bytes) {
        const char* bytes = static_cast<const char*>(data);
        static_cast<std::vector<char>*>(to)->assign(bytes, bytes + size_bytes);  // the whole file at once
    };
    const int width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    if (!stbi_write_png_to_func(append, &encoded, width, height, 4, picture.rgba.data(), width * 4))
        throw std::bad_alloc();
    return encoded;
}

}  // namespace

Result<void> write_png(const std::filesystem::path& path, const Picture& picture) {
    return as_result([&] {
        const std::vector<char> encoded = encode_png(path.string(), picture);
        replace_file(path, std::as_bytes(std::span(encoded)));
    });
}

}  // namespace throng
