// `throng bench million`: what a frame of very many characters costs when a camera sees some of them: time as a
// function of what is drawn, memory, the number of distinct poses, the CPU's part, and how long GPUs would take.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"

#include <throng/crowd.h>
#include <throng/draw.h>

#include <span>
#include <string>
#include <vector>

namespace throng::bench {

struct MillionCase {
    std::string configuration;  // its name
    const Character* character = nullptr;
    std::span<const Playback> playback;  // [instance_count]
    std::span<const Affine> placement;   // [instance_count]
    UpdatePath path = UpdatePath::kAuto;
    SkinPool pool;
    uint32_t width = 1280, height = 720;  // of the picture
    float shared_pose_pixels = 1;
};

// A record for each camera, from one that sees a handful of characters to one that sees all. On a Vulkan device also
// one for each number of characters up to all, with the CPU time that recording takes; and, if AMD's compiler is
// installed, a predicted one for each GPU and camera (bench/README.md lists their fields). Throws if the device fails
// before the cameras are timed.
std::vector<Json> measure_million(const Device& device, const MillionCase& million, uint32_t samples,
                                  const Progress& progress);

}  // namespace throng::bench
