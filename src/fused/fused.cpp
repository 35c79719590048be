#include "fused/fused.h"

#include "base/failure.h"
#include "scan/scan_shaders.h"

#include <algorithm>

namespace throng {
namespace {

uint64_t tile_transforms(const ScanPlan& plan, uint32_t joint_count) { return uint64_t{plan.instances_per_workgroup} * joint_count; }

uint64_t tile_bytes(const ScanPlan& plan, const ScanMethod& method, uint32_t joint_count) {
    return tile_transforms(plan, joint_count) * (method.format == ScanFormat::kSimilarity ? 32 : 48);
}

}  // namespace

FusedPlan plan_fused(const ScanChoice& choice, const ScanRig& rig, const ScanLimits& limits, uint32_t palette_count) {
    const ScanMethod& method = *choice.method;
    if (scan_shaders(method.name).fused.empty()) return {.obstacle = std::string(method.name) + " has no fused form"};
    FusedPlan plan{.obstacle = {}, .choice = choice, .scan = plan_scan(method, rig, limits, choice.lanes)};
    plan.tiled = !plan.scan.loads_once;
    if (plan.scan.obstacle.empty() && plan.tiled) {
        const uint64_t bytes = tile_bytes(plan.scan, method, rig.joint_count());
        if (bytes > limits.shared_memory_bytes)
            return {.obstacle = std::to_string(bytes) + " bytes of shared memory for local transforms exceed the device's " + std::to_string(limits.shared_memory_bytes)};
        ScanLimits rest = limits;
        rest.shared_memory_bytes -= static_cast<uint32_t>(bytes);
        plan.scan = plan_scan(method, rig, rest, choice.lanes);
        if (plan.scan.obstacle.empty() && !plan.scan.on_chip)
            return {.obstacle = std::string(method.name) + " and " + std::to_string(bytes) + " bytes of local transforms together exceed the device's shared memory of " + std::to_string(limits.shared_memory_bytes)};
    }
    plan.obstacle = plan.scan.obstacle;
    const uint64_t iterations = plan.scan.counts.loop_iterations + 2 * uint64_t{rig.joint_count()} + palette_count;
    if (plan.obstacle.empty() && iterations > limits.loop_iterations)
        plan.obstacle = "up to " + std::to_string(iterations) + " loop iterations exceed the device's " + std::to_string(limits.loop_iterations);
    return plan;
}

FusedPlan choose_fused(const ScanRig& rig, const ScanLimits& limits, uint32_t palette_count, uint32_t instance_count) {
    std::vector<ScanChoice> choices;
    const auto add = [&](std::string_view name, uint32_t lanes) { choices.push_back({find_scan_method(name), lanes}); };
    if (limits.is_cpu) {
        // A character an invocation leaves no lane idle once there is one for each lane of each core.
        const uint32_t busy = 2 * limits.subgroup_size;
        uint32_t lanes = 1;
        while (lanes < limits.subgroup_size && instance_count * lanes < busy) lanes *= 2;
        for (; lanes > 1; lanes /= 2) add("subgroup", lanes);
        add("subgroup", 1);
    } else {
        const uint32_t lanes = std::min(32u, limits.subgroup_size);
        if (rig.uniform_scale) add("subgroup_quaternion", lanes);
        add("subgroup", lanes);
        add("fragments", 32);
    }
    FusedPlan plan;
    for (const ScanChoice& choice : choices) {
        plan = plan_fused(choice, rig, limits, palette_count);
        if (plan.obstacle.empty()) break;
    }
    return plan;
}

FusedTables::FusedTables(const std::shared_ptr<Gpu>& gpu, const Character& character, const FusedPlan& plan) {
    const uint32_t joint_count = character.rig.joint_count(), palette_count = static_cast<uint32_t>(character.palette.size());
    std::vector<uint32_t> ranges(joint_count + 1), entries(palette_count);
    for (uint32_t entry = 0; entry < palette_count; ++entry) {
        entries[entry] = entry;
        ++ranges[character.palette[entry].joint + 1];
    }
    for (uint32_t joint = 0; joint < joint_count; ++joint) ranges[joint + 1] += ranges[joint];
    std::stable_sort(entries.begin(), entries.end(), [&](uint32_t a, uint32_t b) { return character.palette[a].joint < character.palette[b].joint; });
    std::vector<Affine> sorted;
    for (const uint32_t entry : entries) sorted.push_back(character.palette[entry].joint_from_bind);
    links = upload_table(gpu, character.name + ": scan links", plan.scan.links);
    bind_ranges = upload_table(gpu, character.name + ": palette entries of joints", ranges);
    bind_entries = upload_table(gpu, character.name + ": palette entries", entries);
    binds = upload_table(gpu, character.name + ": inverse binds by joint", sorted);
}

Kernel fused_kernel(const std::shared_ptr<Gpu>& gpu, const FusedPlan& plan, uint32_t joint_count, const FusedSettings& settings) {
    const ScanShaders& shaders = scan_shaders(plan.choice.method->name);
    const bool wide = gpu->prefers_wide_words();
    constexpr size_t kMethodConstants = 7;
    std::vector<uint32_t> constants = plan.scan.constants;
    constants.resize(kMethodConstants);
    for (const uint32_t value : {uint32_t{settings.packed}, uint32_t{settings.blends}, uint32_t{settings.keeps_model}, static_cast<uint32_t>(settings.skin_format), plan.tiled ? plan.scan.instances_per_workgroup : 1,
                                 plan.tiled ? static_cast<uint32_t>(tile_transforms(plan.scan, joint_count)) : 1})
        constants.push_back(value);
    return Kernel(gpu, {.name = "fused",
                        .spirv = plan.tiled ? (wide ? shaders.tiled_wide : shaders.tiled) : (wide ? shaders.fused_wide : shaders.fused),
                        .workgroup_size = plan.scan.workgroup_size,
                        .constants = std::move(constants),
                        .full_subgroups = plan.scan.full_subgroups});
}

void record_fused(VkCommandBuffer commands, const Kernel& kernel, const Bindings& bindings, const FusedPlan& plan, const io::FusedPush& push) {
    kernel.dispatch_workgroups(commands, bindings, push, (push.instance_count + plan.scan.instances_per_workgroup - 1) / plan.scan.instances_per_workgroup);
}

}  // namespace throng
