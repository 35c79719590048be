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
        const BufferTable table =
            batch.table(group, group[io::kVerticesBuffer]).set({{io::kJointLevelsBuffer, joint_levels_[batch.group]}});
        std::array<Bindings, 2>& of_batch = batches_.emplace_back();
        for (size_t skin = 0; skin < 2; ++skin)
            if (batch.skins[skin])
                of_batch[skin] = Bindings(crowd.gpu, group.name, layout.set(kBatchSet),
                                          table.with({{io::kSkinBuffer, batch.skins[skin]}}));
    }
}

}  // namespace throng
