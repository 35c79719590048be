// The table of Hierarchy-Scan methods, one row each, defined in src/scan/methods. Tests, benchmark, planner and command
// line loop over this table.
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

// Device limits and features that methods depend on.
struct ScanLimits {
    uint32_t shared_memory_bytes = 0;
    uint32_t workgroup_size = 0;         // largest
    uint32_t subgroup_size = 0;          // the smallest that the device may choose
    uint32_t largest_subgroup_size = 0;  // the largest that a kernel can ask for; 0: the driver chooses
    bool shuffle = false;                // subgroups can exchange registers
    bool is_cpu = false;
    // Iterations of an invocation, summed over all loops, after which the device silently ends the loops
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
    uint32_t subgroup_size = 0;            // that it requires; 0: any
    bool full_subgroups = false;           // it relies on subgroups without idle invocations
    // Only local and model transforms pass through memory, so the on-chip variant can run
    bool on_chip = false;
    ScanCounts counts = {};
};

enum class ScanOrigin { kPaper, kBaseline, kOurs };  // named by the paper; common practice to compare with; throng's
// [instance][joint], as in all other stages; [joint][instance]
enum class ScanLayout { kCharacterMajor, kTransposed };
enum class ScanFormat { kAffine, kSimilarity };  // of local transforms
constexpr uint32_t bytes_of(ScanFormat format) { return format == ScanFormat::kSimilarity ? 32 : 48; }

// Rank of a method's fused form among those that an update tries, the lowest order first.
struct FusedPlace {
    uint32_t order = 0;    // 0: not tried
    uint32_t threads = 0;  // invocations a character
};
// The characters for which a fused form is chosen.
struct FusedNeed {
    uint32_t joint_count = 0;
    double subgroups = 0;  // that the device can hold at once per character; 0: unknown, or less than one
};
inline FusedPlace not_tried(const ScanLimits&, const FusedNeed&) { return {}; }

struct ScanMethod {
    std::string_view name;  // its shader is <name>.comp; suffixes _quaternion and _transposed name variants of it
    // Position in the table: the paper's methods, then baselines, then throng's own.
    uint32_t order = 1000;
    std::string_view summary;
    std::string_view source;
    ScanOrigin origin = ScanOrigin::kOurs;
    ScanLayout layout = ScanLayout::kCharacterMajor;
    ScanFormat format = ScanFormat::kAffine;  // kSimilarity: for rigs of uniform scale only
    // Numbers of invocations per character that the method supports, best guess first; 0: the method chooses.
    std::vector<uint32_t> (*thread_choices)(const ScanLimits& limits);
    // Those that `--scan auto` chooses from. The cost model was fitted to these only; the others are for comparisons,
    // and for users who ask for them. Null: all.
    std::vector<uint32_t> (*planned_choices)(const ScanLimits& limits) = nullptr;
    // Any joint count from 1 to 65,535; `threads` is one of thread_choices().
    ScanPlan (*plan)(const ScanRig& rig, const ScanLimits& limits, uint32_t threads);
    FusedPlace (*fused_place)(const ScanLimits& limits, const FusedNeed& need) = not_tried;
    FlowPicture picture = {};
    // In figures, lines of higher rank are drawn on top; in tables and legends they come last. Plain methods have the
    // lowest ranks, then the paper's, then ours.
    uint32_t rank = 1000;
    // Plain methods are grey; the paper's orange, dashed; ours green, blue and violet, solid. Within a family, methods
    // differ in lightness, dashes and point shape, so that no two are distinguished by hue alone.
    LineStyle style = {};
};

std::span<const ScanMethod> scan_table();

// The row with this name, or null.
const ScanMethod* find_scan_method(std::string_view name);

// Why the method cannot use this number of invocations per character; empty if it can.
std::string threads_unsupported_reason(const ScanMethod& method, const ScanLimits& limits, uint32_t threads);

// The plan, or the reason why there is none. Also checks that the rig's scales and the threads fit the method.
ScanPlan plan_scan(const ScanMethod& method, const ScanRig& rig, const ScanLimits& limits, uint32_t threads);

// Two affines per joint: in shared memory, or in model and scratch if they do not fit there.
struct SharedJoints {
    SharedJoints(uint32_t joint_count, const ScanLimits& limits);

    bool fit = false;
    uint32_t bytes = 0;               // of shared memory
    std::vector<uint32_t> constants;  // the kernel's first two: joints in shared memory, and whether they fit
};

// The number of joints, rounded up to a multiple of 32 or the subgroup size; at most `threads`, or 256 if that is 0.
uint32_t strided_workgroup_size(uint32_t joint_count, const ScanLimits& limits, uint32_t threads = 0);
std::vector<uint32_t> planned_choices(const ScanMethod& method, const ScanLimits& limits);

// For methods with a thread for each joint. 0: at most 256, since more may lower the occupancy of GPUs; the only choice
// that the planner considers. The other: as many as a workgroup can have, as in the paper.
std::vector<uint32_t> strided_choices(const ScanLimits& limits);

// Why the device cannot provide this much shared memory; empty if it can. `what_for` completes the message.
std::string memory_unsupported_reason(uint64_t shared_bytes, const std::string& what_for, const ScanLimits& limits);

std::vector<uint32_t> no_thread_choice(const ScanLimits& limits);

}  // namespace throng
