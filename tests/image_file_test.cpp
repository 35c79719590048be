// Decoding of material images in their file formats. No device is needed.
#include "draw/image_file.h"

#include "base/failure.h"
#include "tests/text.h"

#include <turbojpeg.h>
#include <webp/encode.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace throng::test {
namespace {

Picture some_picture() {
    Picture picture{.width = 37, .height = 21};
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x)
            for (const uint32_t value : {x * 6, y * 12, x * y % 256, 128 + x})
                picture.rgba.push_back(static_cast<uint8_t>(value));
    return picture;
}

using Encode = size_t (*)(const uint8_t* rgba, int width, int height, int stride, uint8_t** output);

AssetImage webp(const Picture& picture, Encode encode) {
    uint8_t* bytes = nullptr;
    const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    const size_t size_bytes = encode(picture.rgba.data(), width, height, width * 4, &bytes);
    AssetImage image{.name = "skin"};
    const auto* begin = reinterpret_cast<const std::byte*>(bytes);
    image.encoded.assign(begin, begin + size_bytes);
    WebPFree(bytes);
    return image;
}

void expect_refused(const AssetImage& image, const std::string& message) {
    try {
        (void)ImageFile(image).decode();
        ADD_FAILURE() << "taken; wanted: " << message;
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.error.code, ErrorCode::kInvalidFile);
        EXPECT_TRUE(contains(failure.error.text(), "image 'skin': " + message)) << failure.error.text();
    }
}

TEST(ImageFile, WebPIsDecoded) {
    const Picture picture = some_picture();
    const AssetImage image = webp(picture, WebPEncodeLosslessRGBA);
    const ImageFile file(image);
    EXPECT_EQ(file.width(), picture.width);
    EXPECT_EQ(file.height(), picture.height);
    const Picture decoded = file.decode();
    EXPECT_EQ(decoded.width, picture.width);
    EXPECT_EQ(decoded.height, picture.height);
    EXPECT_TRUE(decoded.rgba == picture.rgba);

    const auto lossy = [](const uint8_t* rgba, int width, int height, int stride, uint8_t** output) {
        return WebPEncodeRGBA(rgba, width, height, stride, 95, output);
    };
    const Picture near = ImageFile(webp(picture, lossy)).decode();
    ASSERT_EQ(near.rgba.size(), picture.rgba.size());
    EXPECT_FALSE(near.rgba == picture.rgba);
    double sum = 0;
    for (size_t i = 0; i < near.rgba.size(); ++i) sum += std::abs(near.rgba[i] - picture.rgba[i]);
    EXPECT_LT(sum / static_cast<double>(near.rgba.size()), 10);
}

