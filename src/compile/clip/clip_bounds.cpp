#include "compile/clip/clip_bounds.h"

#include "reference/influence_boxes.h"
#include "sample/sample_reference.h"
#include "scan/scan_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

// Adds the posed box, unless the pose shrinks it to less than `seen`: games hide parts that way, often far away.
void add_posed(Box& bounds, const AffineT<double>& model_from_joint, const Box& box, double seen) {
    const Vec3<double> middle = transform_point(model_from_joint, (box.low + box.high) * 0.5),
                       half = (box.high - box.low) * 0.5;
    const auto reach = [&](size_t row) {
        const auto& r = model_from_joint.row[row];
        return std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    };
    const Vec3<double> extent{reach(0), reach(1), reach(2)};
    if (std::max({extent.x, extent.y, extent.z}) < seen) return;
    bounds.add({middle - extent, middle + extent, false});
}

// model_from_joint of a clip's poses, one after another. What stands still in the clip is computed once.
class ClipPoses {
public:
    ClipPoses(const Character& character, uint32_t clip) : character_(character), clip_(clip) {
        for (const Trs<double>& joint : sample_reference(character, clip, 0))
            parent_from_joint_.push_back(to_affine(joint));
        const std::vector<uint32_t>& parents = character.rig.parents;
        model_from_joint_ = scan_reference(parents, parent_from_joint_);
        std::vector<bool> moves(parents.size());
        for (uint32_t joint = 0; joint < parents.size(); ++joint) {
            bool varies = false;
            for (const TrackTarget target : kTrackTargets)
                varies = varies || TrackReader(character, clip, joint, target).varies();
            moves[joint] = varies || (parents[joint] != kNone && moves[parents[joint]]);
            if (moves[joint])
                moving_.push_back({joint, parents[joint], varies});
            else
                still_.push_back(joint);
        }
    }

    void sample(double time_s) {
        const RowCursor rows = find_rows_reference(row_times(character_, clip_), time_s);
        for (const Moving& m : moving_) {
            if (m.varies) parent_from_joint_[m.joint] = to_affine(sample_reference(character_, clip_, m.joint, rows));
            model_from_joint_[m.joint] = m.parent == kNone ? parent_from_joint_[m.joint]
                                                           : model_from_joint_[m.parent] * parent_from_joint_[m.joint];
        }
    }

    // A joint that moves in the clip, by its own tracks or an ancestor's. Parents come first.
    struct Moving {
        uint32_t joint, parent;
        bool varies;  // by its own tracks
    };
    const std::vector<Moving>& moving() const { return moving_; }
    const std::vector<uint32_t>& still() const { return still_; }
    const AffineT<double>& model_from_joint(size_t joint) const { return model_from_joint_[joint]; }

private:
    const Character& character_;
    uint32_t clip_;
    std::vector<AffineT<double>> parent_from_joint_, model_from_joint_;
    std::vector<Moving> moving_;
    std::vector<uint32_t> still_;
};

}  // namespace

void measure_clips(Character& character, const Progress& progress) {
    constexpr double kSeen = 1e-6;  // of the character's size
    const std::vector<Box> boxes = influence_boxes(character);
    std::vector<double> min_seen;  // [joint_count]
    for (const bool alone : joints_that_move_alone(character)) min_seen.push_back(alone ? kSeen * character.size : 0);
    for (uint32_t number = 0; number < character.clips.size(); ++number) {
        progress.report(number, character.clips.size());
        ClipPoses poses(character, number);
        Box bounds;
        const auto add_joint = [&](uint32_t joint) {
            add_posed(bounds, poses.model_from_joint(joint), boxes[joint], min_seen[joint]);
        };
        for (const uint32_t joint : poses.still()) add_joint(joint);
        const auto add_pose = [&](double time_s) {
            poses.sample(time_s);
            for (const ClipPoses::Moving& moving : poses.moving()) add_joint(moving.joint);
        };
        const std::span<const float> times_s = row_times(character, number);
        for (size_t row = 0; row < times_s.size(); ++row) {
            progress.poll();
            add_pose(times_s[row]);
            if (row + 1 < times_s.size()) add_pose((double{times_s[row]} + times_s[row + 1]) / 2);
        }
        if (bounds.empty) bounds.add(Vec3<double>{});  // all is hidden
        Clip& clip = character.clips[number];
        clip.bounds_min = bounds.low.as<float>();
        clip.bounds_max = bounds.high.as<float>();
    }
}

}  // namespace throng
