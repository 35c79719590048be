#include "draw/image_file.h"

#include "draw/image_size.h"
#include "draw/jpeg_file.h"
#include "draw/png_file.h"

#include <webp/decode.h>

#include <cstring>
#include <limits>

namespace throng {
namespace {

// "RIFF", a size, "WEBP".
bool is_webp(std::span<const uint8_t> bytes) {
    return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
           std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

ImageSize size_of_webp(std::span<const uint8_t> webp, const std::string& place) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(webp.data(), webp.size(), &features) != VP8_STATUS_OK)
        throw undecodable(place, "a damaged WebP file");
    if (features.has_animation) throw undecodable(place, "an animated WebP file");
    return {static_cast<uint32_t>(features.width), static_cast<uint32_t>(features.height)};
}

std::vector<uint8_t> decode_webp(std::span<const uint8_t> webp, const ImageSize& size, const std::string& place) {
    std::vector<uint8_t> rgba(size_t{4} * size.width * size.height);
    if (!WebPDecodeRGBAInto(webp.data(), webp.size(), rgba.data(), rgba.size(), static_cast<int>(size.width * 4)))
        throw undecodable(place, "a damaged WebP file");
    return rgba;
}

ImageSize size_of(std::span<const uint8_t> bytes, const std::string& place) {
    if (is_png(bytes)) return size_of_png(bytes, place);
    if (is_jpeg(bytes)) return size_of_jpeg(bytes, place);
    if (is_webp(bytes)) return size_of_webp(bytes, place);
    throw undecodable(place, "it is not a PNG, JPEG or WebP file");
}

}  // namespace

ImageFile::ImageFile(const AssetImage& image)
    : place_("image '" + image.name + "'"),
      bytes_(reinterpret_cast<const uint8_t*>(image.encoded.data()), image.encoded.size()) {
    if (bytes_.empty()) throw Failure(ErrorCode::kInvalidFile, place_, "has no content");
    if (bytes_.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
        throw Failure(ErrorCode::kLimit, place_, "is larger than 2 GiB");
    const ImageSize size = size_of(bytes_, place_);
    if (size.width > kTextureDimensionLimit || size.height > kTextureDimensionLimit)
        throw undecodable(place_, size.width, " x ", size.height, " pixels exceed the limit of ",
                          kTextureDimensionLimit, " in width and height");
    width_ = size.width;
    height_ = size.height;
}

Picture ImageFile::decode() const {
    Picture picture{.width = width_, .height = height_};
    if (is_png(bytes_))
        picture.rgba = decode_png(bytes_, place_);
    else if (is_jpeg(bytes_))
        picture.rgba = decode_jpeg(bytes_, place_);
    else
        picture.rgba = decode_webp(bytes_, {width_, height_}, place_);
    return picture;
}

}  // namespace throng
