#include "compile/mesh/decimate.h"

#include "compile/mesh/collapse_meter.h"
#include "compile/mesh/simplified_mesh.h"

#include <queue>
#include <utility>

namespace throng {
namespace {

constexpr uint64_t kStepsBetweenReports = 1000;  // some 20 ms

class Decimation {
public:
    Decimation(const WeldedMesh& fine, const TriangleIndex& fine_surface)
        : fine_(fine), mesh_(fine_), meter_(fine_, fine_surface, mesh_), plans_(fine_.point_count()) {}

    void plan_all(const Progress& progress) {
        for (uint32_t point = 0; point < plans_.size(); ++point) {
            if (point % kStepsBetweenReports == 0) progress.report(point, plans_.size());
            plan(point);
        }
    }

    void collapse_to(size_t face_count, const Progress& progress) {
        const size_t all = fine_.faces().size();
        for (uint64_t step = 0; mesh_.face_count() > face_count && !queue_.empty(); ++step) {
            if (step % kStepsBetweenReports == 0) progress.report(all - mesh_.face_count(), all);
            const Queued next = queue_.top();
            queue_.pop();
            const Plan& of_point = plans_[next.point];
            if (next.version != of_point.version) continue;
            if (of_point.is_outdated)
                plan(next.point);
            else if (!of_point.is_measured)
                confirm(next.point);
            else
                collapse(next.point);
        }
    }

    std::vector<uint32_t> indices() const { return mesh_.indices(); }

private:
    // The planned collapse of a point.
    struct Plan {
        std::vector<Collapse> possible;
        uint32_t target = kNone;   // the neighbour that it would be collapsed into
        bool is_measured = false;  // its cost in the queue is exact; else it is a lower bound
        bool is_outdated = false;  // triangles around the point have changed since
        uint32_t version = 0;      // queue entries with another version are stale
    };
    struct Queued {
        float cost = 0;
        uint32_t point = 0, version = 0;

        friend bool operator<(const Queued& a, const Queued& b) {  // the least cost on top
            return a.cost != b.cost ? a.cost > b.cost : a.point > b.point;
        }
    };

    // Measures only in the first group of poses. Most plans are outdated before they reach the front of the queue, so
    // more would be wasted work.
    void plan(uint32_t point) {
        Plan& plan = plans_[point];
        plan.possible = meter_.possible_collapses(point);
        plan.is_outdated = plan.is_measured = false;
        queue(point, plan.possible.empty() ? Collapse{.squared_distance = kNever} : plan.possible[0]);
    }

    void confirm(uint32_t point) {
        plans_[point].is_measured = true;
        queue(point, meter_.cheapest(point, std::exchange(plans_[point].possible, {})));
    }

    void queue(uint32_t point, const Collapse& collapse) {
        Plan& plan = plans_[point];
        ++plan.version;
        plan.target = collapse.cost() < kNever ? collapse.to : kNone;
        if (plan.target != kNone) queue_.push({collapse.cost(), point, plan.version});
    }

    void collapse(uint32_t point) {
        const std::vector<uint32_t> changed = mesh_.collapse(point, plans_[point].target);
        plans_[point] = {.version = plans_[point].version + 1};
        for (const uint32_t other : changed) {
            plans_[other].is_outdated = true;
            if (plans_[other].target == kNone) plan(other);  // its collapse may have become possible
        }
    }

    const WeldedMesh& fine_;
    SimplifiedMesh mesh_;
    CollapseMeter meter_;
    std::vector<Plan> plans_;  // [points]
    std::priority_queue<Queued> queue_;
};

}  // namespace

void decimate(const WeldedMesh& fine, const TriangleIndex& fine_surface, std::span<const size_t> index_counts,
              const std::function<bool(std::vector<uint32_t>)>& take, const Progress& progress) {
    constexpr double kPlanned = 0.1;  // part of the work
    Decimation decimation(fine, fine_surface);
    decimation.plan_all(progress.between(0, kPlanned));
    for (const size_t count : index_counts) {
        decimation.collapse_to(count / 3, progress.between(kPlanned, 1));
        if (!take(decimation.indices())) return;
    }
}

}  // namespace throng
