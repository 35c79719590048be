// Reads the pictures that tests check, with another decoder than the code that wrote them uses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace throng::test {

struct Png {
    int width = 0, height = 0;
    int channels = 0;  // in the file
    std::vector<uint8_t> rgba;

    const uint8_t* at(int x, int y) const {
        return &rgba[(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * 4];
    }
};

// Without a picture, fails the test and returns one black pixel.
Png read_png(const std::filesystem::path& path);

}  // namespace throng::test
