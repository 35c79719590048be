#include "compile/clip/clip_bounds.h"

#include "reference/sampled_poses.h"
#include "reference/influence_boxes.h"

#include <cmath>

namespace throng {
namespace {

// Adds the box as the pose has it.
void add_posed(Box& bounds, const AffineT<double>& model_from_joint, const Box& box) {
    const Vec3<double> middle = transform_point(model_from_joint, (box.low + box.high) * 0.5),
                       half = (box.high - box.low) * 0.5;
    const auto reach = [&](size_t row) {
        const auto& r = model_from_joint.row[row];
        return std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z;
    };
    const Vec3<double> extent{reach(0), reach(1), reach(2)};
    bounds.add(middle - extent);
    bounds.add(middle + extent);
}

}  // namespace

void measure_clips(Character& character, const Progress& progress) {
    const std::vector<Box> boxes = influence_boxes(character);
    for (uint32_t number = 0; number < character.clips.size(); ++number) {
        progress.report(number, character.clips.size());
        Clip& clip = character.clips[number];
        Box bounds;
        const auto add_pose = [&](double time_s) {
            const std::vector<AffineT<double>> model = model_from_joint_of(character, {number, time_s});
            for (size_t joint = 0; joint < model.size(); ++joint) add_posed(bounds, model[joint], boxes[joint]);
        };
        for (uint32_t row = 0; row < clip.row_count; ++row) {
            progress.poll();
            const double time_s = character.times_s[clip.first_time + row];
            add_pose(time_s);
            if (row + 1 < clip.row_count) add_pose((time_s + character.times_s[clip.first_time + row + 1]) / 2);
        }
        clip.bounds_min = bounds.low.as<float>();
        clip.bounds_max = bounds.high.as<float>();
    }
}

}  // namespace throng
