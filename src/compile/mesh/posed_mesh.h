// A character's mesh in the poses that its levels of detail are made and measured in.
#pragma once

#include "base/progress.h"
#include "base/thread_pool.h"
#include "morph/morph_reference.h"
#include "reference/sampled_poses.h"
#include "compile/mesh/four_triangles.h"
#include "compile/mesh/triangle_index.h"

#include <throng/character.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace throng {

// Poses are looked at four at a time; the last one is repeated to fill its group.
constexpr size_t groups_of_four(size_t poses) { return (poses + kLanes - 1) / kLanes; }
// Where a vertex is in a group of poses. `positions` are [poses][vertices].
Four3 in_four_poses(std::span<const std::vector<Vec3<float>>> positions, uint32_t vertex, size_t group);

// What determines where a mesh is, apart from the character.
struct MeshPose {
    std::vector<AffineT<double>> model_from_joint;  // [joint_count]
    std::vector<WeightedMorph> morphs;
};

// The local pose of a clip at a time: [joint_count].
using ClipSampler = std::function<std::vector<Trs<double>>(const SampledPose&)>;

// The rest pose, then `count` poses of clips, as sampled_poses() chooses them. `progress` is only polled.
std::vector<MeshPose> mesh_poses(const Character& character, uint32_t count, const ClipSampler& sample,
                                 const Progress& progress = {});

struct PosedMesh {
    // The first of `poses` must be the rest pose. Every three `indices`, vertices of the character, form a triangle.
    // `progress` is only polled.
    PosedMesh(const Character& character, std::span<const MeshPose> poses, std::span<const uint32_t> indices,
              ThreadPool& threads, const Progress& progress);

    uint32_t pose_count() const { return static_cast<uint32_t>(positions.size()); }
    size_t groups() const { return groups_of_four(positions.size()); }

    std::vector<std::vector<AffineT<double>>> model_from_bind;  // [poses][palette]
    std::vector<std::vector<Vec3<float>>> positions;            // [poses][vertices], model space
    std::vector<TriangleIndex> surfaces;                        // [poses]
};

}  // namespace throng
