#include "crowd/group_rows.h"

#include <algorithm>
#include <functional>
#include <optional>

namespace throng {
namespace {

std::vector<native::RowJoint> joints_of(const native::RowSpaces& spaces, const FusedRig& finest) {
    std::vector<native::RowJoint> joints;
    for (const uint32_t joint : finest.rig_joints) joints.push_back(spaces.of_joints[joint]);
    return joints;
}

std::optional<GpuRows> rows_of(const Gpu& gpu, const Character& character, const native::RowSpaces& spaces,
                               const FusedRig& finest) {
    constexpr uint64_t kMaxRows_bytes = uint64_t{1} << 30;  // which are made in host memory first
    return make_gpu_rows(
        character, joints_of(spaces, finest),
        std::min({kMaxRows_bytes, uint64_t{gpu.properties.limits.maxStorageBufferRange}, gpu.max_allocation_bytes}));
}

}  // namespace

GroupRows::GroupRows(const Character& character, const native::RowSpaces& spaces, const FusedRig& finest,
                     const GpuRows& rows)
    : columns_(character.rig.joint_count()) {
    for (const uint32_t joint : finest.rig_joints) columns_[joint] = counts_.joint_count++;
    for (const PaletteEntry& entry : character.palette) {
        const AffineT<double> bind = native::to_affine(spaces.of_joints[entry.joint].joint_space) *
                                     entry.joint_from_bind.as<double>();
        binds_.matrices.push_back(bind.as<float>());
        binds_.is_plain.push_back(native::is_identity(bind, character.size));
    }
    counts_.fine_rotation_count = rows.fine_rotation_count;
    counts_.motion_count = rows.motion_count;
    counts_.fine_motion_count = rows.fine_motion_count;
    counts_.plain_entries = std::ranges::all_of(binds_.is_plain, std::identity());
}

// Buffers are shared by the same key. If another crowd has the rows but has not uploaded them yet, its buffers must not
// be used, so they are computed again.
std::shared_ptr<const GroupRows> GroupRows::make(Uploads& uploads, SharedRigs& rigs, const Character& character,
                                                 const FusedRig& finest, Buffers& buffers) {
    Gpu& gpu = *uploads.gpu();
    SharedValues::Key key = rigs.key_of(SharedValue::kGroupRows, character);
    key.insert(key.end(), finest.rig_joints.begin(), finest.rig_joints.end());
    std::optional<GpuRows> rows;
    std::shared_ptr<const GroupRows> out = gpu.values.find<GroupRows>(key);
    if (!out) {
        const native::RowSpaces spaces(character, false);
        if (spaces.uniform_scale) rows = rows_of(gpu, character, spaces, finest);
        if (!rows) return nullptr;
        out = gpu.values.add(key, std::make_shared<const GroupRows>(character, spaces, finest, *rows));
    }
    const auto share = [&](uint32_t number, const char* what, auto GpuRows::*member) {
        key.push_back(number);
        const auto buffer_key = SharedBuffers::key_of(std::as_bytes(std::span(key)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                                                      0);
        key.pop_back();
        buffers[number] = uploads.share(buffer_key, [&] {
            if (!rows) rows = rows_of(gpu, character, native::RowSpaces(character, false), finest);
            return upload(uploads, character.name + what, (*rows).*member);
        });
    };
    share(io::kRowsBuffer, ": rows", &GpuRows::rows);
    share(io::kRowJointsBuffer, ": joints of rows", &GpuRows::joints);
    share(io::kRowPlacesBuffer, ": places of rows", &GpuRows::places);
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
