#include "scan/pieces.h"

#include "scan/pieces_io.h"

#include <algorithm>
#include <bit>

namespace throng {
namespace {

using Children = std::vector<std::vector<uint32_t>>;  // [joint_count + 1], the last entry: the roots

Children children_of(const ScanRig& rig) {
    Children children(rig.joint_count() + 1);
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        children[std::min(rig.parents[joint], rig.joint_count())].push_back(joint);
    return children;
}

// Cuts off subtrees so that no piece exceeds `bound` joints. A group of siblings may form one piece.
std::vector<std::vector<uint32_t>> tops_of_pieces(const ScanRig& rig, const Children& children, uint32_t bound) {
    std::vector<std::vector<uint32_t>> pieces;          // top joints of each piece
    std::vector<uint32_t> open(rig.joint_count() + 1);  // [joint], joints of its subtree not cut off yet
    std::vector<uint32_t> below;
    for (uint32_t joint = rig.joint_count() + 1; joint-- > 0;) {
        // A virtual node above all roots, which is no joint. Everything left below it is cut off
        const bool is_root = joint == rig.joint_count();
        below = children[joint];
        std::stable_sort(below.begin(), below.end(), [&](uint32_t a, uint32_t b) { return open[a] > open[b]; });
        open[joint] = is_root ? 0 : 1;
        for (const uint32_t child : below) open[joint] += open[child];
        while (is_root ? !below.empty() : open[joint] > bound) {
            uint32_t size = 0;
            std::vector<uint32_t> tops, rest;
            for (const uint32_t child : below) {
                const bool fits = size + open[child] <= bound;
                (fits ? tops : rest).push_back(child);
                if (fits) size += open[child];
            }
            open[joint] -= size;
            below = std::move(rest);
            pieces.push_back(std::move(tops));
        }
    }
    return pieces;
}

// Computes how many slots the walk of a subtree needs for parents that wait for further children (as in Sethi and
// Ullman, JACM 1970).
class SlotNeed {
public:
    SlotNeed(const ScanRig& rig, const Children& children, const std::vector<uint32_t>& piece_of_joint)
        : children_(children), piece_of_joint_(piece_of_joint) {
        need_.resize(rig.joint_count());
        for (uint32_t joint = rig.joint_count(); joint-- > 0;) {
            const std::vector<uint32_t> below = ordered_children(joint);
            for (size_t i = 0; i < below.size(); ++i)
                need_[joint] = std::max(need_[joint], need_[below[i]] + (i + 1 < below.size() ? 1 : 0));
        }
    }

