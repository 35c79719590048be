// Alpha to coverage: the shaders' source, compiled as C++.
#pragma once

#include <cstdint>

// Not all includers need all of it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"

namespace throng::raster {
namespace {

using uint = uint32_t;
#include "draw/coverage.glsl"

}  // namespace
}  // namespace throng::raster

#pragma GCC diagnostic pop
