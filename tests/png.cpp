#include "tests/png.h"

#include <gtest/gtest.h>

#include <memory>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

namespace throng::test {

Png read_png(const std::filesystem::path& path) {
    Png png;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load(path.c_str(), &png.width, &png.height, &png.channels, 4), stbi_image_free);
    if (!pixels) {
        ADD_FAILURE() << path << ": " << stbi_failure_reason();
        return {.width = 1, .height = 1, .channels = 0, .rgba = {0, 0, 0, 0}};
    }
    png.rgba.assign(pixels.get(), pixels.get() + size_t(png.width) * size_t(png.height) * 4);
    return png;
}

}  // namespace throng::test
