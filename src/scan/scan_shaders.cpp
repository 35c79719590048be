#include "scan/scan_shaders.h"

#include "base/failure.h"

#include <algorithm>

namespace throng {
namespace native {

#include "scan/scan_natives.inc"

}  // namespace native
namespace {

#include "scan/scan_shader_rows.inc"

}  // namespace

const ScanShaders& scan_shaders(std::string_view name) {
    const auto found = std::ranges::find(kScanShaders, name, &ScanShaders::name);
    if (found == std::end(kScanShaders))
        throw Failure(ErrorCode::kInvalidArgument, std::string(name), "src/scan/methods has no shader with this name");
    return *found;
}

}  // namespace throng
