#include "steer/steer.h"

namespace throng {
namespace {

constexpr uint32_t kPlaces[] = {
#include "steer/places.comp.inc"
};
constexpr uint32_t kSteer[] = {
#include "steer/steer.comp.inc"
};
constexpr uint32_t kSteerSoftware[] = {
#include "steer/steer.software.inc"
};

}  // namespace

SteerKernels::SteerKernels(const std::shared_ptr<Gpu>& gpu)
    : places(gpu, {.name = "places", .spirv = kPlaces}),
      steer(gpu, {.name = "steer",
                  .spirv = gpu->uses_software_kernels() ? std::span<const uint32_t>(kSteerSoftware) : kSteer}) {}

}  // namespace throng
