#include "draw/image_file.h"

#include "base/failure.h"

#include <webp/decode.h>

#include <cstring>
#include <limits>
#include <memory>

// Static, so that an application may have an stb of its own.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#include <stb/stb_image.h>

namespace throng {

static_assert(STBI_MAX_DIMENSIONS == kTextureDimensionLimit);  // WebP's own limit is 16,383

namespace {

Failure undecodable(const std::string& place, const char* why) {
    return Failure(ErrorCode::kInvalidFile, place, "cannot be decoded: ", why);
}

// "RIFF", a size, "WEBP".
bool is_webp(std::span<const uint8_t> bytes) {
    return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
           std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

}  // namespace

ImageFile::ImageFile(const AssetImage& image)
    : place_("image '" + image.name + "'"),
      bytes_(reinterpret_cast<const uint8_t*>(image.encoded.data()), image.encoded.size()),
      is_webp_(throng::is_webp(bytes_)) {
    if (bytes_.empty()) throw Failure(ErrorCode::kInvalidFile, place_, "has no content");
    if (bytes_.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
        throw Failure(ErrorCode::kLimit, place_, "is larger than 2 GiB");
    int width = 0, height = 0, channels = 0;
    if (is_webp_) {
        WebPBitstreamFeatures features;
        if (WebPGetFeatures(bytes_.data(), bytes_.size(), &features) != VP8_STATUS_OK)
            throw undecodable(place_, "a damaged WebP file");
        if (features.has_animation) throw undecodable(place_, "an animated WebP file");
        width = features.width;
        height = features.height;
    } else if (!stbi_info_from_memory(bytes_.data(), static_cast<int>(bytes_.size()), &width, &height, &channels)) {
        throw undecodable(place_, stbi_failure_reason());
    }
    width_ = static_cast<uint32_t>(width);
    height_ = static_cast<uint32_t>(height);
}

Picture ImageFile::decode() const {
    Picture picture{.width = width_, .height = height_};
    const uint64_t size_bytes = uint64_t{width_} * height_ * 4;
    if (is_webp_) {
        picture.rgba.resize(size_bytes);
        if (!WebPDecodeRGBAInto(bytes_.data(), bytes_.size(), picture.rgba.data(), size_bytes,
                                static_cast<int>(width_ * 4)))
            throw undecodable(place_, "a damaged WebP file");
        return picture;
    }
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(bytes_.data(), static_cast<int>(bytes_.size()), &width, &height, &channels,
                              STBI_rgb_alpha),
        &stbi_image_free);
    if (!pixels) throw undecodable(place_, stbi_failure_reason());
    picture.rgba.assign(pixels.get(), pixels.get() + size_bytes);
    return picture;
}

}  // namespace throng
