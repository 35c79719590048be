// Pictures that the tests look at, read by another than who wrote them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace throng::test {

struct Png {
    int width = 0, height = 0;
    int channels = 0;  // of the file
    std::vector<uint8_t> rgba;

    const uint8_t* at(int x, int y) const {
        return &rgba[(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * 4];
    }
};

// Fails the test, and is one black pixel, where there is no picture.
Png read_png(const std::filesystem::path& path);

}  // namespace throng::test
