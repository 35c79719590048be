// PNG files in memory, read by libspng.
#pragma once

#include "draw/image_size.h"

#include <span>
#include <string>
#include <vector>

namespace throng {

bool is_png(std::span<const uint8_t> bytes);

// Both throw kInvalidFile with `place`, or std::bad_alloc.
ImageSize size_of_png(std::span<const uint8_t> png, const std::string& place);
// 8-bit RGBA, [height][width][4].
std::vector<uint8_t> decode_png(std::span<const uint8_t> png, const std::string& place);

}  // namespace throng
