#include "compile/clip/clip_bounds.h"

#include "reference/influence_boxes.h"
#include "sample/sample_reference.h"
#include "scan/scan_reference.h"

#include <algorithm>
#include <cmath>

namespace throng {
namespace {

// Adds the box as the pose has it, unless it is shrunk to less than `seen`: games hide things like that, often far
// away.
void add_posed(Box& bounds, const AffineT<double>& model_from_joint, const Box& box, double seen) {
    const Vec3<double> middle = transform_point(model_from_joint, (box.low + box.high) * 0.5),
                       half = (box.high - box.low) * 0.5;
    const auto reach = [&](size_t row) {
        const auto& r = model_from_joint.row[row];
        return std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    };
    const Vec3<double> extent{reach(0), reach(1), reach(2)};
    if (std::max({extent.x, extent.y, extent.z}) < seen) return;
    bounds.add(middle - extent);
    bounds.add(middle + extent);
}

// model_from_joint of a clip's poses, one after another. What stands still in the clip is computed once.
class ClipPoses {
public:
    ClipPoses(const Character& character, uint32_t clip) : character_(character), clip_(clip) {
        for (const Trs<double>& joint : sample_reference(character, clip, 0))
            parent_from_joint_.push_back(to_affine(joint));
        const std::vector<uint32_t>& parents = character.rig.parents;
        model_from_joint_ = scan_reference(parents, parent_from_joint_);
        varies_.resize(parents.size());
        moves_.resize(parents.size());
        for (size_t joint = 0; joint < parents.size(); ++joint) {
            for (const TrackTarget target : kTrackTargets)
                if (TrackReader(character, clip, joint, target).varies()) varies_[joint] = true;
            moves_[joint] = varies_[joint] || (parents[joint] != kNone && moves_[parents[joint]]);
        }
    }

    void sample(double time_s) {
        const RowCursor rows = find_rows_reference(row_times(character_, clip_), time_s);
        const std::vector<uint32_t>& parents = character_.rig.parents;
        for (size_t joint = 0; joint < parents.size(); ++joint) {
            if (!moves_[joint]) continue;
            if (varies_[joint]) parent_from_joint_[joint] = to_affine(sample_reference(character_, clip_, joint, rows));
            model_from_joint_[joint] = parents[joint] == kNone
                                           ? parent_from_joint_[joint]
                                           : model_from_joint_[parents[joint]] * parent_from_joint_[joint];
        }
    }

    bool moves(size_t joint) const { return moves_[joint]; }
    const AffineT<double>& model_from_joint(size_t joint) const { return model_from_joint_[joint]; }

private:
    const Character& character_;
    uint32_t clip_;
    std::vector<AffineT<double>> parent_from_joint_, model_from_joint_;
    std::vector<bool> varies_, moves_;  // by its own tracks; or with a joint above it
};

}  // namespace

void measure_clips(Character& character, const Progress& progress) {
    constexpr double kSeen = 1e-6;  // of the character's size
    const std::vector<Box> boxes = influence_boxes(character);
    const std::vector<bool> alone = joints_that_move_alone(character);
    const auto seen = [&](size_t joint) { return alone[joint] ? kSeen * character.size : 0; };
    for (uint32_t number = 0; number < character.clips.size(); ++number) {
        progress.report(number, character.clips.size());
        ClipPoses poses(character, number);
        Box bounds;
        for (size_t joint = 0; joint < boxes.size(); ++joint)
            if (!poses.moves(joint)) add_posed(bounds, poses.model_from_joint(joint), boxes[joint], seen(joint));
        const auto add_pose = [&](double time_s) {
            poses.sample(time_s);
            for (size_t joint = 0; joint < boxes.size(); ++joint)
                if (poses.moves(joint)) add_posed(bounds, poses.model_from_joint(joint), boxes[joint], seen(joint));
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
