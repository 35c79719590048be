// The methods of the Hierarchy-Scan: one row each, in src/scan/methods. Tests, benchmark, planner and command line loop
// over this table.
#pragma once

#include "scan/line_style.h"
#include "scan/scan_counts.h"
#include "scan/scan_flow.h"
#include "scan/scan_rig.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

// What a device offers that a method may need.
struct ScanLimits {
    uint32_t shared_memory_bytes = 0;
    uint32_t workgroup_size = 0;         // largest
    uint32_t subgroup_size = 0;          // smallest that the device may choose
    uint32_t largest_subgroup_size = 0;  // that a kernel can ask for; 0: it cannot, and the driver chooses
    bool shuffle = false;                // subgroups can exchange registers
    bool is_cpu = false;
    // Iterations of an invocation, all loops together, after which the device silently ends them
    uint32_t loop_iterations = 0xFFFFFFFF;
    uint32_t storage_buffers = 0xFFFFFFFF;  // that one kernel can bind
};

// How a method is applied to one skeleton on one device.
struct ScanPlan {
    std::string unsupported_reason;  // why the method does not apply; empty if it does
    uint32_t workgroup_size = 0;
    uint32_t instances_per_workgroup = 1;
    std::vector<uint32_t> constants = {};  // specialization constants 1, 2, …, at most 7
    std::vector<uint32_t> links = {};      // the method's own table of the skeleton
    uint32_t subgroup_size = 0;            // that it asks for; 0: any
    bool full_subgroups = false;           // it relies on subgroups without idle invocations
    // Nothing but local and model passes through memory, so that the on-chip variant runs
    bool on_chip = false;
    ScanCounts counts = {};
};

enum class ScanOrigin { kPaper, kBaseline, kOurs };  // named by the paper; what it argues against; throng's own
// [instance][joint], as all other stages have it; [joint][instance]
enum class ScanLayout { kCharacterMajor, kTransposed };
enum class ScanFormat { kAffine, kSimilarity };  // of local transforms
constexpr uint32_t bytes_of(ScanFormat format) { return format == ScanFormat::kSimilarity ? 32 : 48; }

// The place of a method's fused form among those that an update tries, the lowest order first.
struct FusedPlace {
    uint32_t order = 0;    // 0: it is not tried
    uint32_t threads = 0;  // invocations a character
};
// The characters that a fused form is to walk.
struct FusedNeed {
    uint32_t joint_count = 0;
    double subgroups = 0;  // that the device holds at once for each character; 0: not known, or less than one
};
inline FusedPlace not_tried(const ScanLimits&, const FusedNeed&) { return {}; }

struct ScanMethod {
    std::string_view name;  // its shader is <name>.comp, without _quaternion and _transposed, which name variants
    // Its place in the table: the paper's methods, what they are compared with, throng's own.
    uint32_t order = 1000;
    std::string_view summary;
    std::string_view source;
    ScanOrigin origin = ScanOrigin::kOurs;
    ScanLayout layout = ScanLayout::kCharacterMajor;
    ScanFormat format = ScanFormat::kAffine;  // kSimilarity: for rigs of uniform scale only
    // Invocations per character that the method can be told to use, best guess first; 0: as many as it chooses.
    std::vector<uint32_t> (*thread_choices)(const ScanLimits& limits);
    // Which of them `--scan auto` chooses among. Its costs were fitted to these alone; the others are for comparisons,
    // and for users who ask for them. Null: all.
    std::vector<uint32_t> (*planned_choices)(const ScanLimits& limits) = nullptr;
    // Any joint count from 1 to 65,535; `threads` is one of thread_choices().
    ScanPlan (*plan)(const ScanRig& rig, const ScanLimits& limits, uint32_t threads);
    FusedPlace (*fused_place)(const ScanLimits& limits, const FusedNeed& need) = not_tried;
    FlowPicture picture = {};
    // In figures, lines of a higher rank are drawn over others; in tables and legends they come after them: plain
    // methods, the paper's, ours.
    uint32_t rank = 1000;
    // Plain methods are grey, the paper's orange and dashed, ours green, blue and violet and solid. Within a family
    // lightness, dashes and the shape of the points tell methods apart, so that no pair rests on hue alone.
    LineStyle style = {};
};

std::span<const ScanMethod> scan_table();

// The row with this name, or null.
const ScanMethod* find_scan_method(std::string_view name);

// Why the method cannot use so many invocations a character; empty where it can.
std::string threads_unsupported_reason(const ScanMethod& method, const ScanLimits& limits, uint32_t threads);

// The plan, or why there is none: also where the rig's scales or the threads do not fit the method.
ScanPlan plan_scan(const ScanMethod& method, const ScanRig& rig, const ScanLimits& limits, uint32_t threads);

// Two affines a joint in shared memory, or in model and scratch where that has no room for them.
struct SharedJoints {
    SharedJoints(uint32_t joint_count, const ScanLimits& limits);

    bool fit = false;
    uint32_t bytes = 0;               // of shared memory
    std::vector<uint32_t> constants;  // the kernel's first two: joints in shared memory, and whether they fit
};

// As many invocations as joints, in steps of 32 or the subgroup's size, at most `threads`, or 256 where that is 0.
uint32_t strided_workgroup_size(uint32_t joint_count, const ScanLimits& limits, uint32_t threads = 0);
std::vector<uint32_t> planned_choices(const ScanMethod& method, const ScanLimits& limits);

// For methods with a thread for each joint: at most 256, since more may lower the occupancy of GPUs; the planner
// considers only this one. Or as many as a workgroup can have, as in the paper.
std::vector<uint32_t> strided_choices(const ScanLimits& limits);

// Why so much shared memory, `what_for`, is more than the device has; empty where it is not.
std::string memory_unsupported_reason(uint64_t shared_bytes, const std::string& what_for, const ScanLimits& limits);

std::vector<uint32_t> no_thread_choice(const ScanLimits& limits);

}  // namespace throng
