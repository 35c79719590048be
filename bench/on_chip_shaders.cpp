#include "bench/on_chip_shaders.h"

#include "base/failure.h"

#include <algorithm>

namespace throng::bench {
namespace {

#include "scan/on_chip_rows.inc"

}  // namespace

const OnChipShaders& on_chip_shaders(std::string_view name) {
    const auto found = std::ranges::find(kOnChipShaders, name, &OnChipShaders::name);
    if (found == std::end(kOnChipShaders))
        throw Failure(ErrorCode::kInvalidArgument, std::string(name), "src/scan/methods has no shader with this name");
    return *found;
}

}  // namespace throng::bench
