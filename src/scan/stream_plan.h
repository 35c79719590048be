// The order in which `stream` processes joints: chunks with one joint per lane.
#pragma once

#include "scan/scan_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

// A parent is in its child's chunk or in an earlier one.
struct StreamPlan {
    uint32_t lanes = 0;       // lanes of a chunk
    uint32_t characters = 1;  // characters that share a chunk
    uint32_t slots = 0;       // largest number of transforms that wait for children in later chunks
    // [chunk][at most `lanes`], joints of all characters: character * joint_count + joint
    std::vector<std::vector<uint32_t>> chunks;
    std::vector<uint32_t> rounds;  // [chunk], rounds of doubling, enough for the longest path within it
    uint32_t round_count = 0;      // of all chunks
    uint64_t multiplications = 0;  // of all lanes
    uint32_t longest_lane = 0;     // multiplications on the critical path
};

// Splits a character's number of invocations into the lanes of a chunk, and the subgroups that each process a chunk.
struct StreamTeam {
    StreamTeam(const ScanLimits& limits, uint32_t threads);

    uint32_t lanes = 0, subgroups = 1;
};

constexpr uint32_t kMaxShared = 4;  // small characters share chunks only if all their joints would fit into this many

struct StreamLimits {
    uint32_t lanes = 32;
    uint32_t max_slots = 0xFFFF;
    uint32_t max_characters = 64;
};

// The best order found: few chunks, adjacent joints in a chunk, few rounds, few slots. A chunk costs as much as
// computing a local transform, a round as much as a product. If no order needs at most `max_slots` slots, the one with
// the fewest.
StreamPlan plan_stream(const ScanRig& rig, const StreamLimits& limits);

// The plan as words for the shader (scan/stream_io.h).
std::vector<uint32_t> stream_links(const StreamPlan& plan, std::span<const uint32_t> parents);

}  // namespace throng
