// Instances of groups with CrowdGroup::is_carried hang on sockets of other instances, and are placed where those
// sockets are.
#pragma once

#include "attach/attach_io.h"
#include "crowd/batch_plan.h"
#include "crowd/dirty_ranges.h"
#include "crowd/each.h"
#include "crowd/stage.h"

#include <throng/attachment.h>

#include <map>

namespace throng {

// Throws kInvalidArgument if a carried group would also move by itself.
void check_carried(const CrowdGroup& group);

class AttachStage : public Stage {
public:
    static bool is_needed(const CrowdSettings& settings);
    static void plan(BatchPlan& plan);
    explicit AttachStage(const StageContext& context);

    // Throws kInvalidArgument if the group is not carried or the attachment is not valid, and then changes nothing.
    // The caller checks that the carrier is there.
    void attach(const Instances& instances, const Each<Attachment>& attachment);
    void detach(const Instances& instances);
    // Detaches what hangs on them, too.
    void despawn(std::span<const InstanceHandle> gone) override;

    void begin(const Update& update) override;
    // Runs after everything that moves sockets.
    void record(const Update& update) override;
    void discard() override { dirty_.put_back(); }
    void exchange(StateArchive& archive) override;
    void exchange_group(StateArchive& archive, uint32_t group) override;

private:
    bool is_possible(const io::InstanceAttachment& attachment) const;
    io::InstanceAttachment to_io(uint32_t instance, const Attachment& attachment) const;
    void set(uint32_t instance, const io::InstanceAttachment& attachment);
    uint32_t carrier_of(uint32_t instance) const;
    std::string set_levels();
    const Group& group_at(uint32_t instance) const { return group_of(batches_[batch_index_of(batches_, instance)]); }

    std::vector<io::InstanceAttachment> attachments_;  // [instance_count], as last set
    DirtyRanges dirty_;
    Kernel kernel_;
    struct Pair {
        Bindings bindings;
        std::vector<uint32_t> counts;  // [level], attached instances
    };
    // Keys: a carried batch, and the batch of its carriers or, for the sockets of instances that are not attached,
    // kNone.
    std::map<std::pair<uint32_t, uint32_t>, Pair> pairs_;
};

}  // namespace throng
