#include "draw/jpeg_file.h"

#include "base/text.h"

#include <turbojpeg.h>

#include <memory>

namespace throng {
namespace {

constexpr size_t kScanLimit = 100;  // of a JPEG file; encoders write some ten

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

class JpegReader {
public:
    JpegReader(std::span<const uint8_t> jpeg, const std::string& place) : jpeg_(jpeg), place_(place) {
        if (!decoder_) throw std::bad_alloc();
        int subsampling = 0;
        check(tjDecompressHeader3(decoder_.get(), jpeg.data(), jpeg.size(), &width_, &height_, &subsampling, &colors_));
    }

    ImageSize size() const { return {static_cast<uint32_t>(width_), static_cast<uint32_t>(height_)}; }

    std::vector<uint8_t> decode() {
        const bool is_cmyk = colors_ == TJCS_CMYK || colors_ == TJCS_YCCK;
        std::vector<uint8_t> pixels(size_t{4} * static_cast<size_t>(width_) * static_cast<size_t>(height_));
        check(tjDecompress2(decoder_.get(), jpeg_.data(), jpeg_.size(), pixels.data(), width_, 0, height_,
                            is_cmyk ? TJPF_CMYK : TJPF_RGBA, 0));
        if (is_cmyk) make_rgba(pixels);
        return pixels;
    }

private:
    // A warning, about data that are cut short for example, leaves a picture.
    void check(int result) const {
        if (result != 0 && tjGetErrorCode(decoder_.get()) != TJERR_WARNING)
            throw undecodable(place_, "a damaged JPEG file: ", printable(tjGetErrorStr2(decoder_.get()), 120));
    }

    // Adobe's programs, which write such files, store the complements of cyan, magenta, yellow and black.
    static void make_rgba(std::vector<uint8_t>& cmyk) {
        for (size_t i = 0; i < cmyk.size(); i += 4) {
            const uint32_t black = cmyk[i + 3];
            for (size_t k = 0; k < 3; ++k) cmyk[i + k] = static_cast<uint8_t>((cmyk[i + k] * black + 127) / 255);
            cmyk[i + 3] = 255;
        }
    }

    std::span<const uint8_t> jpeg_;
    const std::string& place_;
    std::unique_ptr<void, decltype(&tjDestroy)> decoder_{tjInitDecompress(), &tjDestroy};
    int width_ = 0, height_ = 0, colors_ = 0;
};

}  // namespace

bool is_jpeg(std::span<const uint8_t> bytes) { return bytes.size() >= 2 && bytes[0] == 0xFF && bytes[1] == 0xD8; }

ImageSize size_of_jpeg(std::span<const uint8_t> jpeg, const std::string& place) {
    return JpegReader(jpeg, place).size();
}

std::vector<uint8_t> decode_jpeg(std::span<const uint8_t> jpeg, const std::string& place) {
    if (const size_t scans = scan_count(jpeg); scans > kScanLimit)
        throw undecodable(place, "a JPEG file of ", scans, " scans, more than the limit of ", kScanLimit,
                          "; save it again, not progressive");
    return JpegReader(jpeg, place).decode();
}

}  // namespace throng
