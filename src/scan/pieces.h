// A skeleton cut into connected pieces of bounded size, one for each invocation, for `fragments` and `subgroup`.
#pragma once

#include "scan/scan_table.h"

namespace throng {

inline constexpr const char* kForWaitingParents = " for waiting parents";  // completes messages about shared memory

// Subtrees whose top joints have the same parent outside the piece, without the pieces cut off below.
struct Piece {
    // Parents first. The child subtree that needs the most slots comes last, so that few parents wait at a time
    std::vector<uint32_t> joints;
    uint32_t attachment = kNone;  // the parent of the top joints; kNone if they are roots
};

struct PieceCut {
    std::vector<Piece> pieces;             // at most as many as asked for; none is empty
    std::vector<uint32_t> piece_of_joint;  // [joint_count]
};

// Minimizes the size of the largest piece, for greedy cuts from the leaves up.
PieceCut cut_into_pieces(const ScanRig& rig, uint32_t max_pieces);

// A cut as tables for the shader (src/scan/pieces.glsl), `threads` words a row: paths, then ancestors, then walks.
struct PieceTable {
    std::vector<uint32_t> links;
    uint32_t slot_count = 0;  // transforms that a thread keeps for later children, at most
    uint32_t path_row_count = 0, round_count = 0, walk_row_count = 0;
    uint64_t multiplications = 0;  // of all threads
    uint32_t longest_thread = 0;   // multiplications of a thread with the longest path, most rounds and longest walk
    // Trips of the loops over the path (whose first joint is handled before the loop), the small scan, and the walk.
    std::vector<LoopTrips> loops() const;
    uint64_t loop_iterations() const { return uint64_t{path_row_count} + round_count + walk_row_count + 3; }
    double longest_thread_rows = 0;  // rows that it loads and stores, counted like ScanCounts::issue_rows
    // On a software device, which runs both sides of a branch, a walk step that uses no slot also costs about a row.
    double rows_on(const ScanLimits& limits) const {
        return longest_thread_rows + (limits.is_cpu ? walk_row_count : 0);
    }
};
PieceTable piece_table(const ScanRig& rig, uint32_t threads, double rows_of_local);

// Simulates the shader.
Flow flow_pieces(const ScanRig& rig, uint32_t threads, FlowBoundary between_rounds);

}  // namespace throng
