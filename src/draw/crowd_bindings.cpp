#include "draw/crowd_bindings.h"

#include "draw/joint_levels.h"
#include "draw/pipeline.h"

namespace throng {
CrowdBindings::CrowdBindings(const ShaderLayout& layout, const MaterialSampling& sampling, const CrowdState& crowd)
    : joint_levels_(crowd.groups.size()) {
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
        std::vector<Bindings>& of_batch = batches_.emplace_back();
        for (uint32_t slot = 0; slot < batch.skins.size(); ++slot)
            of_batch.emplace_back(crowd.gpu, group.name, layout.set(kBatchSet),
                                  batch.shown_table(group, group[io::kVerticesBuffer], slot)
                                      .set({{io::kJointLevelsBuffer, joint_levels_[batch.group]}}));
    }
}

}  // namespace throng
