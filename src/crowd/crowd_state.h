// The inside of a Crowd: groups, batches, waves.
//
// A group is one character; a batch is a run of its instances whose buffers fit the device's limits; a wave is a run of batches whose
// intermediate buffers (poses, local and model matrices) fit the arena together. A wave goes through the stages as a whole, so
// that small groups share a dispatch's latency; then the next wave reuses the arena.
#pragma once

#include "crowd/dirty_ranges.h"
#include "crowd/group.h"
#include "crowd/stage_timer.h"
#include "control/control_io.h"

#include <throng/crowd.h>

#include <memory>
#include <optional>

namespace throng {

// Intermediates, reused by every wave. 48 bytes a joint each; second_poses serves the scan as scratch once blended.
struct Arena {
    Buffer first_poses, second_poses, local, model;
};

struct Batch {
    uint32_t group = 0;
    uint32_t first_instance = 0, instance_count = 0;
    Buffer playbacks, cursors, placements, skin;
    Buffer kept_model;  // where CrowdSettings::keep_model_matrices
    Bindings control, sample_first, sample_second, blend, scan, bind;
};

struct Wave {
    uint32_t first_batch = 0, batch_count = 0;
};

struct CrowdState {
    CrowdState(std::shared_ptr<Gpu> gpu, const CrowdSettings& settings);

    void set_playback(uint32_t first_instance, std::span<const Playback> playback);
    void set_placement(uint32_t first_instance, std::span<const Affine> world_from_model);
    void record(VkCommandBuffer commands, float time_step_s);
    std::vector<Affine> read_matrices(uint32_t instance, bool model) const;
    std::vector<Vec3<float>> read_positions(uint32_t instance);
    uint64_t size_bytes() const;

    std::shared_ptr<Gpu> gpu;
    uint32_t instance_count = 0;
    std::vector<Group> groups;
    std::vector<Batch> batches;
    std::vector<Wave> waves;
    std::vector<OutputBlock> outputs;
    std::vector<Affine> placements;  // [instance_count], as last set
    std::unique_ptr<StageTimer> timer;

private:
    void make_batches(uint32_t group, uint32_t count, bool keep_model);
    void make_waves();
    void check_memory(const CrowdSettings& settings) const;
    void bind_batches();
    void upload_changes(VkCommandBuffer commands);
    void record_wave(VkCommandBuffer commands, const Wave& wave, float time_step_s);
    void check_range(uint32_t first_instance, size_t count, const char* what) const;
    const Batch& batch_of(uint32_t instance) const;
    const Kernel& blend_of(const Group& group);

    Kernel control_, sample_, bind_;
    std::optional<Kernel> blend_affines_, blend_similarities_;  // as the scan methods of the groups take them
    std::optional<Kernel> skin_;  // made when positions are first read back
    Arena arena_;
    std::vector<uint64_t> arena_offsets_bytes_;      // [batch_count]
    std::vector<io::InstancePlayback> playbacks_;    // [instance_count], as last set
    DirtyRanges dirty_playbacks_, dirty_placements_;
};

}  // namespace throng
