#include "draw/crowd_bindings.h"

namespace throng {

CrowdBindings::CrowdBindings(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, const MaterialSampling& sampling, const CrowdState& crowd) : life_(crowd.life) {
    for (const Group& group : crowd.groups) materials.emplace_back(gpu, group, layouts.material_set.get(), sampling, warnings);
    for (const Batch& batch : crowd.batches) {
        const Group& group = crowd.groups[batch.group];
        std::array<Bindings, 2>& of_batch = batches_.emplace_back();
        for (size_t skin = 0; skin < 2; ++skin) {
            if (!batch.skins[skin].handle()) continue;
            const std::array<BufferRange, kBatchBindings.size()> ranges{group.vertices, group.influences, batch.skins[skin], batch.placements,
                                                                        group.morphs ? group.morphs->deltas : group.vertices, batch.morphs.or_else(group.vertices), batch.list.or_else(group.vertices)};
            of_batch[skin] = Bindings(gpu, layouts.batch_set.get(), group.name, kBatchBindings, ranges);
        }
    }
}

const CrowdBindings& CrowdBindingsCache::of(const std::shared_ptr<Gpu>& gpu, const DrawLayouts& layouts, const MaterialSampling& sampling, const CrowdState& crowd) {
    std::erase_if(entries_, [](const auto& entry) { return entry->is_of_none(); });
    for (const auto& entry : entries_)
        if (entry->is_of(crowd)) return *entry;
    return *entries_.emplace_back(std::make_unique<CrowdBindings>(gpu, layouts, sampling, crowd));
}

}  // namespace throng
