// The looks that the application gives to instances of groups with CrowdGroup::outfits.
#pragma once

#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/each.h"
#include "crowd/stage.h"
#include "look/look_io.h"

#include <throng/look.h>

namespace throng {

// Whether this can be the color of a tint or a section: each component is 0 to 1000.
bool is_color(const std::array<float, 3>& color);

// CrowdGroup::outfits as `section looks`; without outfits, one that shows everything as it is. Throws kInvalidArgument
// if one names something that does not exist, or is out of range.
std::vector<io::SectionLook> section_looks_of(const CrowdGroup& group);

class LookStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings);
    static void plan(BatchPlan& plan);
    explicit LookStage(const StageContext& context);

    void set(const Instances& instances, const Each<InstanceLook>& look);
    void despawn(std::span<const InstanceHandle> gone) override;

    void begin(const Update& update) override;
    void discard() override { dirty_.put_back(); }
    void exchange_group(StateArchive& archive, uint32_t group) override;
    uint32_t end_count() const override { return 0; }

private:
    const Group& group_at(uint32_t instance) const { return group_of(batches_[batch_index_of(batches_, instance)]); }

    std::vector<InstanceLook> looks_;  // [instance_count], as last set
    DirtyRanges dirty_;
};

}  // namespace throng
