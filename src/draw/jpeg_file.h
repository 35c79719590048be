// JPEG files in memory, read by libjpeg-turbo.
#pragma once

#include "draw/image_size.h"

#include <span>
#include <string>
#include <vector>

namespace throng {

bool is_jpeg(std::span<const uint8_t> bytes);

// Both throw kInvalidFile with `place`, or std::bad_alloc.
ImageSize size_of_jpeg(std::span<const uint8_t> jpeg, const std::string& place);
// 8-bit RGBA, [height][width][4].
std::vector<uint8_t> decode_jpeg(std::span<const uint8_t> jpeg, const std::string& place);

}  // namespace throng