    // The children in the same piece, the one that needs the most slots last.
    std::vector<uint32_t> ordered_children(uint32_t joint) const {
        std::vector<uint32_t> below;
        for (const uint32_t child : children_[joint])
            if (piece_of_joint_[child] == piece_of_joint_[joint]) below.push_back(child);
        std::stable_sort(below.begin(), below.end(), [&](uint32_t a, uint32_t b) { return need_[a] < need_[b]; });
        return below;
    }

private:
    const Children& children_;
    const std::vector<uint32_t>& piece_of_joint_;
    std::vector<uint32_t> need_;
};

PieceCut pieces_from(const ScanRig& rig, const Children& children, const std::vector<std::vector<uint32_t>>& tops) {
    PieceCut out{.pieces = {}, .piece_of_joint = std::vector<uint32_t>(rig.joint_count(), kNone)};
    for (uint32_t p = 0; p < tops.size(); ++p)
        for (const uint32_t top : tops[p]) out.piece_of_joint[top] = p;
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        if (out.piece_of_joint[joint] == kNone) out.piece_of_joint[joint] = out.piece_of_joint[rig.parents[joint]];

    const SlotNeed need(rig, children, out.piece_of_joint);
    for (const auto& piece_tops : tops) {
        Piece& piece = out.pieces.emplace_back();
        piece.attachment = rig.parents[piece_tops.front()];
        std::vector<uint32_t> stack(piece_tops.rbegin(), piece_tops.rend());
        while (!stack.empty()) {
            const uint32_t joint = stack.back();
            stack.pop_back();
            piece.joints.push_back(joint);
            const std::vector<uint32_t> below = need.ordered_children(joint);
            stack.insert(stack.end(), below.rbegin(), below.rend());
        }
    }
    return out;
}

// The words of a piece's walk. children_inside[joint]: number of children in the joint's own piece.
std::vector<uint32_t> walk_words(const ScanRig& rig, const Piece& piece, const std::vector<uint32_t>& children_inside,
                                 uint32_t& slot_count) {
    std::vector<uint32_t> words;
    // A stack of joints and how many of their children are still to come. The slot is the position in the stack
    std::vector<std::pair<uint32_t, uint32_t>> kept;
    uint32_t last = kNone;
    for (const uint32_t joint : piece.joints) {
        const uint32_t parent = rig.parents[joint];
        uint32_t source = io::kParentIsPrefix, keep = 0;
        if (parent != piece.attachment) {
            source = parent == last ? io::kParentIsLast : io::kParentInSlot + static_cast<uint32_t>(kept.size() - 1);
            if (!kept.empty() && kept.back().first == parent && --kept.back().second == 0) kept.pop_back();
        }
        if (children_inside[joint] > 1) {
            kept.emplace_back(joint, children_inside[joint]);
            keep = static_cast<uint32_t>(kept.size());
            slot_count = std::max(slot_count, keep);
        }
        words.push_back(joint | source << io::kWalkParentShift | keep << io::kWalkKeepShift);
        last = joint;
    }
    return words;
}

// Turns a list for each thread into rows of one word for each thread.
void append_rows(std::vector<uint32_t>& links, const std::vector<std::vector<uint32_t>>& of_thread, uint32_t threads,
                 uint32_t row_count) {
    for (uint32_t row = 0; row < row_count; ++row)
        for (uint32_t thread = 0; thread < threads; ++thread)
            links.push_back(thread < of_thread.size() && row < of_thread[thread].size() ? of_thread[thread][row]
                                                                                        : io::kIdle);
}

struct PathsBetween {
    std::vector<std::vector<uint32_t>> paths;  // [piece], joints of the piece above it, down to the attachment
    // [piece], the piece above it. kNone if there is none, or if that one begins at a root, so that no product has to
    // be multiplied from above
    std::vector<uint32_t> above;
};

PathsBetween paths_between(const ScanRig& rig, const PieceCut& cut) {
    PathsBetween out;
    for (const Piece& piece : cut.pieces) {
        std::vector<uint32_t>& path = out.paths.emplace_back();
        out.above.push_back(kNone);
        if (piece.attachment == kNone) continue;
        const uint32_t piece_above = cut.piece_of_joint[piece.attachment];
        if (cut.pieces[piece_above].attachment != kNone) out.above.back() = piece_above;
        for (uint32_t joint = piece.attachment; joint != kNone && cut.piece_of_joint[joint] == piece_above;
             joint = rig.parents[joint])
            path.push_back(joint);
        std::reverse(path.begin(), path.end());
    }
    return out;
}

uint32_t longest(const std::vector<std::vector<uint32_t>>& lists) {
    size_t most = 0;
    for (const auto& list : lists) most = std::max(most, list.size());
    return static_cast<uint32_t>(most);
}

}  // namespace

PieceCut cut_into_pieces(const ScanRig& rig, uint32_t max_pieces) {
    const Children children = children_of(rig);
    // Binary search for the smallest bound on the joints of a piece; `high` always suffices
    uint32_t low = (rig.joint_count() + max_pieces - 1) / max_pieces, high = rig.joint_count();
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (tops_of_pieces(rig, children, middle).size() <= max_pieces)
            high = middle;
        else
            low = middle + 1;
    }
    return pieces_from(rig, children, tops_of_pieces(rig, children, high));
}

