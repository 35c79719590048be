#include "bench/isa/machine_code.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

namespace throng::bench {
namespace {

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> beginnings) {
    return std::ranges::any_of(beginnings, [&](std::string_view beginning) { return text.starts_with(beginning); });
}

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

InstructionClass class_of(std::string_view name) {
    using enum InstructionClass;
    if (name == "s_barrier") return kSharedWait;
    if (starts_with_any(name, {"s_nop", "s_clause", "s_delay_alu", "s_inst_prefetch", "s_sleep", "s_code_end"}))
        return kHint;
    if (starts_with_any(name, {"v_exp_", "v_log_", "v_rcp_", "v_rsq_", "v_sqrt_", "v_sin_", "v_cos_"}))
        return kTranscendental;
    if (name.starts_with("v_")) return kVector;
    if (name.starts_with("ds_")) return kShared;
    if (contains(name, "_store") || contains(name, "_atomic") || name == "exp" || name == "export") return kStore;
    if (contains(name, "_load") || starts_with_any(name, {"image_sample", "image_gather", "image_msaa"})) return kLoad;
    return kScalar;
}

// Distinguishes waits that take time from waits for what an earlier wait has already covered.
class Waits {
public:
    InstructionClass class_of_wait(std::string_view operands) {
        const bool memory = contains(operands, "vmcnt") && std::exchange(for_memory_, false),
                   shared = contains(operands, "lgkmcnt") && std::exchange(for_shared_, false);
        return memory   ? InstructionClass::kMemoryWait
               : shared ? InstructionClass::kSharedWait
                        : InstructionClass::kHint;
    }
    void see(std::string_view name, InstructionClass of) {
        const bool is_scalar = name.starts_with("s_");
        for_memory_ |= of == InstructionClass::kLoad && !is_scalar;
        for_shared_ |= of == InstructionClass::kShared || (of == InstructionClass::kLoad && is_scalar);
    }

private:
    bool for_memory_ = false, for_shared_ = false;  // there are loads that no wait has covered yet
};

struct Line {
    InstructionClass of;
    std::string_view name;
    std::string_view target;  // of a branch
};

struct Loop {
    size_t first = 0, end = 0;  // lines
};

std::string_view take_word(std::string_view& text) {
    const size_t first = std::min(text.find_first_not_of(" \t"), text.size());
    const size_t end = std::min(text.find_first_of(" \t", first), text.size());
    const std::string_view word = text.substr(first, end - first);
    text.remove_prefix(end);
    return word;
}

}  // namespace

void InstructionCounts::add(const InstructionCounts& other, double times) {
    for (size_t i = 0; i < of.size(); ++i) of[i] += other.of[i] * times;
}

double InstructionCounts::total() const { return std::accumulate(of.begin(), of.end(), 0.0); }

InstructionCounts MachineCode::all() const {
    InstructionCounts sum = outside;
    for (const MachineLoop& loop : loops) sum.add(loop.own);
    return sum;
}

MachineCode read_machine_code(std::string_view assembly) {
    std::vector<Line> lines;
    std::map<std::string_view, size_t> labels;
    Waits waits;
    while (!assembly.empty()) {
        const size_t end = std::min(assembly.find('\n'), assembly.size());
        std::string_view line = assembly.substr(0, end);
        assembly.remove_prefix(std::min(end + 1, assembly.size()));
        line = line.substr(0, line.find(';'));
        const bool is_instruction = line.starts_with('\t') || line.starts_with(' ');
        const std::string_view name = take_word(line);
        if (name.empty()) continue;
        if (!is_instruction) {
            labels[name.substr(0, name.find(':'))] = lines.size();
            continue;
        }
        const bool branches = starts_with_any(name, {"s_branch", "s_cbranch"});
        const InstructionClass of = name.starts_with("s_waitcnt") ? waits.class_of_wait(line) : class_of(name);
        waits.see(name, of);
        lines.push_back({of, name, branches ? take_word(line) : std::string_view()});
    }
    std::map<size_t, size_t> ends;  // of loops, by their first lines
    for (size_t i = 0; i < lines.size(); ++i)
        if (const auto label = labels.find(lines[i].target); label != labels.end() && label->second <= i)
            ends[label->second] = i + 1;

    MachineCode code;
    std::vector<Loop> loops;
    for (const auto& [first, end] : ends) {
        const auto around = std::ranges::count_if(loops, [&](const Loop& other) { return first < other.end; });
        loops.push_back({first, end});
        const auto has = [&](std::string_view beginning) {
            return std::any_of(lines.begin() + static_cast<std::ptrdiff_t>(first),
                               lines.begin() + static_cast<std::ptrdiff_t>(end),
                               [&](const Line& line) { return line.name.starts_with(beginning); });
        };
        const auto next = ends.upper_bound(first);
        const bool is_innermost = next == ends.end() || next->first >= end;
        code.loops.push_back({.depth = static_cast<uint32_t>(around),
                              .over_lanes = is_innermost && has("v_readfirstlane") && has("v_readlane")});
    }
    for (size_t i = 0; i < lines.size(); ++i) {
        InstructionCounts* counts = &code.outside;
        for (size_t l = 0; l < loops.size(); ++l)  // the last one that holds it is the innermost
            if (loops[l].first <= i && i < loops[l].end) counts = &code.loops[l].own;
        ++(*counts)[lines[i].of];
    }
    return code;
}

}  // namespace throng::bench
