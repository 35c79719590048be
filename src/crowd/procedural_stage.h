// The procedural stage of groups with rules. Takes targets and wind from the application, and moves local transforms.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/stage.h"
#include "procedural/procedural.h"
#include "procedural/wind_clock.h"

#include <optional>

namespace throng {

class ProceduralStage : public Stage {
public:
    static void plan(BatchPlan& plan);
    // Serves the batches whose group has rules.
    explicit ProceduralStage(const StageContext& context);

    // `index` is that of instance and target in the batch's buffer.
    void set_target(uint32_t batch, uint32_t index, const io::vec4& place_and_weight);
    void despawn(std::span<const InstanceHandle> gone) override;
    void set_wind(const Wind& wind) { wind_.set(wind); }

    // Uploads targets and advances the wind's time. The staged update records the stage's kernels.
    void begin(const Update& update) override;
    void discard() override;
    void exchange(StateArchive& archive) override;
    void exchange_group(StateArchive& archive, uint32_t group) override;
    uint32_t end_count() const override { return 0; }
    using KindBindings = std::array<Bindings, io::kChainKindCount>;  // by kind of chains
    // `local` is where the staged update has the batch's local transforms.
    KindBindings bind(uint32_t batch, const BufferRange& local) const;
    uint32_t rank_count(uint32_t batch) const;
    // Ranks of a batch come one after the other, with a barrier between.
    void record_rank(VkCommandBuffer commands, const KindBindings& bindings, uint32_t batch, uint32_t rank) const;

private:
    struct Targets {
        std::vector<io::vec4> last;  // as set
        DirtyRanges dirty;
    };
    using Kernels = std::array<std::optional<Kernel>, io::kChainKindCount>;
    void record_dispatch(VkCommandBuffer commands, const KindBindings& bindings, const Batch& batch,
                         const ProceduralTables::Dispatch& dispatch) const;

    Kernels kernels_[2];            // [similarities][kind], those that the groups need
    std::vector<Targets> targets_;  // [batch]
    WindClock wind_;
    float time_step_s_ = 0;
};

}  // namespace throng
