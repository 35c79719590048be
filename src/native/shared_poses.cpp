#include "native/shared_poses.h"

#include "bind/skin_format.h"
#include "control/control_reference.h"
#include "native/native.h"
#include "reference/influence_boxes.h"
#include "sample/sample_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace throng {
namespace {

// At most 2^32 - 1, so that the sum over all clips cannot overflow: a file can claim any duration.
uint64_t interval_count(const Clip& clip, float poses_per_s) {
    constexpr double kMaximum = std::numeric_limits<uint32_t>::max();
    return static_cast<uint64_t>(std::min(std::ceil(double{clip.duration_s} * poses_per_s), kMaximum));
}

// Makes single poses of clips.
class Poser {
public:
    Poser(const Character& character, const NativeRig& rig) : character_(character), rig_(rig) {}

    void pose(uint32_t clip, double time_s, SkinFormat format, std::byte* skin) const {
        const io::ClipCursor of_clip = cursor_reference({.clip = clip, .time_s = time_s, .loop = false},
                                                        character_.clips, character_.times_s,
                                                        character_.rig.joint_count());
        const io::InstanceCursor cursor{of_clip, of_clip, 1};
        update(rig_, {.cursors = &cursor, .skin_format = format, .skin = skin}, 0, 1);
    }

    std::vector<Affine> affines(uint32_t clip, double time_s) const {
        std::vector<Affine> skin(character_.palette.size());
        pose(clip, time_s, SkinFormat::kAffine, reinterpret_cast<std::byte*>(skin.data()));
        return skin;
    }

private:
    const Character& character_;
    const NativeRig& rig_;
};

double largest_displacement(const std::vector<Affine>& a, const std::vector<Affine>& b, const std::vector<Box>& boxes) {
    double most = 0;
    for (size_t entry = 0; entry < boxes.size(); ++entry) {
        if (boxes[entry].empty) continue;
        AffineT<double> difference = a[entry].as<double>();
        for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 4; ++c) difference.row[r][c] -= double{b[entry].row[r][c]};
        most = std::max(most, displacement(difference, boxes[entry]));
    }
    return most;
}

// How far the corners of boxes move, which bounds how far their content moves.
class Spread {
public:
    explicit Spread(const std::vector<Box>& boxes) : boxes_(boxes), places_(boxes.size()) {}

    void add(const std::vector<Affine>& skin) {
        for (size_t entry = 0; entry < boxes_.size(); ++entry) {
            if (boxes_[entry].empty) continue;
            for (size_t corner = 0; corner < 8; ++corner)
                places_[entry][corner].add(transform_point(skin[entry].as<double>(), boxes_[entry].corner(corner)));
        }
    }

    double largest() const {
        double most = 0;
        for (const auto& corners : places_)
            for (const Box& of_corner : corners)
                if (!of_corner.empty) most = std::max(most, length(of_corner.high - of_corner.low));
        return most;
    }

private:
    const std::vector<Box>& boxes_;
    std::vector<std::array<Box, 8>> places_;
};

}  // namespace

uint64_t shared_pose_count(const Character& character, float poses_per_s) {
    uint64_t sum = 1;  // the rest pose
    for (const Clip& clip : character.clips) sum += interval_count(clip, poses_per_s) + 1;
    return sum;
}

SharedPoses make_shared_poses(const Character& character, const NativeRig& rig, SkinFormat format, float poses_per_s) {
    const Poser poser(character, rig);
    const std::vector<Box> boxes = bind_boxes(character);
    Spread spread(boxes);
    const size_t pose_bytes = character.palette.size() * skin_format_bytes(format);
    SharedPoses shared;
    shared.row_count = static_cast<uint32_t>(shared_pose_count(character, poses_per_s));
    shared.skin.resize(shared.row_count * pose_bytes);
    native::AlignedBytes pose = native::aligned_bytes(pose_bytes);
    uint32_t row = 0;
    const auto add = [&](uint32_t clip, double time_s) {
        poser.pose(clip, time_s, format, pose.get());
        std::memcpy(shared.skin.data() + row++ * pose_bytes, pose.get(), pose_bytes);
        std::vector<Affine> affines = poser.affines(clip, time_s);
        spread.add(affines);
        return affines;
    };
    for (uint32_t clip = 0; clip < character.clips.size(); ++clip) {
        const double duration_s = character.clips[clip].duration_s;
        const auto intervals = static_cast<uint32_t>(interval_count(character.clips[clip], poses_per_s));
        const uint32_t first_row = row;
        std::vector<std::vector<Affine>> poses;
        for (uint32_t i = 0; i <= intervals; ++i) poses.push_back(add(clip, duration_s * i / std::max(intervals, 1u)));
        double error = 0;
        const auto compare = [&](double time_s, size_t with) {
            error = std::max(error, largest_displacement(poser.affines(clip, time_s), poses[with], boxes));
        };
        for (uint32_t i = 0; i < intervals; ++i)
            for (const uint32_t with : {i, i + 1}) compare(duration_s * (i + 0.5) / intervals, with);
        for (const float key_s : row_times(character, clip))
            if (intervals > 0)
                compare(key_s, std::min(static_cast<uint32_t>(key_s / duration_s * intervals + 0.5), intervals));
        shared.clips.push_back(
            {.first_row = first_row,
             .interval_count = intervals,
             .intervals_per_s = intervals > 0 ? static_cast<float>(intervals / duration_s) : 0,
             .error = std::nextafter(static_cast<float>(error), std::numeric_limits<float>::infinity())});
    }
    shared.clips.push_back({.first_row = row, .interval_count = 0, .intervals_per_s = 0, .error = 0});
    add(kNone, 0);
    constexpr double kBlendOvershoot = 1.1;
    shared.spread = static_cast<float>(kBlendOvershoot * spread.largest());
    return shared;
}

}  // namespace throng
