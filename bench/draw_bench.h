// `throng bench draw`: pictures of crowds by this machine's processor, with each of its instruction sets, and by a
// software Vulkan device beside it.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"
#include "native/native.h"

#include <throng/draw.h>

namespace throng::bench {

struct DrawCase {
    std::string configuration;  // its name
    // Of this many characters, placed, and updated as the camera sees them.
    std::function<Crowd(const Device&)> make_crowd;
    std::function<Camera(const Crowd&)> camera_of;
    RendererSettings picture;
    std::vector<NativeIsa> isas;
    std::vector<uint32_t> threads;
    bool against_vulkan = false;  // also draws with a software device of Vulkan
};

// A record for each way to draw (bench/README.md lists their fields). Pictures are compared first: with each number of
// threads the same bytes; with each instruction set, and by Vulkan, what the eye takes for the same. One that is wrong
// is not timed and says so.
std::vector<Json> measure_draw(const DrawCase& drawn, uint32_t samples, const Progress& progress);

}  // namespace throng::bench
