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
    const bool has_skeletons = crowd.batches.front().kept_model.handle();
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
            const std::array<BufferRange, kBatchBindings.size()> ranges{
                group.vertices,
                group.influences,
                batch.skinned.handle() ? batch.skinned : batch.skins[skin],
                batch.placements,
                group.morphs ? group.morphs->deltas : group.vertices,
                batch.morphs.or_else(group.vertices),
                batch.list.or_else(group.vertices)};
            of_batch[skin] = Bindings(gpu, layouts.batch_set.get(), group.name, kBatchBindings, ranges);
        }
    }
    if (!has_skeletons) return;
    for (const Batch& batch : crowd.batches) {
        const Buffer& parents = joint_parents_[batch.group];
        const std::array<BufferRange, kBatchBindings.size()> ranges{
            parents, parents, batch.kept_model, batch.placements, parents, parents, batch.list.or_else(parents)};
        skeletons_.emplace_back(gpu, layouts.batch_set.get(), crowd.groups[batch.group].name, kBatchBindings, ranges);
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
