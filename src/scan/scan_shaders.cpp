#include "scan/scan_shaders.h"

#include "base/failure.h"

#include <algorithm>

namespace throng {
namespace {

#include "scan/scan_shader_rows.inc"

}  // namespace

const ScanShaders& scan_shaders(std::string_view name) {
    const auto found = std::find_if(std::begin(kScanShaders), std::end(kScanShaders),
                                    [&](const ScanShaders& row) { return row.name == name; });
    if (found == std::end(kScanShaders))
        throw Failure(ErrorCode::kInvalidArgument, std::string(name), "no file of src/scan/methods is its shader");
    return *found;
}

}  // namespace throng
