// One character of a crowd, uploaded: what all of its instances share.
#pragma once

#include "gpu/kernel.h"
#include "scan/scan_planner.h"

#include <throng/character.h>

namespace throng {

struct Group {
    Group(const std::shared_ptr<Gpu>& gpu, const Character& character, const ExplainedChoice& explained);

    std::string name;
    uint32_t joint_count = 0;
    uint32_t palette_count = 0;
    uint32_t vertex_count = 0;
    std::vector<float> clip_durations_s;
    std::vector<MeshSection> sections;
    std::vector<AssetMaterial> materials;
    std::vector<AssetImage> images;
    Vec3<float> bounds_min, bounds_max;

    Buffer axes, times;                    // control
    Buffer tracks, keys;                   // sample
    ScanStage scan;
    std::string scan_reason;
    Buffer palette_joints, joint_from_bind;  // bind
    Buffer vertices, influences, indices;  // skin, draw

    uint64_t size_bytes() const;
};

}  // namespace throng
