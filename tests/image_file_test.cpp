// Images of materials, as files have them. No device is needed.
#include "draw/image_file.h"

#include "base/failure.h"
#include "tests/text.h"

#include <webp/encode.h>

#include <gtest/gtest.h>

#include <cstdlib>

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

TEST(ImageFile, WhatIsNoneIsSaid) {
    expect_refused({.name = "skin"}, "has no content");
    AssetImage text{.name = "skin"};
    for (const char c : std::string("not an image")) text.encoded.push_back(static_cast<std::byte>(c));
    expect_refused(text, "cannot be decoded: ");

    const AssetImage whole = webp(some_picture(), WebPEncodeLosslessRGBA);
    for (size_t size = 12; size < whole.encoded.size(); ++size) {
        AssetImage part{.name = "skin"};
        part.encoded.assign(whole.encoded.begin(), whole.encoded.begin() + static_cast<ptrdiff_t>(size));
        expect_refused(part, "cannot be decoded: a damaged WebP file");
    }
    // Its head alone: a VP8X chunk that says it is animated, of 8 by 8 pixels.
    const unsigned char animated[] = {'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                                      'X', 10,  0,   0,   0,  2, 0, 0, 0,   7,   0,   0,   7,   0,   0};
    AssetImage moving{.name = "skin"};
    for (const unsigned char byte : animated) moving.encoded.push_back(static_cast<std::byte>(byte));
    expect_refused(moving, "cannot be decoded: an animated WebP file");
}

}  // namespace
}  // namespace throng::test
