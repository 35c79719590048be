#include "draw/group_bindings.h"

#include "draw/joint_levels.h"
#include "draw/pipeline.h"

namespace throng {
namespace {

GroupMaterials make_materials(Uploads& uploads, const Group& group, const ShaderLayout& layout,
                              const MaterialSampling& sampling, TextureAccount account) {
    return {uploads, group, layout.set(kMaterialSet), sampling, account};
}

}  // namespace

GroupBindings::GroupBindings(Uploads& uploads, const ShaderLayout& layout, const MaterialSampling& sampling,
                             const CrowdState& crowd, uint32_t group_index, uint64_t& room_bytes,
                             SharedValues& textures)
    : materials(
          make_materials(uploads, crowd.groups[group_index], layout, sampling, {warnings, room_bytes, textures})) {
    const Group& group = crowd.groups[group_index];
    for (const Batch& batch : crowd.batches) {
        if (batch.group != group_index) continue;
        if (batch[io::kModelBuffer] && !joint_levels_)
            joint_levels_ = upload(uploads, group.name + ": levels of joints", levels_of(group.parents));
        std::vector<Bindings>& of_batch = batches_.emplace_back();
        for (uint32_t slot = 0; slot < batch.skins.size(); ++slot)
            of_batch.emplace_back(crowd.gpu, group.name, layout.set(kBatchSet),
                                  batch.shown_table(group, group[io::kVerticesBuffer], slot)
                                      .set({{io::kJointLevelsBuffer, joint_levels_}}));
    }
}

}  // namespace throng