PieceTable piece_table(const ScanRig& rig, uint32_t threads, double rows_of_local) {
    const PieceCut cut = cut_into_pieces(rig, threads);
    PieceTable table;
    std::vector<uint32_t> children_inside(rig.joint_count());
    for (uint32_t joint = 0; joint < rig.joint_count(); ++joint)
        if (const uint32_t parent = rig.parents[joint];
            parent != kNone && cut.piece_of_joint[parent] == cut.piece_of_joint[joint])
            ++children_inside[parent];
    const auto [paths, above] = paths_between(rig, cut);
    std::vector<std::vector<uint32_t>> ancestors, walks;
    for (uint32_t p = 0; p < cut.pieces.size(); ++p) {
        walks.push_back(walk_words(rig, cut.pieces[p], children_inside, table.slot_count));
        // The pieces 1, 2, 4, … above it
        std::vector<uint32_t>& words = ancestors.emplace_back();
        uint32_t distance = 1;
        for (uint32_t piece = above[p]; piece != kNone; piece = above[piece], ++distance)
            if (std::has_single_bit(distance)) words.push_back(piece);
    }
    table.path_row_count = longest(paths);
    table.round_count = longest(ancestors);
    table.walk_row_count = longest(walks);
    table.links = {table.path_row_count, table.round_count, table.walk_row_count};
    append_rows(table.links, paths, threads, table.path_row_count);
    append_rows(table.links, ancestors, threads, table.round_count);
    append_rows(table.links, walks, threads, table.walk_row_count);

    table.multiplications = rig.joint_count();
    for (size_t p = 0; p < paths.size(); ++p)
        table.multiplications += (paths[p].empty() ? 0 : paths[p].size() - 1) + ancestors[p].size();
    const uint32_t path_steps = table.path_row_count > 0 ? table.path_row_count - 1 : 0;
    table.longest_thread = path_steps + table.round_count + table.walk_row_count;
    table.longest_thread_rows = table.path_row_count * (kRowsOfLink + rows_of_local) +
                                table.round_count * (kRowsOfLink + 2 * rows_of_local) +
                                table.walk_row_count * (kRowsOfLink + rows_of_local + kRowsOfAffine);
    return table;
}

std::vector<LoopTrips> PieceTable::loops() const {
    const double path = path_row_count > 0 ? path_row_count - 1 : 0, rounds = round_count, walk = walk_row_count;
    return {{"path", path}, {"rounds", rounds}, {"walk", walk}};
}

Flow flow_pieces(const ScanRig& rig, uint32_t threads, FlowBoundary between_rounds) {
    const PieceCut cut = cut_into_pieces(rig, threads);
    const auto piece_count = static_cast<uint32_t>(cut.pieces.size());
    Flow flow(rig);
    flow.phase("paths from piece\nto piece");
    std::vector<Product> prefixes(piece_count);
    auto [paths, above] = paths_between(rig, cut);
    for (uint32_t p = 0; p < piece_count; ++p)
        for (const uint32_t joint : paths[p])
            prefixes[p] = prefixes[p].empty() ? Product{joint}
                                              : flow.multiply(p, FlowSource::kRegister, prefixes[p], {joint});
    for (uint32_t round = 1; std::ranges::any_of(above, [](uint32_t piece) { return piece != kNone; }); ++round) {
        flow.phase("small scan over\nthe pieces" + (round > 1 ? ", " + std::to_string(round) : std::string()),
                   between_rounds);
        std::vector<Product> next = prefixes;
        std::vector<uint32_t> next_above = above;
        for (uint32_t p = 0; p < piece_count; ++p) {
            if (above[p] == kNone) continue;
            next[p] = flow.multiply(p, FlowSource::kShared, prefixes[above[p]], prefixes[p]);
            next_above[p] = above[above[p]];
        }
        prefixes = std::move(next);
        above = std::move(next_above);
    }
    flow.phase("each piece\non its own");
    std::vector<Product> products(rig.joint_count());
    for (uint32_t p = 0; p < piece_count; ++p) {
        uint32_t last = cut.pieces[p].attachment;
        for (const uint32_t joint : cut.pieces[p].joints) {
            const uint32_t parent = rig.parents[joint];
            const bool from_prefix = parent == cut.pieces[p].attachment;
            products[joint] = flow.multiply(p,
                                            from_prefix || parent == last ? FlowSource::kRegister : FlowSource::kShared,
                                            from_prefix ? prefixes[p] : products[parent], {joint});
            flow.store(p, joint, products[joint]);
            last = joint;
        }
    }
    return flow;
}

}  // namespace throng
