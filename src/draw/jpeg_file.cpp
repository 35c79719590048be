#include "draw/jpeg_file.h"

#include "base/text.h"

#include <turbojpeg.h>

#include <memory>
#include <new>

namespace throng {
namespace {

constexpr size_t kScanLimit = 100;  // of a JPEG file; encoders write some ten

// The number of scans of a JPEG file. Each is decoded for the whole picture, however little data it has.
size_t scan_count(std::span<const uint8_t> jpeg) {
    constexpr uint8_t kBeginsMarker = 0xFF, kFirstWithLength = 0xC0, kFirstRestart = 0xD0, kPictureBegins = 0xD8,
                      kPictureEnds = 0xD9, kScan = 0xDA;
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
        // These have no length field. FF 00 is a stuffed byte of entropy-coded data; FF 01 and FF D0 to FF D8 have no
        // parameters; FF 02 to FF BF are reserved, and where a restart marker is due libjpeg skips them as bogus data
        if (marker < kFirstWithLength || (marker >= kFirstRestart && marker <= kPictureBegins)) continue;
        at += size_t{jpeg[at]} << 8 | jpeg[at + 1];
    }
    return count;
}

class JpegReader {
public:
    JpegReader(std::span<const uint8_t> jpeg, const std::string& place) : jpeg_(jpeg), place_(place) {
        if (!decoder_) throw std::bad_alloc();
        // It also fails for unusual but valid subsampling, after it has read the size
        int subsampling = 0;
        (void)tjDecompressHeader3(decoder_.get(), jpeg.data(), jpeg.size(), &width_, &height_, &subsampling, &colors_);
        if (width_ < 1 || height_ < 1) fail();
    }

    ImageSize size() const { return {static_cast<uint32_t>(width_), static_cast<uint32_t>(height_)}; }

    std::vector<uint8_t> decode() {
        std::vector<uint8_t> pixels(size_t{4} * static_cast<size_t>(width_) * static_cast<size_t>(height_));
        const bool is_cmyk = colors_ == TJCS_CMYK || colors_ == TJCS_YCCK;
        const bool succeeds = tjDecompress2(decoder_.get(), jpeg_.data(), jpeg_.size(), pixels.data(), width_, 0,
                                            height_, is_cmyk ? TJPF_CMYK : TJPF_RGBA, 0) == 0;
        // `pixels` begins as zeros. If the last alpha is 255, all rows were written, and there was a mere warning, for
        // example about data that are cut short. The error code does not tell: it also reports a warning if an error
        // came after one. CMYK has no alpha to look at, so there a warning counts as an error.
        if (!succeeds && (is_cmyk || pixels.back() != 255)) fail();
        if (is_cmyk) make_rgba(pixels);
        return pixels;
    }

private:
    [[noreturn]] void fail() const {
        const std::string why = tjGetErrorStr2(decoder_.get());
        if (why.find("nsufficient memory") != why.npos) throw std::bad_alloc();
        throw undecodable(place_, "libjpeg-turbo refuses the JPEG file: ", printable(why, 120));
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
