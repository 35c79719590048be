#include "steer/steer.h"

namespace throng {
namespace {

constexpr uint32_t kPlaces[] = {
#include "steer/places.comp.inc"
};
constexpr uint32_t kSteer[] = {
#include "steer/steer.comp.inc"
};
constexpr uint32_t kSteerWide[] = {
#include "steer/steer.wide.inc"
};

}  // namespace

SteerKernels::SteerKernels(const std::shared_ptr<Gpu>& gpu)
    : places(gpu, {.name = "places", .spirv = kPlaces}),
      steer(gpu,
            {.name = "steer", .spirv = gpu->prefers_wide_words() ? std::span<const uint32_t>(kSteerWide) : kSteer}) {}

}  // namespace throng
