// What the readers of image formats share.
#pragma once

#include "base/failure.h"

#include <cstdint>
#include <string>

namespace throng {

struct ImageSize {
    uint32_t width = 0, height = 0;  // pixels
};

template <class... Why>
Failure undecodable(const std::string& place, const Why&... why) {
    return Failure(ErrorCode::kInvalidFile, place, "cannot be decoded: ", why...);
}

}  // namespace throng
