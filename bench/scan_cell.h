// One cell of an experiment: a skeleton and a number of characters, on which all methods are measured side by side.
#pragma once

#include "bench/record.h"
#include "bench/rounds.h"
#include "bench/skeletons.h"
#include "scan/scan.h"

#include <optional>

namespace throng::bench {

struct ScanCell {
    std::string experiment;
    SkeletonShape shape = SkeletonShape::kRandom;
    uint32_t characters = 0, joints = 0, levels = 0;
    uint64_t seed = 1;

    ScanRig rig() const { return ScanRig(make_skeleton(shape, joints, levels, seed), true); }
};

// A row of the results. Only the fastest of its choices is timed; they share the layout and the format of one method.
struct Candidate {
    std::string name;
    std::vector<ScanChoice> choices;
};

// What the check of a candidate has shown.
struct ScanCheck {
    std::string unsupported_reason;
    std::optional<ScanChoice> choice;  // the fastest; none where no choice applies
    ScanCounts counts;
    uint32_t workgroup_size = 0;
    double max_error = 0;

    bool runs() const;
};

// The fields of bench/README.md that a cell's records share, and those of a candidate after its check.
Json describe_cell(const ScanCell& cell, const ScanRig& rig, const DeviceInfo& device);
Json describe_check(const Json& cell_record, const Candidate& candidate, const ScanCheck& check);

// Calls check(candidate) for each.
template <class Check>
auto check_all(std::span<const Candidate> candidates, const Progress& progress, const Check& check) {
    std::vector<decltype(check(candidates.front()))> checked;
    for (const Candidate& candidate : candidates) {
        progress("checking " + candidate.name + ", " + std::to_string(checked.size() + 1) + " of " +
                 std::to_string(candidates.size()));
        checked.push_back(check(candidate));
    }
    return checked;
}

// measure_scans: checks each candidate, then times the correct ones and a copy of the same bytes in interleaved rounds.
// measure_on_chip: the same without memory (scan.glsl, SCAN_ON_CHIP), with as many joints as leave every method room in
// shared memory, and with few characters on a software device. Both return a record for each candidate, in their order,
// and throw kLimit and kOutOfMemory.
std::vector<Json> measure_scans(const std::shared_ptr<Gpu>& gpu, const ScanCell& cell,
                                std::span<const Candidate> candidates, const Sampling& sampling,
                                const Progress& progress);
std::vector<Json> measure_on_chip(const std::shared_ptr<Gpu>& gpu, ScanCell cell, std::span<const Candidate> candidates,
                                  const Sampling& sampling, const Progress& progress);

}  // namespace throng::bench