TEST(ImageFile, UndecodableImagesAreRefused) {
    expect_refused({.name = "skin"}, "has no content");
    AssetImage text{.name = "skin"};
    for (const char c : std::string("not an image")) text.encoded.push_back(static_cast<std::byte>(c));
    expect_refused(text, "cannot be decoded: it is not a PNG, JPEG or WebP file");

    const AssetImage whole = webp(some_picture(), WebPEncodeLosslessRGBA);
    for (size_t size = 12; size < whole.encoded.size(); ++size) {
        AssetImage part{.name = "skin"};
        part.encoded.assign(whole.encoded.begin(), whole.encoded.begin() + static_cast<ptrdiff_t>(size));
        expect_refused(part, "cannot be decoded: a damaged WebP file");
    }
    // Only the header: a VP8X chunk that says the image is animated and has 8 by 8 pixels.
    const unsigned char animated[] = {'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                                      'X', 10,  0,   0,   0,  2, 0, 0, 0,   7,   0,   0,   7,   0,   0};
    AssetImage moving{.name = "skin"};
    for (const unsigned char byte : animated) moving.encoded.push_back(static_cast<std::byte>(byte));
    expect_refused(moving, "cannot be decoded: an animated WebP file");
}

using ImageBytes = std::vector<uint8_t>;

AssetImage encoded_image(const ImageBytes& bytes) {
    AssetImage image{.name = "skin"};
    for (const uint8_t byte : bytes) image.encoded.push_back(static_cast<std::byte>(byte));
    return image;
}

void append_bytes(ImageBytes& bytes, const ImageBytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

void append_chunk(ImageBytes& png, std::string_view type, const ImageBytes& data) {
    for (const int shift : {24, 16, 8, 0}) png.push_back(static_cast<uint8_t>(data.size() >> shift));
    for (const char c : type) png.push_back(static_cast<uint8_t>(c));
    append_bytes(png, data);
    append_bytes(png, {0, 0, 0, 0});  // checksums are not verified
}

struct PngHeader {
    uint8_t width = 0, height = 0, depth = 8, color = 6, interlaced = 0;
};

AssetImage png_of(const PngHeader& header, const ImageBytes& packed, const ImageBytes& palette = {}) {
    ImageBytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    append_chunk(png, "IHDR",
                 {0, 0, 0, header.width, 0, 0, 0, header.height, header.depth, header.color, 0, 0, header.interlaced});
    if (!palette.empty()) append_chunk(png, "PLTE", palette);
    append_chunk(png, "IDAT", packed);
    append_chunk(png, "IEND", {});
    return encoded_image(png);
}

// A zlib stream of one stored block.
ImageBytes stored_stream(const ImageBytes& raw) {
    const auto low = static_cast<uint8_t>(raw.size()), high = static_cast<uint8_t>(raw.size() >> 8);
    ImageBytes stream{0x78, 0x01, 0x01, low, high, static_cast<uint8_t>(~low), static_cast<uint8_t>(~high)};
    append_bytes(stream, raw);
    append_bytes(stream, {0, 0, 0, 0});
    return stream;
}

// A zlib stream of zeros, one and then 258 at a time: a block of fixed codes (RFC 1951, 3.2.6).
ImageBytes stream_of_zeros(size_t run_count) {
    ImageBytes stream{0x78, 0x01};
    uint32_t waiting = 0, waiting_bits = 0;
    const auto add = [&](uint32_t bits, uint32_t bit_count) {
        waiting |= bits << waiting_bits;
        for (waiting_bits += bit_count; waiting_bits >= 8; waiting_bits -= 8, waiting >>= 8)
            stream.push_back(static_cast<uint8_t>(waiting));
    };
    add(0b011, 3);                                                     // the last block, of fixed codes
    add(0b00001100, 8);                                                // 0; codes begin at the lowest bit
    for (size_t i = 0; i < run_count; ++i) add(0b00000'10100011, 13);  // 258 times the byte before
    add(0, 7 + 8);                                                     // the end, and padding of the last byte
    append_bytes(stream, {0, 0, 0, 0});
    return stream;
}

TEST(ImageFile, PngsOfAllKindsAreDecoded) {
    const Picture deep = ImageFile(png_of({.width = 2, .height = 1, .depth = 16},
                                          stored_stream({0, 10, 1, 20, 1, 30, 1, 40, 1, 50, 1, 60, 1, 70, 1, 80, 1})))
                             .decode();
    EXPECT_EQ(deep.rgba, (ImageBytes{10, 20, 30, 40, 50, 60, 70, 80}));

    // 8 by 8 pixels of one bit in seven passes; each row has a filter byte. Only the upper-left pixel, which is the
    // first pass, has the second colour.
    ImageBytes passes{0, 0x80};
    passes.resize(2 * (1 + 1 + 1 + 2 + 2 + 4 + 4));
    const Picture interlaced = ImageFile(png_of({.width = 8, .height = 8, .depth = 1, .color = 3, .interlaced = 1},
                                                stored_stream(passes), {1, 2, 3, 4, 5, 6}))
                                   .decode();
    ASSERT_EQ(interlaced.rgba.size(), 8u * 8 * 4);
    for (size_t i = 0; i < interlaced.rgba.size(); i += 4)
        EXPECT_EQ(ImageBytes(&interlaced.rgba[i], &interlaced.rgba[i] + 4),
                  i == 0 ? (ImageBytes{4, 5, 6, 255}) : (ImageBytes{1, 2, 3, 255}));

    // 64 by 64 pixels of 8 bytes, and the filters of 120 rows: 7 passes.
    const PngHeader deep_passes{.width = 64, .height = 64, .depth = 16, .interlaced = 1};
    const Picture packed = ImageFile(png_of(deep_passes, stream_of_zeros(128))).decode();
    EXPECT_EQ(packed.rgba, ImageBytes(64 * 64 * 4));
}

TEST(ImageFile, MessagesHoldNoBytesOfTheFile) {
    ImageBytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    append_chunk(png, "IHDR", {0, 0, 0, 1, 0, 0, 0, 1, 8, 6, 0, 0, 0});
    append_chunk(png, "A\nB\x1B", {});  // upper case: a chunk that a reader must know
    expect_refused(encoded_image(png), "cannot be decoded: libspng refuses the PNG file: unknown critical chunk");
}

TEST(ImageFile, DataBehindThePixelsOfAPngAreIgnored) {
    const Picture tiny = ImageFile(png_of({.width = 1, .height = 1}, stream_of_zeros(1 << 14))).decode();
    EXPECT_EQ(tiny.rgba, ImageBytes(4));
}

void append_segment(ImageBytes& jpeg, uint8_t marker, const ImageBytes& data) {
    append_bytes(jpeg,
                 {0xFF, marker, static_cast<uint8_t>((data.size() + 2) >> 8), static_cast<uint8_t>(data.size() + 2)});
    append_bytes(jpeg, data);
}

// A quantization table, the header of a progressive picture of 8 by 8 pixels, and tables with one code, for 0.
void append_jpeg_tables(ImageBytes& jpeg, const ImageBytes& components) {
    ImageBytes quantization(65, 1), codes(18), header{8, 0, 8, 0, 8};
    quantization[0] = 0;
    append_segment(jpeg, 0xDB, quantization);
    append_bytes(header, components);
    append_segment(jpeg, 0xC2, header);
    for (const uint8_t table : ImageBytes{0x00, 0x10}) {
        codes[0] = table;
        codes[1] = 1;
        append_segment(jpeg, 0xC4, codes);
    }
}

const ImageBytes kBadCodes = [] {
    ImageBytes codes(17, 255);
    codes[0] = 0x13;
    return codes;
}();

// A progressive JPEG of 8 by 8 grey pixels: one scan for the mean; the others contain nothing.
AssetImage jpeg_of(int scan_count, const ImageBytes& behind_scans = {}) {
    ImageBytes jpeg{0xFF, 0xD8};
    ImageBytes scans_of_others;
    for (int i = 0; i < 200; ++i) append_bytes(scans_of_others, {0xFF, 0xDA});
    append_segment(jpeg, 0xE1, scans_of_others);  // as in a thumbnail
    append_jpeg_tables(jpeg, {1, 1, 0x11, 0});
    for (int i = 0; i < scan_count; ++i) {
        append_segment(jpeg, 0xDA, {1, 1, 0, static_cast<uint8_t>(i > 0), static_cast<uint8_t>(i > 0 ? 63 : 0), 0});
        jpeg.push_back(0);
    }
    append_bytes(jpeg, behind_scans);
    append_bytes(jpeg, {0xFF, 0xD9});
    append_bytes(jpeg, scans_of_others);  // as in a video appended to the picture
    return encoded_image(jpeg);
}

// A table has one code for each of 256 values at most; this one says that it has 4,080.
TEST(ImageFile, AJpegWithTooManyCodesIsRefused) {
    ImageBytes jpeg{0xFF, 0xD8};
    append_segment(jpeg, 0xC4, kBadCodes);
    expect_refused(encoded_image(jpeg), "cannot be decoded: libjpeg-turbo refuses the JPEG file: Bogus Huffman table");
    // Also behind bytes that libjpeg only warns of
    ImageBytes behind{0x12, 0x34};
    append_segment(behind, 0xC4, kBadCodes);
    expect_refused(jpeg_of(2, behind), "cannot be decoded: libjpeg-turbo refuses the JPEG file: Bogus Huffman table");
}

ImageBytes compressed_jpeg(const ImageBytes& pixels, int width, int height, int format) {
    unsigned char* encoded = nullptr;
    unsigned long size = 0;
    const tjhandle encoder = tjInitCompress();
    EXPECT_EQ(tjCompress2(encoder, pixels.data(), width, 0, height, format, &encoded, &size, TJSAMP_444, 95, 0), 0);
    const ImageBytes jpeg(encoded, encoded + size);
    tjFree(encoded);
    tjDestroy(encoder);
    return jpeg;
}

TEST(ImageFile, AJpegThatEndsTooEarlyKeepsItsBeginning) {
    const Picture noise = some_picture();
    ImageBytes jpeg = compressed_jpeg(noise.rgba, static_cast<int>(noise.width), static_cast<int>(noise.height),
                                      TJPF_RGBX);
    const Picture whole = ImageFile(encoded_image(jpeg)).decode();
    jpeg.resize(jpeg.size() * 3 / 4);
    const Picture part = ImageFile(encoded_image(jpeg)).decode();
    ASSERT_EQ(part.rgba.size(), whole.rgba.size());
    const auto first_rows = static_cast<ptrdiff_t>(noise.width * 4 * 4);
    EXPECT_TRUE(std::equal(whole.rgba.begin(), whole.rgba.begin() + first_rows, part.rgba.begin()));
    EXPECT_FALSE(whole.rgba == part.rgba);
}

// Chroma of a quarter of the width and half of the height, which TurboJPEG has no name for.
TEST(ImageFile, JpegsOfUnusualSubsamplingAreDecoded) {
    ImageBytes jpeg{0xFF, 0xD8};
    append_jpeg_tables(jpeg, {3, 1, 0x42, 0, 2, 0x11, 0, 3, 0x11, 0});
    append_segment(jpeg, 0xDA, {3, 1, 0, 2, 0, 3, 0, 0, 0, 0});
    append_bytes(jpeg, {0, 0, 0xFF, 0xD9});  // ten blocks of one bit each
    const Picture grey = ImageFile(encoded_image(jpeg)).decode();
    ASSERT_EQ(grey.rgba.size(), 8u * 8 * 4);
    EXPECT_EQ(ImageBytes(grey.rgba.begin(), grey.rgba.begin() + 4), (ImageBytes{128, 128, 128, 255}));
}

TEST(ImageFile, CmykJpegsAreDecoded) {
    ImageBytes cmyk;  // as Adobe's programs store them, complements
    for (int i = 0; i < 8 * 8; ++i) append_bytes(cmyk, {250, 120, 60, 204});
    const Picture picture = ImageFile(encoded_image(compressed_jpeg(cmyk, 8, 8, TJPF_CMYK))).decode();
    ASSERT_EQ(picture.rgba.size(), 8u * 8 * 4);
    const ImageBytes expected{200, 96, 48, 255};
    for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(picture.rgba[k], expected[k], 2);
}

TEST(ImageFile, AJpegHasAtMostOneHundredScans) {
    const Picture grey = ImageFile(jpeg_of(100)).decode();
    EXPECT_EQ(grey.width, 8u);
    ASSERT_EQ(grey.rgba.size(), 8u * 8 * 4);
    EXPECT_EQ(grey.rgba[0], 128);
    AssetImage many = jpeg_of(101);
    expect_refused(many, "cannot be decoded: a JPEG file of 101 scans, more than the limit of 100");
    many.encoded.insert(many.encoded.begin() + 2, many.encoded.front());  // a fill byte before a marker
    expect_refused(many, "cannot be decoded: a JPEG file of 101 scans");
    many = jpeg_of(101);  // FF 01 has no length, so what follows is not skipped
    for (const uint8_t byte : ImageBytes{0xFF, 0xFF, 0x01, 0xFF})
        many.encoded.insert(many.encoded.begin() + 2, std::byte{byte});
    expect_refused(many, "cannot be decoded: a JPEG file of 101 scans");
}

}  // namespace
}  // namespace throng::test
