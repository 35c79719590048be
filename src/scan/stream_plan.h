// An order of joints in chunks, one for each lane: what `stream` works on.
#pragma once

#include "scan/scan_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A parent lies in its child's chunk or in an earlier one.
struct StreamPlan {
    uint32_t lanes = 0;       // of a chunk
    uint32_t characters = 1;  // that share it
    uint32_t slots = 0;       // transforms that wait for children in later chunks, at most
    // [chunk][at most `lanes`], joints of all characters: character * joint_count + joint
    std::vector<std::vector<uint32_t>> chunks;
    std::vector<uint32_t> rounds;  // [chunk], of doubling: enough for the longest way down within it
    uint32_t round_count = 0;      // of all chunks
    uint64_t multiplications = 0;  // of all lanes
    uint32_t longest_lane = 0;     // multiplications one after the other
};

// What a number of invocations a character means: the lanes of a chunk, and the subgroups with a chunk each.
struct StreamTeam {
    StreamTeam(const ScanLimits& limits, uint32_t threads);

    uint32_t lanes = 0, subgroups = 1;
};

constexpr uint32_t kMostShared = 4;  // chunks that several small characters share

struct StreamLimits {
    uint32_t lanes = 32;
    uint32_t most_slots = 0xFFFF;
    uint32_t most_characters = 64;
};

// The best order found: few chunks, joints of a chunk side by side, few rounds, few slots. A chunk costs as much as
// making a transform, a round as much as a product. If no order has as few slots as asked for, the one with the fewest.
StreamPlan plan_stream(const ScanRig& rig, const StreamLimits& limits);

// As the shader reads it (scan/stream_io.h).
std::vector<uint32_t> stream_links(const StreamPlan& plan, std::span<const uint32_t> parents);

}  // namespace throng
