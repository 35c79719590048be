// One character of a crowd, uploaded: what all of its instances share.
#pragma once

#include "crowd/path.h"
#include "gpu/kernel.h"

#include <throng/character.h>

namespace throng {

// What a group that is updated in one pass has beside its clips.
struct FusedGroup {
    FusedPlan plan;
    FusedTables tables;
};

struct Group {
    Group(const std::shared_ptr<Gpu>& gpu, const Character& character, const PathChoice& choice);

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
    bool packed = false;
    Buffer tracks, keys, words;            // sample
    ScanChoice scan_choice;
    std::string scan_reason, path_reason;
    std::optional<ScanStage> scan;         // where staged
    std::optional<FusedGroup> fused;       // where fused
    Buffer palette_joints, joint_from_bind;  // bind
    Buffer vertices, influences, indices;  // skin, draw

    bool takes_similarities() const { return scan_choice.method->format == ScanFormat::kSimilarity; }
    uint64_t size_bytes() const;
};

}  // namespace throng
