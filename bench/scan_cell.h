// One cell of an experiment: a skeleton and a number of characters, on which all methods are measured side by side.
#pragma once

#include "bench/rounds.h"
#include "bench/skeletons.h"
#include "scan/scan.h"

#include <nlohmann/json_fwd.hpp>

namespace throng::bench {

struct ScanCell {
    std::string experiment;
    SkeletonShape shape = SkeletonShape::kRandom;
    uint32_t characters = 0, joints = 0, levels = 0;
    uint64_t seed = 1;

    ScanRig rig() const { return ScanRig(make_skeleton(shape, joints, levels, seed), true); }
};

// A row of the results. The fastest of its choices runs; they share the layout and the format of one method.
struct Entrant {
    std::string name;
    std::vector<ScanChoice> choices;
};

// The fields of bench/README.md that a cell's records share, those of one choice, and what its check has shown.
nlohmann::json describe_cell(const ScanCell& cell, const ScanRig& rig, const DeviceInfo& device);
void add_choice(nlohmann::json& record, const ScanChoice& choice, const ScanCounts& counts);
void add_error(nlohmann::json& record, double max_error);

// measure_scans: checks each entrant, then times the right ones and a copy of the same bytes in interleaved rounds.
// measure_on_chip: the same without memory (scan.glsl, SCAN_ON_CHIP), with as many joints as leave every method room in
// shared memory, and with few characters on a software device. Either returns a record for each entrant, in their
// order. Throws kLimit and kOutOfMemory.
std::vector<nlohmann::json> measure_scans(const std::shared_ptr<Gpu>& gpu, const ScanCell& cell,
                                          std::span<const Entrant> entrants, const Sampling& sampling,
                                          const Progress& progress);
std::vector<nlohmann::json> measure_on_chip(const std::shared_ptr<Gpu>& gpu, ScanCell cell,
                                            std::span<const Entrant> entrants, const Sampling& sampling,
                                            const Progress& progress);

}  // namespace throng::bench
