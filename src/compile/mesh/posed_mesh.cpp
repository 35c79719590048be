#include "compile/mesh/posed_mesh.h"

#include "base/count.h"
#include "bind/bind_reference.h"
#include "morph/morph_reference.h"
#include "reference/sampled_poses.h"
#include "skin/skin_reference.h"

#include <algorithm>

namespace throng {

Four3 in_four_poses(std::span<const std::vector<Vec3<float>>> positions, uint32_t vertex, size_t group) {
    Four3 places{};
    for (size_t lane = 0; lane < kLanes; ++lane)
        places.set(lane, positions[std::min(group * kLanes + lane, positions.size() - 1)][vertex]);
    return places;
}

PosedMesh::PosedMesh(const Character& character, uint32_t pose_count, std::span<const uint32_t> indices,
                     ThreadPool& threads, const Progress& progress) {
    const std::vector<SampledPose> poses = sampled_poses(character, pose_count);
    model_from_bind.resize(poses.size());
    positions.resize(poses.size());
    for_each_job(threads, count_of(poses), [&](uint32_t pose) {
        progress.poll();
        const auto& [clip, time_s] = poses[pose];
        const std::vector<MorphLayer> layers{{.active_clips = {{.clip = clip, .time_s = time_s}}}};
        const std::vector<WeightedMorph> morphs = active_morphs_reference(morphs_reference(character, layers));
        model_from_bind[pose] = bind_reference(character.palette, model_from_joint_of(character, poses[pose]));
        for (const Vec3<double>& p : skin_reference(character, model_from_bind[pose], morphs))
            positions[pose].push_back(p.as<float>());
    });
    surfaces.assign(poses.size(), TriangleIndex(indices, positions[0]));
    for_each_job(threads, count_of(poses), [&](uint32_t pose) { surfaces[pose].move(positions[pose]); });
}

}  // namespace throng
