#include "crowd/group_rows.h"

#include "native/gpu_rows.h"

#include <algorithm>
#include <functional>

namespace throng {

std::optional<GroupRows> GroupRows::make(Uploads& uploads, const Character& character, const FusedRig& finest,
                                         Buffers& buffers) {
    const native::RowSpaces spaces(character, false);
    if (!spaces.uniform_scale) return std::nullopt;
    GroupRows out;
    out.columns_.resize(character.rig.joint_count());
    std::vector<native::RowJoint> joints;
    for (const uint32_t joint : finest.rig_joints) {
        out.columns_[joint] = static_cast<uint32_t>(joints.size());
        joints.push_back(spaces.of_joints[joint]);
    }
    for (const PaletteEntry& entry : character.palette) {
        const AffineT<double> bind = native::to_affine(spaces.of_joints[entry.joint].joint_space) *
                                     entry.joint_from_bind.as<double>();
        out.binds_.matrices.push_back(bind.as<float>());
        out.binds_.is_plain.push_back(native::is_identity(bind, character.size));
    }
    constexpr uint64_t kMostRows_bytes = uint64_t{1} << 30;  // which are made in host memory first
    const Gpu& gpu = *uploads.gpu();
    const std::optional<GpuRows> made = make_gpu_rows(
        character, joints,
        std::min({kMostRows_bytes, uint64_t{gpu.properties.limits.maxStorageBufferRange}, gpu.max_allocation_bytes}));
    if (!made) return std::nullopt;
    const GpuRows& rows = *made;
    out.counts_ = {.joint_count = static_cast<uint32_t>(joints.size()),
                   .fine_rotation_count = rows.fine_rotation_count,
                   .motion_count = rows.motion_count,
                   .fine_motion_count = rows.fine_motion_count,
                   .plain_entries = std::ranges::all_of(out.binds_.is_plain, std::identity())};
    buffers[io::kRowsBuffer] = upload(uploads, character.name + ": rows", rows.rows);
    buffers[io::kRowJointsBuffer] = upload(uploads, character.name + ": joints of rows", rows.joints);
    buffers[io::kRowPlacesBuffer] = upload(uploads, character.name + ": places of rows", rows.places);
    return out;
}

Buffers GroupRows::upload_tables(Uploads& uploads, const Character& character, const FusedRig& rig,
                                 const FusedPlan& plan) const {
    Buffers tables = upload_fused_tables(uploads, character, rig, plan, &binds_);
    std::vector<uint32_t> columns;
    for (const uint32_t joint : rig.rig_joints) columns.push_back(columns_[joint]);
    tables[io::kRowColumnsBuffer] = upload(uploads, character.name + ": columns of rows", columns);
    return tables;
}

FusedRows GroupRows::of_set(uint32_t set) const {
    FusedRows rows = counts_;
    rows.other_columns = set > 0;
    return rows;
}

}  // namespace throng
