#include "fused/fused.h"

#include "fused/rows_io.h"
#include "fused/fixed_joints.h"
#include "fused/serial_plan.h"
#include "scan/scan_shaders.h"
#include "scan/stream_plan.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace throng {
namespace {

// The method's plan within the shared memory that is left beside the tile of local transforms.
ScanPlan plan_tiled(const ScanChoice& choice, const ScanRig& rig, const ScanLimits& limits) {
    const ScanMethod& method = *choice.method;
    const ScanPlan alone = plan_scan(method, rig, limits, choice.threads);
    if (!alone.unsupported_reason.empty()) return alone;
    const uint64_t tile_bytes = uint64_t{alone.instances_per_workgroup} * rig.joint_count() * bytes_of(method.format);
    const std::string tile = std::to_string(tile_bytes) + " bytes of shared memory for local transforms";
    if (tile_bytes > limits.shared_memory_bytes)
        return {.unsupported_reason = tile + " exceed the device's " + std::to_string(limits.shared_memory_bytes)};
    ScanLimits rest = limits;
    rest.shared_memory_bytes -= static_cast<uint32_t>(tile_bytes);
    ScanPlan plan = plan_scan(method, rig, rest, choice.threads);
    if (!plan.unsupported_reason.empty() || !plan.on_chip)
        return {.unsupported_reason = tile + " and those that " + std::string(method.name) +
                                      " needs exceed the device's " + std::to_string(limits.shared_memory_bytes)};
    return plan;
}

// The loops that make the local transforms come before those of the scan.
std::vector<LoopTrips> with_tile(const ScanPlan& plan, uint32_t joint_count, uint32_t subgroup_size) {
    if (plan.counts.loops.empty()) return {};
    const auto subgroups = [&](double invocations) { return std::ceil(invocations / subgroup_size); };
    const double characters = plan.instances_per_workgroup,
                 strides = subgroups(joint_count) / subgroups(plan.workgroup_size);
    std::vector<LoopTrips> loops{{"characters", characters}, {"local transforms", characters * strides}};
    loops.insert(loops.end(), plan.counts.loops.begin(), plan.counts.loops.end());
    return loops;
}

}  // namespace

FusedRig::FusedRig(const Character& character, uint32_t lod) {
    const uint32_t joint_count = character.rig.joint_count();
    const std::vector<bool> fixed_of_rig = fixed_joints(character);
    std::vector<uint32_t> parents, numbers(joint_count, kNone);
    for (uint32_t joint = 0; joint < joint_count; ++joint) {
        if (lod > 0 && character.joint_lods[joint] < lod) continue;
        numbers[joint] = static_cast<uint32_t>(rig_joints.size());
        const uint32_t parent = character.rig.parents[joint];
        parents.push_back(parent == kNone ? kNone : numbers[parent]);
        rig_joints.push_back(joint);
        fixed.push_back(fixed_of_rig[joint]);
    }
    rig = ScanRig(parents, character.rig.uniform_scale);
    std::vector<uint32_t> binds(joint_count);
    for (const PaletteEntry& entry : character.palette) {
        if (numbers[entry.joint] == kNone) continue;
        ++palette_count;
        max_binds = std::max(max_binds, ++binds[entry.joint]);
    }
}

FusedRig FusedRig::in_stream_order(uint32_t lanes) const {
    FusedRig out = *this;
    std::vector<uint32_t> order, parents(rig.joint_count()), places(rig.joint_count());
    for (const std::vector<uint32_t>& chunk : plan_stream(rig, {.lanes = lanes}).chunks)
        for (const uint32_t joint : chunk)
            if (joint < rig.joint_count()) order.push_back(joint);  // of several characters, only the first
    for (uint32_t place = 0; place < order.size(); ++place) places[order[place]] = place;
    for (uint32_t place = 0; place < order.size(); ++place) {
        const uint32_t parent = rig.parents[order[place]];
        parents[place] = parent == kNone ? kNone : places[parent];
        out.rig_joints[place] = rig_joints[order[place]];
        out.fixed[place] = fixed[order[place]];
    }
    out.rig = ScanRig(parents, rig.uniform_scale);
    return out;
}

FusedPlan plan_fused(const ScanChoice& choice, const FusedRig& rig, const ScanLimits& limits) {
    const ScanMethod& method = *choice.method;
    if (std::string unsupported_reason = threads_unsupported_reason(method, limits, choice.threads);
        !unsupported_reason.empty())
        return {.unsupported_reason = std::move(unsupported_reason)};
    const std::span<const uint32_t> shader = scan_shaders(method.name).fused;
    if (shader.empty()) return {.unsupported_reason = std::string(method.name) + " has no fused form"};
    // Counts tables as storage buffers too. Software devices bind them as texel buffers instead, but none has such a
    // low limit that the difference matters.
    const std::vector<BindingInfo> bindings = read_spirv(shader).bindings;
    if (bindings.size() > limits.storage_buffers)
        return {.unsupported_reason = std::to_string(bindings.size()) +
                                      " storage buffers in one kernel exceed the device's " +
                                      std::to_string(limits.storage_buffers)};
    const bool serial = method.name == "serial", tiled = scan_shaders(method.name).is_tiled;
    FusedPlan plan{.unsupported_reason = {},
                   .choice = choice,
                   .scan = serial  ? plan_fused_serial(rig.rig, rig.fixed, limits)
                           : tiled ? plan_tiled(choice, rig.rig, limits)
                                   : plan_scan(method, rig.rig, limits, choice.threads)};
    plan.unsupported_reason = plan.scan.unsupported_reason;
    plan.tile_transforms = !tiled ? 0 : plan.scan.instances_per_workgroup * rig.rig.joint_count();
    plan.one_bind = rig.max_binds <= 1;
    if (!plan.unsupported_reason.empty()) return plan;
    plan.loops = !tiled ? plan.scan.counts.loops : with_tile(plan.scan, rig.rig.joint_count(), limits.subgroup_size);
    const uint64_t iterations = plan.scan.counts.loop_iterations + 2 * uint64_t{rig.rig.joint_count()} +
                                rig.palette_count;
    if (iterations > limits.loop_iterations)
        plan.unsupported_reason = "up to " + std::to_string(iterations) + " loop iterations exceed the device's " +
                                  std::to_string(limits.loop_iterations);
    return plan;
}

