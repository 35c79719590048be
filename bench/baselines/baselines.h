// The baselines that the paper argues against, as whole pipelines: clips baked beforehand into a form without a
// hierarchy. They show what baking costs: bytes for each clip, and how far vertices are from their correct places.
#pragma once

#include "bench/gpu_clock.h"
#include "gpu/kernel.h"

#include <throng/reference.h>

#include <span>
#include <string_view>
#include <vector>

namespace throng::bench {

struct BakeSettings {
    double rate = 30;                   // frames a second, if the method stores frames
    uint64_t limit_bytes = UINT64_MAX;  // most bytes of keys: the device's storage-buffer range
};

struct Baseline {
    std::string_view name, summary, source;
    // The character with its clips as the method stores them, from the double references; without mesh.
    // Clip::size_bytes counts the same as in throng's clips. Throws kLimit if the keys exceed the limit.
    Character (*bake)(const Character& character, const BakeSettings& settings);
    // The definition: model_from_bind of each palette entry, in double precision, from what bake() made.
    std::vector<AffineT<double>> (*skin_matrices)(const Character& baked, const Playback& playback);
    std::span<const uint32_t> plain, software;  // SPIR-V
};

// One row each; defined in bench/baselines/<name>.cpp.
std::span<const Baseline> baselines();
Baseline baked();
Baseline flattened();

// Throws kLimit, naming both numbers.
void check_key_bytes(const Character& character, std::string_view method, uint64_t key_bytes,
                     const BakeSettings& settings);

// Instances of one baked character on the GPU: throng's own control stage, then the baseline's one kernel.
class BaselineCrowd {
public:
    BaselineCrowd(std::shared_ptr<Gpu> gpu, const Baseline& baseline, const Character& baked,
                  std::span<const Playback> playbacks);

    // Advances and animates all instances, and waits.
    Reading update(float time_step_s) const;
    std::vector<Affine> read_skin_matrices(uint32_t instance) const;

private:
    struct Batch {
        uint32_t first_instance = 0, instance_count = 0;
        Buffer playbacks, cursors, skin;
        Bindings control_bindings, baseline_bindings;
    };
    void record(VkCommandBuffer commands, float time_step_s) const;

    std::shared_ptr<Gpu> gpu_;
    uint32_t palette_count_ = 0, tracks_per_clip_ = 0;
    Kernel control_, kernel_;
    Buffer timelines_, times_, tracks_, keys_, palette_joints_, joint_from_bind_;
    std::vector<Batch> batches_;
    GpuClock clock_;
};

// The distance of each vertex, skinned with these matrices, from its position in the reference of the playback; in the
// model's units.
std::vector<double> displacements(const Character& character, const Playback& playback,
                                  std::span<const AffineT<double>> model_from_bind);

}  // namespace throng::bench
