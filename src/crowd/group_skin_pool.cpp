#include "crowd/group_skin_pool.h"

#include "base/failure.h"
#include "compile/limits.h"
#include "crowd/staged_update.h"
#include "native/native.h"
#include "native/shared_poses.h"

#include <algorithm>

namespace throng {
namespace {

// Why a group cannot have a skin pool; empty if it can.
std::string unsupported_reason(const Group& group, const Character& character, const CrowdSettings& settings) {
    if (group.fused.empty()) return "the group is updated stage by stage";
    if (group.sockets) return "sockets are computed for all instances, not only for those that are drawn";
    if (group.controller && group.controller->is_inertial)
        return "inertial transitions need the poses of all instances, not only of those that are drawn";
    if (group.pose_capacity > 0) return "CrowdGroup::pose_capacity is set";
    if (settings.keep_model_matrices) return "CrowdSettings::keep_model_matrices is set";
    if (settings.keep_previous_matrices) return "CrowdSettings::keep_previous_matrices is set";
    if (settings.culling->skips_updates) return "Culling::skips_updates is set";
    if (settings.skins_once) return "CrowdSettings::skins_once is set";
    if (character.vertices.empty()) return "the character has no mesh, which the errors of shared poses depend on";
    if (const std::string reason = native_unsupported_reason(character, settings.skin_format); !reason.empty())
        return "its shared poses are computed natively, and " + reason;
    return {};
}

uint64_t row_bytes(const Group& group, SkinFormat format) {
    return uint64_t{std::max(group.palette_count, 1u)} * skin_format_bytes(format);
}

}  // namespace

GroupSkinPool make_skin_pool(Uploads& uploads, SharedRigs& rigs, Group& group, const CrowdGroup& made_of,
                             const CrowdSettings& settings) {
    const std::string place = group.name + ": skin pool";
    const Character& character = *made_of.character;
    const SkinPool& pool = *made_of.skin_pool;
    if (const std::string reason = unsupported_reason(group, character, settings); !reason.empty())
        throw Failure(ErrorCode::kUnsupported, place, reason);
    constexpr float kMaxPoses_per_s = 1000;
    if (pool.capacity == 0 || !(pool.shared_poses_per_s > 0 && pool.shared_poses_per_s <= kMaxPoses_per_s))
        throw Failure(ErrorCode::kInvalidArgument, place,
                      "capacity and shared_poses_per_s must be above 0, and the second at most 1000");
    const uint64_t shared_count = shared_pose_count(character, pool.shared_poses_per_s),
                   rows = shared_count + std::min(pool.capacity, made_of.instance_count),
                   max_rows = arena_limit_bytes(*uploads.gpu()) / row_bytes(group, settings.skin_format);
    if (rows > max_rows)
        throw Failure(ErrorCode::kLimit, place,
                      std::to_string(rows) + " rows, including those of shared poses; at most " +
                          std::to_string(max_rows) + " fit in one buffer (of this device, and of at most 256 MiB)");
    if (shared_count * character.rig.joint_count() > kPackingLimit)
        throw Failure(ErrorCode::kLimit, place, shared_count, " shared poses of a character with ",
                      character.rig.joint_count(), " joints; poses times joints are at most ", kPackingLimit,
                      ": set a smaller shared_poses_per_s");
    if (const uint32_t most = uploads.gpu()->properties.limits.maxComputeWorkGroupCount[0];
        std::min(pool.capacity, made_of.instance_count) > most)
        throw Failure(ErrorCode::kLimit, place,
                      "a capacity of " + std::to_string(pool.capacity) + "; the device dispatches " +
                          std::to_string(most) + " workgroups at most");
    SharedPoses shared = make_shared_poses(character, *rigs.native(character, {}), settings.skin_format,
                                           pool.shared_poses_per_s);
    group.buffers[io::kSharedClipsBuffer] = upload(uploads, group.name + ": shared clips", shared.clips);
    return {.capacity = std::min(pool.capacity, made_of.instance_count),
            .shared_row_count = shared.row_count,
            .pose_spread = shared.spread,
            .shared_skin = std::move(shared.skin)};
}

void plan_skin_pool(BatchPlan& plan) {
    const GroupSkinPool& pool = *plan.group().skin_pool;
    const uint64_t bytes = row_bytes(plan.group(), plan.settings().skin_format);
    plan.add_of_batch(io::kSkinBuffer, (uint64_t{pool.shared_row_count} + pool.capacity) * bytes,
                      [&pool, bytes](Uploads& uploads, const std::string& what, uint64_t n) {
                          const uint64_t rows = pool.shared_row_count +
                                                uint64_t{pool.row_count(static_cast<uint32_t>(n))};
                          Buffer skin(uploads.gpu(), what, rows * bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
                          uploads.add(skin, pool.shared_skin);
                          return skin;
                      });
    plan.add(io::kSkinRowsBuffer, sizeof(uint32_t), [](Uploads& uploads, const std::string& what, uint64_t n) {
        return fill_table(uploads, what, std::vector<uint32_t>(1), n);
    });
}

}  // namespace throng
