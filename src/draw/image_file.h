// Encoded image files.
#pragma once

#include <throng/asset.h>
#include <throng/draw.h>

#include <cstdint>
#include <span>
#include <string>

namespace throng {

inline constexpr uint32_t kTextureDimensionLimit = 16'384;

// A PNG, JPEG or WebP file in memory, recognized by its content.
class ImageFile {
public:
    // Reads only the file's header. `image` must live as long as this. Throws kInvalidFile if the content is empty,
    // damaged, none of these formats, an animated WebP file or larger than kTextureDimensionLimit in width or height,
    // and kLimit above 2 GiB; these name the image. Throws std::bad_alloc if there is too little memory.
    explicit ImageFile(const AssetImage& image);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const std::string& place() const { return place_; }  // names the image in messages
    // Throws kInvalidFile, or std::bad_alloc.
    Picture decode() const;

private:
    std::string place_;
    std::span<const uint8_t> bytes_;
    uint32_t width_ = 0, height_ = 0;
};

}  // namespace throng
