// The methods of the Hierarchy-Scan stage, and which one throng chooses.
#pragma once

#include <throng/character.h>
#include <throng/device.h>

#include <cstdint>
#include <string>
#include <vector>

namespace throng {

// One of them; docs/scan.md describes all.
struct ScanMethodInfo {
    std::string name{};
    std::string summary{};
    std::string source{};
    // false: it needs another memory layout than the other stages have, and runs in `throng bench scan` only
    bool in_crowds = true;
};
std::vector<ScanMethodInfo> scan_methods();

// What "auto" chooses for a rig where updates are staged, and why, in one line. The method may come with its
// invocations a character: "subgroup:8". The choice is made by a cost model of the device: measured, where `throng
// tune` has left its file in the user's cache folder ($XDG_CACHE_HOME/throng or ~/.cache/throng), else built in. Errors
// of advise_scan(): kInvalidArgument (no joints).
struct ScanAdvice {
    std::string method{};
    std::string reason{};
};
Result<ScanAdvice> advise_scan(const Device& device, const Rig& rig, uint32_t instance_count);

// The order in which `stream`, the method of fused updates on GPUs, processes the joints of a compiled character's rig:
// docs/scan.md#stream. `lanes` is clamped to 4..64 and rounded down to a power of two.
struct StreamOrder {
    uint32_t lanes = 0;       // of a subgroup, one for each joint of a chunk; a power of two, 4 to 64
    uint32_t characters = 1;  // that share the chunks
    uint32_t chunks = 0;
    uint32_t rounds = 0;  // of doubling by shuffles, summed over all chunks
    uint32_t slots = 0;   // transforms in shared memory
};
StreamOrder stream_order(const Rig& rig, uint32_t lanes = 32);

}  // namespace throng
