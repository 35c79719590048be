// A skeleton cut into connected pieces of bounded size, one for each invocation: what `fragments` and `subgroup` work
// on.
#pragma once

#include "scan/scan_table.h"

namespace throng {

inline constexpr const char* kForWaitingParents = " for waiting parents";  // shared memory

// Some subtrees, without those cut off below, whose top joints share one parent outside.
struct Piece {
    // Parents first; a joint's largest subtree comes last, so that few parents wait for a child
    std::vector<uint32_t> joints;
    uint32_t attachment = kNone;  // the parent of the top joints; kNone where they are roots
};

struct PieceCut {
    std::vector<Piece> pieces;             // at most as many as asked for; none is empty
    std::vector<uint32_t> piece_of_joint;  // [joint_count]
};

// The largest piece is as small as a greedy cut from the leaves up allows.
PieceCut cut_into_pieces(const ScanRig& rig, uint32_t most_pieces);

// A cut as tables for the shader (src/scan/pieces.glsl), `threads` words a row: paths, then ancestors, then walks.
struct PieceTable {
    std::vector<uint32_t> links;
    uint32_t slot_count = 0;  // transforms that a thread keeps for later children
    uint32_t path_row_count = 0, round_count = 0, walk_row_count = 0;
    uint64_t multiplications = 0;  // of all threads
    uint32_t longest_thread = 0;   // multiplications of a thread that has the longest path, rounds and walk
    // The loops of the path, whose first joint is handled outside of the loop; of the small scan; of the walk.
    std::vector<LoopTrips> loops() const;
    uint64_t loop_iterations() const { return uint64_t{path_row_count} + round_count + walk_row_count + 3; }
    double longest_thread_rows = 0;  // that it loads and stores, as ScanCounts::issue_rows has them
    // A software device runs both sides of a branch, so a step of a walk that uses no slot costs it about a row too.
    double rows_on(const ScanLimits& limits) const {
        return longest_thread_rows + (limits.is_cpu ? walk_row_count : 0);
    }
};
PieceTable piece_table(const ScanRig& rig, uint32_t threads, double rows_of_local);

// Simulates what the shader does with the pieces.
Flow flow_pieces(const ScanRig& rig, uint32_t threads, FlowBoundary between_rounds);

}  // namespace throng
