#include "native/walk.h"

#include <algorithm>

namespace throng::native {
namespace {

// A joint is walked, or a matrix is written.
struct Action {
    uint32_t joint;  // walked, or whose matrix it is
    bool walks;
    Emission emission{};
};

class Planner {
public:
    explicit Planner(const WalkRequest& request) : request_(request), walked_(request.parents.size()) {
        entries_.resize(request.parents.size());
        sockets_.resize(request.parents.size());
        for (uint32_t s = 0; s < request.sockets.size(); ++s) sockets_[request.sockets[s]].push_back(s);
        for (uint32_t e = 0; e < request.palette.size(); ++e) entries_[request.palette[e].joint].push_back(e);
        in_order_ = std::all_of(request.palette.begin(), request.palette.end(),
                                [&](const PaletteEntry& entry) { return request.moves[entry.joint]; });
    }

    Walk plan() {
        if (in_order_)
            for (uint32_t e = 0; e < request_.palette.size(); ++e) {
                walk(request_.palette[e].joint);
                emit(request_.palette[e].joint, EmissionKind::kSkin, e);
            }
        for (const uint32_t joint : request_.sockets) walk(joint);
        for (uint32_t joint = 0; joint < request_.parents.size(); ++joint)
            if (request_.moves[joint] && (request_.keeps_model || (!in_order_ && !entries_[joint].empty())))
                walk(joint);
        keep_slots();
        return std::move(walk_);
    }

private:
    void emit(uint32_t joint, EmissionKind kind, uint32_t target) {
        actions_.push_back({joint, false, {.kind = kind, .target = target}});
    }

    void walk(uint32_t joint) {
        std::vector<uint32_t> path;
        for (; joint != throng::kNone && !walked_[joint]; joint = request_.parents[joint]) path.push_back(joint);
        for (; !path.empty(); path.pop_back()) {
            const uint32_t next = path.back();
            walked_[next] = true;
            actions_.push_back({next, true});
            if (request_.keeps_model) emit(next, EmissionKind::kModel, next);
            for (const uint32_t socket : sockets_[next]) emit(next, EmissionKind::kSocket, socket);
            if (in_order_) continue;
            for (const uint32_t entry : entries_[next]) emit(next, EmissionKind::kSkinAt, entry);
        }
    }

    uint32_t source_of(const Action& action) const {
        return action.walks ? request_.parents[action.joint] : action.joint;
    }

    // Linear-scan allocation: a slot is free again after the last use of its matrix.
    void keep_slots() {
        std::vector<size_t> last_use(request_.parents.size());
        uint32_t last = throng::kNone;
        for (size_t i = 0; i < actions_.size(); ++i) {
            const uint32_t source = source_of(actions_[i]);
            if (source != throng::kNone && source != last) last_use[source] = i;
            if (actions_[i].walks) last = actions_[i].joint;
        }
        std::vector<uint32_t> free, slot(request_.parents.size());
        last = throng::kNone;
        for (size_t i = 0; i < actions_.size(); ++i) {
            const Action& action = actions_[i];
            const uint32_t source = source_of(action);
            const bool is_slot = source != throng::kNone && source != last;
            const uint32_t from = source == throng::kNone ? kRoot : is_slot ? slot[source] : kLast;
            if (is_slot && last_use[source] == i) free.push_back(slot[source]);
            if (!action.walks) {
                walk_.emissions.push_back(action.emission);
                walk_.emissions.back().source = from;
                walk_.emitted_joints.push_back(action.joint);
                ++walk_.steps.back().emission_count;
                continue;
            }
            last = action.joint;
            walk_.joints.push_back(last);
            walk_.steps.push_back({.parent = from});
            if (last_use[last] == 0) continue;
            if (free.empty()) free.push_back(walk_.slot_count++);
            walk_.steps.back().keep = slot[last] = free.back();
            free.pop_back();
        }
    }

    const WalkRequest& request_;
    std::vector<bool> walked_;
    std::vector<std::vector<uint32_t>> entries_, sockets_;  // [joint]
    bool in_order_ = false;
    std::vector<Action> actions_;
    Walk walk_;
};

}  // namespace

Walk plan_walk(const WalkRequest& request) { return Planner(request).plan(); }

}  // namespace throng::native
