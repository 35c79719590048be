#include "draw/crowd_bindings.h"

namespace throng {
namespace {

// Of each joint its parent, or kNone, and its level.
std::vector<std::array<uint32_t, 2>> levels_of(const std::vector<uint32_t>& parents) {
    std::vector<std::array<uint32_t, 2>> levels;
    for (const uint32_t parent : parents) levels.push_back({parent, parent == kNone ? 0 : levels[parent][1] + 1});
    return levels;
}

}  // namespace

CrowdBindings::CrowdBindings(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts,
                             const MaterialSampling& sampling, const CrowdState& crowd)
    : life_(crowd.life) {
    Uploads uploads(gpu);
    TextureAccount textures{warnings};
    for (const Group& group : crowd.groups)
        materials.emplace_back(uploads, group, layouts.material_set.get(), sampling, textures);
    const bool has_skeletons = crowd.batches.front()[io::kModelBuffer].handle();
    if (has_skeletons)
        for (const Group& group : crowd.groups)
            joint_parents_.push_back(
                upload(uploads, group.name + ": parents and levels of joints", levels_of(group.parents)));
    uploads.finish();
    for (const Batch& batch : crowd.batches) {
        const Group& group = crowd.groups[batch.group];
        std::array<Bindings, 2>& of_batch = batches_.emplace_back();
        for (size_t skin = 0; skin < 2; ++skin) {
            if (!batch.skins[skin].handle()) continue;
            of_batch[skin] = Bindings(gpu, layouts.batch_set.get(), group.name, kBatchBindings,
                                      {{0, group[io::kVerticesBuffer]},
                                       {1, group[io::kInfluencesBuffer]},
                                       {2, batch[io::kSkinnedBuffer].or_else(batch.skins[skin])},
                                       {3, batch[io::kPlacementsBuffer]},
                                       {4, group[io::kMorphDeltasBuffer].or_else(group[io::kVerticesBuffer])},
                                       {5, batch[io::kActiveMorphsBuffer].or_else(group[io::kVerticesBuffer])},
                                       {6, batch[io::kListBuffer].or_else(group[io::kVerticesBuffer])}});
        }
    }
    if (!has_skeletons) return;
    for (const Batch& batch : crowd.batches) {
        const Buffer& parents = joint_parents_[batch.group];
        skeletons_.emplace_back(gpu, layouts.batch_set.get(), crowd.groups[batch.group].name, kBatchBindings,
                                BufferTable{{0, parents},
                                            {1, parents},
                                            {2, batch[io::kModelBuffer]},
                                            {3, batch[io::kPlacementsBuffer]},
                                            {4, parents},
                                            {5, parents},
                                            {6, batch[io::kListBuffer].or_else(parents)}});
    }
}

const CrowdBindings& CrowdBindingsCache::of(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts,
                                            const MaterialSampling& sampling, const CrowdState& crowd) {
    std::erase_if(entries_, [](const auto& entry) { return entry->is_of_none(); });
    for (const auto& entry : entries_)
        if (entry->is_of(crowd)) return *entry;
    return *entries_.emplace_back(std::make_unique<CrowdBindings>(gpu, layouts, sampling, crowd));
}

}  // namespace throng
