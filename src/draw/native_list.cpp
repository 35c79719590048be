#include "draw/native_list.h"

#include "gpu/native.h"

#include <algorithm>
#include <numeric>

namespace throng {
namespace {

constexpr uint32_t kMinOfJob = 1024;

io::vec4 plane(const io::vec4& row, float sign, const io::vec4& other) {
    return {other.x + sign * row.x, other.y + sign * row.y, other.z + sign * row.z, other.w + sign * row.w};
}

bool is_behind(const io::vec4& plane, const Affine& place, const Vec3<float>& centre, const Vec3<float>& half) {
    const auto along = [&](size_t k) {
        return plane.x * place.row[0][k] + plane.y * place.row[1][k] + plane.z * place.row[2][k];
    };
    const float x = along(0), y = along(1), z = along(2);
    return x * centre.x + y * centre.y + z * centre.z + along(3) + plane.w + std::abs(x) * half.x +
               std::abs(y) * half.y + std::abs(z) * half.z <
           0;
}

}  // namespace

void list_instances(const Batch& batch, NativeList& list) {
    if (!batch.has_outputs) {  // there are no matrices yet
        list.instances.clear();
        list.begins.fill(0);
        return;
    }
    const auto* const listed = reinterpret_cast<const uint32_t*>(batch[io::kListBuffer].mapped());
    if (!listed) {
        list.instances.resize(batch.instance_count);
        std::iota(list.instances.begin(), list.instances.end(), 0u);
        list.begins.fill(batch.instance_count);
        list.begins[0] = 0;
        return;
    }
    list.instances.assign(listed + io::kFirstListed, listed + io::kFirstListed + listed[io::kListCount]);
    std::copy_n(listed + io::kListBegins, io::kLodCount, list.begins.begin());
    list.begins.back() = listed[io::kListCount];
}

NativeView::NativeView(const io::DrawScene& scene, bool shadows) : shadows_(shadows) {
    const io::vec4* const clip = scene.clip_from_world;
    // The last plane is the near plane: all points have the same clip-space z, its distance
    picture_ = {plane(clip[0], 1, clip[3]), plane(clip[0], -1, clip[3]), plane(clip[1], 1, clip[3]),
                plane(clip[1], -1, clip[3]), plane(clip[2], -1, clip[3])};
    const io::vec4 none(0, 0, 0, 0), one(0, 0, 0, 1);
    for (const io::vec4& row : {scene.map_from_world[0], scene.map_from_world[1]}) {
        map_.push_back(plane(row, 1, none));
        map_.push_back(plane(row, -1, one));
    }
}

bool NativeView::shows(const Affine& place, const Vec3<float>& centre, const Vec3<float>& half) const {
    const auto is_inside = [&](const std::vector<io::vec4>& planes) {
        return std::ranges::none_of(planes, [&](const io::vec4& p) { return is_behind(p, place, centre, half); });
    };
    return is_inside(picture_) || (shadows_ && is_inside(map_));
}

void NativeView::keep_seen(const Group& group, const Batch& batch, const NativeDevice& device, NativeList& list) {
    if (group.pose_capacity > 0) return;  // poses from set_pose() may reach anywhere
    const Vec3<float> centre = (group.posed_min + group.posed_max) * 0.5f,
                      half = (group.posed_max - group.posed_min) * 0.5f;
    const auto* const placements = reinterpret_cast<const Affine*>(batch[io::kPlacementsBuffer].mapped());
    seen_.resize(list.instances.size());
    device.for_parts(static_cast<uint32_t>(seen_.size()), kMinOfJob, [&](uint32_t first, uint32_t end) {
        for (uint32_t i = first; i < end; ++i) seen_[i] = shows(placements[list.instances[i]], centre, half);
    });
    uint32_t kept = 0, level = 0;
    for (uint32_t i = 0; i < seen_.size(); ++i) {
        for (; level < list.begins.size() && list.begins[level] <= i; ++level) list.begins[level] = kept;
        if (seen_[i]) list.instances[kept++] = list.instances[i];
    }
    for (; level < list.begins.size(); ++level) list.begins[level] = kept;
    list.instances.resize(kept);
}

}  // namespace throng
