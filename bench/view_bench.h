// `throng bench view`: updates of a crowd for a view, which skip work that the view does not need. Each is checked
// against the reference and then timed in turns with an update of everything.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"

#include <throng/draw.h>

namespace throng::bench {

struct ViewCase {
    std::string configuration;  // its name
    const Character* character = nullptr;
    std::span<const Playback> playback;  // [instance_count]
    std::span<const Affine> placement;   // [instance_count]
    UpdatePath path = UpdatePath::kAuto;
    // What the camera sees of a crowd with these bounds, in the world; its full_rate_pixels are for the variant that
    // skips updates
    std::function<CrowdView(const Bounds&)> view_of;
};

// A record for each variant (bench/README.md lists their fields). A wrong variant is not timed, and its record says so;
// if the device cannot hold a variant, its record says why. Throws if the device fails.
std::vector<Json> measure_view(const Device& device, const ViewCase& seen, uint32_t samples, const Progress& progress);

}  // namespace throng::bench