FusedPlan choose_fused(const FusedRig& rig, const ScanLimits& limits, double subgroups_a_character) {
    const FusedNeed need{rig.rig.joint_count(), subgroups_a_character};
    std::multimap<uint32_t, ScanChoice> choices;  // by FusedPlace::order
    for (const ScanMethod& method : scan_table())
        if (const FusedPlace place = method.fused_place(limits, need); place.order > 0)
            choices.emplace(place.order, ScanChoice{&method, place.threads});
    FusedPlan plan{.unsupported_reason = "no scan method has a fused form for this device"};
    for (const auto& [order, choice] : choices) {
        plan = plan_fused(choice, rig, limits);
        if (plan.unsupported_reason.empty()) break;
    }
    return plan;
}

Buffers upload_fused_tables(Uploads& uploads, const Character& character, const FusedRig& rig, const FusedPlan& plan,
                            const FusedBinds* binds) {
    std::vector<std::vector<uint32_t>> entries_of(character.rig.joint_count());
    for (uint32_t entry = 0; entry < character.palette.size(); ++entry)
        entries_of[character.palette[entry].joint].push_back(entry);
    std::vector<uint32_t> ranges{0}, entries;
    for (const uint32_t joint : rig.rig_joints) {
        entries.insert(entries.end(), entries_of[joint].begin(), entries_of[joint].end());
        ranges.push_back(static_cast<uint32_t>(entries.size()));
    }
    std::vector<Affine> sorted;
    for (uint32_t& entry : entries) {
        sorted.push_back(binds ? binds->matrices[entry] : character.palette[entry].joint_from_bind);
        if (binds && binds->is_plain[entry]) entry |= io::kPlainEntry;
    }
    Buffers buffers;
    buffers[io::kScanLinksBuffer] = upload_table(uploads, character.name + ": scan links", plan.scan.links);
    buffers[io::kBindRangesBuffer] = upload_table(uploads, character.name + ": palette entries of joints", ranges);
    buffers[io::kBindEntriesBuffer] = upload_table(uploads, character.name + ": palette entries", entries);
    buffers[io::kBindsBuffer] = upload_table(uploads, character.name + ": inverse binds by joint", sorted);
    buffers[io::kAnimatedJointsBuffer] = upload_table(uploads, character.name + ": animated joints", rig.rig_joints);
    return buffers;
}

Kernel fused_kernel(const std::shared_ptr<Gpu>& gpu, const FusedPlan& plan, const FusedSettings& settings) {
    const ScanShaders& shaders = scan_shaders(plan.choice.method->name);
    const FusedRows& rows = settings.rows;
    const bool has_rows = rows.joint_count > 0, software = gpu->uses_software_kernels();
    const uint32_t tile_instances = plan.tile_transforms > 0 ? plan.scan.instances_per_workgroup : 1;
    std::vector<uint32_t> constants = plan.scan.constants;
    constants.resize(io::kFusedConstants - 1);  // the workgroup size has its own constant, 0
    for (const auto& [id, value] : std::initializer_list<std::pair<uint32_t, uint32_t>>{
             {io::kPackedId, settings.packed},
             {io::kBlendsId, settings.blends},
             {io::kKeepsModelId, settings.keeps_model},
             {io::kSkinFormatId, static_cast<uint32_t>(settings.skin_format)},
             {io::kOneBindId, plan.one_bind},
             {io::kTileInstancesId, tile_instances},
             {io::kTileTransformsId, std::max(plan.tile_transforms, 1u)},
             {io::kLayeredId, settings.layered},
             {io::kSocketCountId, settings.socket_count},
             {io::kInertialId, settings.inertial},
             {io::kPoseOverridesId, settings.pose_overrides},
             {io::kListedId, settings.listed},
             {io::kMapsJointsId, settings.maps_joints},
             {io::kRowJointsId, rows.joint_count},
             {io::kOtherColumnsId, rows.other_columns},
             {io::kFineRotationsId, rows.fine_rotation_count},
             {io::kMotionsId, rows.motion_count},
             {io::kFineMotionsId, rows.fine_motion_count},
             {io::kPlainEntriesId, rows.plain_entries},
             {io::kSkinPoolId, settings.skin_pool}})
        constants[id - 1] = value;
    return Kernel(gpu, {.name = settings.layered  ? "fused, layers"
                                : settings.blends ? "fused, two clips"
                                                  : "fused, one clip",
                        .spirv = has_rows ? (software ? shaders.fused_rows_software : shaders.fused_rows)
                                          : (software ? shaders.fused_software : shaders.fused),
                        .workgroup_size = plan.scan.workgroup_size,
                        .constants = std::move(constants),
                        .subgroup_size = plan.scan.subgroup_size,
                        .full_subgroups = plan.scan.full_subgroups});
}

void record_fused(VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings, const FusedPlan& plan,
                  const io::FusedPush& push) {
    kernel.dispatch_workgroups(
        commands, bindings, push,
        (push.instance_count + plan.scan.instances_per_workgroup - 1) / plan.scan.instances_per_workgroup);
}

}  // namespace throng
