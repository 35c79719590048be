#include "draw/crowd_bindings.h"

#include "draw/draw_io.h"
#include "draw/pipeline.h"

namespace throng {
namespace {

std::vector<io::JointLevel> levels_of(const std::vector<uint32_t>& parents) {
    std::vector<io::JointLevel> levels;
    for (const uint32_t parent : parents) levels.push_back({parent, parent == kNone ? 0 : levels[parent].level + 1});
    return levels;
}

}  // namespace

CrowdBindings::CrowdBindings(const ShaderLayout& layout, const MaterialSampling& sampling, const CrowdState& crowd)
    : life_(crowd.life), joint_levels_(crowd.groups.size()) {
    Uploads uploads(crowd.gpu);
    TextureAccount textures{warnings};
    const bool has_skeletons = static_cast<bool>(crowd.batches.front()[io::kModelBuffer]);
    for (size_t g = 0; g < crowd.groups.size(); ++g) {
        const Group& group = crowd.groups[g];
        materials.emplace_back(uploads, group, layout.set(kMaterialSet), sampling, textures);
        if (has_skeletons)
            joint_levels_[g] = upload(uploads, group.name + ": levels of joints", levels_of(group.parents));
    }
    uploads.finish();
    for (const Batch& batch : crowd.batches) {
        const Group& group = crowd.groups[batch.group];
        const BufferTable table =
            batch.table(group, group[io::kVerticesBuffer]).set({{io::kJointLevelsBuffer, joint_levels_[batch.group]}});
        std::array<Bindings, 2>& of_batch = batches_.emplace_back();
        for (size_t skin = 0; skin < 2; ++skin)
            if (batch.skins[skin])
                of_batch[skin] = Bindings(crowd.gpu, group.name, layout.set(kBatchSet),
                                          table.with({{io::kSkinBuffer, batch.skins[skin]}}));
    }
}

const CrowdBindings& CrowdBindingsCache::of(const ShaderLayout& layout, const MaterialSampling& sampling,
                                            const CrowdState& crowd) {
    std::erase_if(entries_, [](const auto& entry) { return entry->is_of_none(); });
    for (const auto& entry : entries_)
        if (entry->is_of(crowd)) return *entry;
    return *entries_.emplace_back(std::make_unique<CrowdBindings>(layout, sampling, crowd));
}

}  // namespace throng
