// `throng bench draw`: pictures of crowds drawn by this machine's processor, with each of its instruction sets, and by
// a Vulkan device for comparison.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"
#include "native/native.h"

#include <throng/draw.h>

#include <optional>
#include <string>

namespace throng::bench {

struct DrawCase {
    std::string configuration;  // a name for what is drawn
    // Makes the crowd on the device, with its characters in their places, and updates it for what the camera sees.
    std::function<Crowd(const Device&)> make_crowd;
    std::function<Camera(const Crowd&)> camera_of;
    RendererSettings picture;
    std::vector<NativeIsa> isas;
    std::vector<uint32_t> threads;
    std::optional<std::string> vulkan_device;  // also draws with this device, for comparison
};

// A record for each way to draw (bench/README.md lists their fields). Pictures are compared first: different numbers of
// threads must give the same bytes, different instruction sets and Vulkan must give pictures that look the same. A way
// whose picture is wrong is not timed, and its record says so.
std::vector<Json> measure_draw(const DrawCase& drawn, uint32_t samples, const Progress& progress);

}  // namespace throng::bench
