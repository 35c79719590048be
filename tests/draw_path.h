// For tests that draw both on this machine's processor and with the device's shaders.
#pragma once

#include "tests/kernel_runner.h"

#include <throng/draw.h>

#include <gtest/gtest.h>

#include <string>

namespace throng::test {

// Why the test device cannot draw in this way. Empty if it can.
inline std::string undrawable_reason(DrawPath path) {
    if (path == DrawPath::kDevice && test_gpu()->is_native()) return "it has no shaders";
    if (path == DrawPath::kNative && !test_gpu()->processor) return "the processor does not draw for it";
    return {};
}

inline const auto kBothDrawPaths = testing::Values(DrawPath::kNative, DrawPath::kDevice);
inline std::string name_of_path(const testing::TestParamInfo<DrawPath>& of) {
    return of.param == DrawPath::kNative ? "Natively" : "ByShaders";
}

}  // namespace throng::test
