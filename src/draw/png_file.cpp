#include "draw/png_file.h"

#include <spng.h>

#include <cstring>
#include <memory>
#include <new>

namespace throng {
namespace {

// Ancillary chunks (a colour profile, text) are unpacked before the pixels. The limits are for one chunk and for all
// that are kept; a file that exceeds one is refused.
constexpr size_t kChunkLimit_bytes = 16 << 20, kChunksLimit_bytes = 64 << 20;

class PngReader {
public:
    PngReader(std::span<const uint8_t> png, const std::string& place) : place_(place) {
        if (!context_) throw std::bad_alloc();
        // Damaged checksums are ignored, as most viewers do: exporters have written some
        check(spng_set_crc_action(context_.get(), SPNG_CRC_USE, SPNG_CRC_USE));
        check(spng_set_chunk_limits(context_.get(), kChunkLimit_bytes, kChunksLimit_bytes));
        check(spng_set_png_buffer(context_.get(), png.data(), png.size()));
        check(spng_get_ihdr(context_.get(), &header_));
    }

    ImageSize size() const { return {header_.width, header_.height}; }

    std::vector<uint8_t> decode() {
        size_t size_bytes = 0;
        check(spng_decoded_image_size(context_.get(), SPNG_FMT_RGBA8, &size_bytes));
        std::vector<uint8_t> rgba(size_bytes);
        check(spng_decode_image(context_.get(), rgba.data(), rgba.size(), SPNG_FMT_RGBA8, SPNG_DECODE_TRNS));
        return rgba;
    }

private:
    void check(int result) const {
        if (result == SPNG_EMEM) throw std::bad_alloc();
        if (result != 0) throw undecodable(place_, "libspng refuses the PNG file: ", spng_strerror(result));
    }

    const std::string& place_;
    std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> context_{spng_ctx_new(SPNG_CTX_IGNORE_ADLER32), &spng_ctx_free};
    spng_ihdr header_{};
};

}  // namespace

bool is_png(std::span<const uint8_t> bytes) {
    return bytes.size() >= 4 && std::memcmp(bytes.data(), "\x89PNG", 4) == 0;
}

ImageSize size_of_png(std::span<const uint8_t> png, const std::string& place) { return PngReader(png, place).size(); }

std::vector<uint8_t> decode_png(std::span<const uint8_t> png, const std::string& place) {
    return PngReader(png, place).decode();
}

}  // namespace throng
