#include "compile/mesh/posed_mesh.h"

#include "base/count.h"
#include "bind/bind_reference.h"
#include "skin/skin_reference.h"

#include <algorithm>

namespace throng {

Four3 in_four_poses(std::span<const std::vector<Vec3<float>>> positions, uint32_t vertex, size_t group) {
    Four3 places{};
    for (size_t lane = 0; lane < kLanes; ++lane)
        places.set(lane, positions[std::min(group * kLanes + lane, positions.size() - 1)][vertex]);
    return places;
}

std::vector<MeshPose> mesh_poses(const Character& character, uint32_t count, const ClipSampler& sample,
                                 const Progress& progress) {
    std::vector<MeshPose> poses;
    for (const SampledPose& of : sampled_poses(character, count)) {
        progress.poll();
        const std::vector<MorphLayer> layers{{.active_clips = {{.clip = of.clip, .time_s = of.time_s}}}};
        poses.push_back({of.clip < character.clips.size() ? model_from_joint_of(character.rig, sample(of))
                                                          : rest_model_from_joint(character.rig),
                         active_morphs_reference(morphs_reference(character, layers))});
    }
    return poses;
}

PosedMesh::PosedMesh(const Character& character, std::span<const MeshPose> poses, std::span<const uint32_t> indices,
                     ThreadPool& threads, const Progress& progress) {
    model_from_bind.resize(poses.size());
    positions.resize(poses.size());
    for_each_job(threads, count_of(poses), [&](uint32_t pose) {
        progress.poll();
        model_from_bind[pose] = bind_reference(character.palette, poses[pose].model_from_joint);
        for (const Vec3<double>& p : skin_reference(character, model_from_bind[pose], poses[pose].morphs))
            positions[pose].push_back(p.as<float>());
    });
    const TriangleIndex at_rest(indices, positions[0]);
    surfaces.resize(poses.size());
    for_each_job(threads, count_of(poses), [&](uint32_t pose) {
        surfaces[pose] = at_rest;
        surfaces[pose].move(positions[pose]);
    });
}

}  // namespace throng
