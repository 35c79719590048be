#include "draw/image_file.h"

#include "base/failure.h"

#include <webp/decode.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

namespace throng {
namespace {

constexpr uint64_t kUnlimited_bytes = std::numeric_limits<uint64_t>::max();

// The largest allocation that stb may make on this thread. stb unpacks a PNG file to whatever size its data expand to:
// a megabyte can expand to a gigabyte.
thread_local uint64_t stb_limit_bytes = kUnlimited_bytes;
thread_local bool stb_asked_for_more = false;

void* reallocate_for_stb(void* memory, size_t size_bytes) {
    if (size_bytes <= stb_limit_bytes) return std::realloc(memory, size_bytes);
    stb_asked_for_more = true;
    return nullptr;
}

class StbLimit {
public:
    explicit StbLimit(uint64_t limit_bytes) {
        stb_limit_bytes = limit_bytes;
        stb_asked_for_more = false;
    }
    ~StbLimit() { stb_limit_bytes = kUnlimited_bytes; }
    StbLimit(const StbLimit&) = delete;
    StbLimit& operator=(const StbLimit&) = delete;
};

}  // namespace
}  // namespace throng

// Static, so that an application may have its own stb.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_FAILURE_USERMSG  // the other messages can hold bytes of the file
#define STBI_MAX_DIMENSIONS 16384
#define STBI_MALLOC(size) throng::reallocate_for_stb(nullptr, size)
#define STBI_REALLOC(memory, size) throng::reallocate_for_stb(memory, size)
#define STBI_FREE(memory) std::free(memory)
#include <stb/stb_image.h>

namespace throng {

static_assert(STBI_MAX_DIMENSIONS == kTextureDimensionLimit);  // WebP's own limit is 16,383

namespace {

constexpr size_t kScanLimit = 100;  // of a JPEG file; encoders write some ten

template <class... Why>
Failure undecodable(const std::string& place, const Why&... why) {
    return Failure(ErrorCode::kInvalidFile, place, "cannot be decoded: ", why...);
}

// "RIFF", a size, "WEBP".
bool is_webp(std::span<const uint8_t> bytes) {
    return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
           std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

bool is_png(std::span<const uint8_t> bytes) {
    return bytes.size() >= 4 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0;
}

// The largest block of memory that decoding a PNG file can need. It is either the packed data, gathered in a block that
// doubles; or the rows, each with a filter byte and up to four 16-bit channels for each pixel. Interlaced files have
// more rows, for which stb doubles the block once.
uint64_t largest_of_png_bytes(uint64_t file_bytes, uint64_t width, uint64_t height) {
    constexpr uint64_t kMin_bytes = 4096;
    return std::max(2 * file_bytes + kMin_bytes, 2 * (width * 8 + 1) * height);
}

// The number of scans of a JPEG file. Each is decoded for the whole picture, however little data it has.
size_t scan_count(std::span<const uint8_t> jpeg) {
    constexpr uint8_t kBeginsMarker = 0xFF, kFirstRestart = 0xD0, kPictureBegins = 0xD8, kPictureEnds = 0xD9,
                      kScan = 0xDA;
    size_t count = 0;
    for (size_t at = 0; at + 4 <= jpeg.size();) {
        const uint8_t marker = jpeg[at + 1];
        if (jpeg[at] != kBeginsMarker || marker == kBeginsMarker) {
            ++at;
            continue;
        }
        if (marker == kPictureEnds) break;
        if (marker == kScan) ++count;
        at += 2;
        // These have no length field: FF 00 is a stuffed byte of entropy-coded data, FF D0 to FF D8 are restart markers
        // and the start of the image
        if (marker == 0 || (marker >= kFirstRestart && marker <= kPictureBegins)) continue;
        at += size_t{jpeg[at]} << 8 | jpeg[at + 1];
    }
    return count;
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
    if (const size_t scans = is_png(bytes_) ? 0 : scan_count(bytes_); scans > kScanLimit)
        throw undecodable(place_, "a JPEG file of ", scans, " scans, more than the limit of ", kScanLimit,
                          "; save it again, not progressive");
    const StbLimit limit(is_png(bytes_) ? largest_of_png_bytes(bytes_.size(), width_, height_) : kUnlimited_bytes);
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_memory(bytes_.data(), static_cast<int>(bytes_.size()), &width, &height, &channels,
                              STBI_rgb_alpha),
        &stbi_image_free);
    if (stb_asked_for_more)
        throw undecodable(place_, "its data are larger than ", width_, " x ", height_,
                          " pixels can be: a damaged PNG file");
    if (!pixels) throw undecodable(place_, stbi_failure_reason());
    picture.rgba.assign(pixels.get(), pixels.get() + size_bytes);
    return picture;
}

}  // namespace throng
